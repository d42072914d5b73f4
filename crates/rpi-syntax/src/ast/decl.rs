//! Top-level declarations.

use super::{
    Body, Callee, Claim, ConstDef, Doc, Dotted, Expr, Ident, Locals, TaskDecl, Type, VarDecl,
};
use rpi_diag::Span;

/// Declaration at the top level of a file, with its doc comment.
#[derive(Clone, PartialEq, Debug)]
pub struct Item {
    /// Doc comment before the declaration.
    pub doc: Option<Doc>,
    /// Kind of the declaration.
    pub kind: ItemKind,
    /// Source range.
    pub span: Span,
}

/// Forms of declarations in a file, each with its syntax tree.
#[derive(Clone, PartialEq, Debug)]
pub enum ItemKind {
    /// `use motion, logic;`
    Use(Vec<Ident>),
    /// `include "file.lus"`
    Include(Ident),
    /// `const a: int = 1; b = 2;`
    Const(Vec<ConstDef>),
    /// `type T = int; U = enum { A, B };`
    Type(Vec<TypeDef>),
    /// `node`, `function`
    Node(Box<NodeDecl>),
    /// Declaration of a `fragment`, a net that may be inactive.
    Fragment(Box<FragmentDecl>),
    /// Declaration that adds units and frames to a `primitive` of the core.
    Primitive(Box<PrimitiveDecl>),
    /// Declaration of a `device` type.
    Device(Box<DeviceDecl>),
    /// `frame a, b in c = pose;`
    Frame(Box<FrameDecl>),
    /// Declaration of a `command`, which the control core runs.
    Command(Box<CommandDecl>),
    /// Declaration of a `task`, a program of commands.
    Task(Box<TaskDecl>),
    /// `test "name" let ... tel`
    Test(Box<TestDecl>),
    /// Declaration with an error that left nothing to check; the names that it seems to declare
    Error(Vec<DeclaredName>),
}

/// Name that a declaration with an error seems to declare.
#[derive(Clone, PartialEq, Debug)]
pub struct DeclaredName {
    /// Kind of the declared entity, by the keyword of the declaration.
    pub kind: DeclaredKind,
    /// Declared name.
    pub name: Ident,
}

/// Kind of a [`DeclaredName`] name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DeclaredKind {
    /// A constant, declared by `const`.
    Const,
    /// A type, declared by `type`.
    Type,
    /// Declared by `node`, `function`, `fragment` or `primitive`.
    Callable,
    /// A device type, declared by `device`.
    Device,
    /// A coordinate frame, declared by `frame`.
    Frame,
    /// A command, declared by `command`.
    Command,
    /// A task, declared by `task`.
    Task,
}

/// Type definition: `T = definition`. Without a definition the type is external.
#[derive(Clone, PartialEq, Debug)]
pub struct TypeDef {
    /// Doc comment before the definition.
    pub doc: Option<Doc>,
    /// Declared name.
    pub name: Ident,
    /// Type parameters: `<T; U>` (Kind 2).
    pub statics: Vec<StaticParam>,
    /// Defining type; absent if the type is external.
    pub ty: Option<Type>,
    /// Source range.
    pub span: Span,
}

/// Signature of a callable: name, static parameters and ports.
#[derive(Clone, PartialEq, Debug)]
pub struct Signature {
    /// Declared name; may be qualified for a primitive.
    pub name: Ident,
    /// Static parameters: `<<...>>`.
    pub statics: Vec<StaticParam>,
    /// In-ports; [`None`] if they are not written and therefore inferred.
    pub inputs: Option<Vec<VarDecl>>,
    /// Out-ports; [`None`] if they are not written.
    pub outputs: Option<Vec<VarDecl>>,
}

/// Static parameter, declared between `<<` and `>>`.
#[derive(Clone, PartialEq, Debug)]
pub struct StaticParam {
    /// Doc comment before the parameter.
    pub doc: Option<Doc>,
    /// Kind of the parameter.
    pub kind: StaticParamKind,
    /// Source range.
    pub span: Span,
}

/// What a static parameter stands for: a type, a value or a node.
#[derive(Clone, PartialEq, Debug)]
pub enum StaticParamKind {
    /// `type t`, `type T: number`
    Type(Ident, Option<Ident>),
    /// `a, b: T = d`, `const n: int`
    Value(ConstDef),
    /// `node f (x: int) returns (y: int)`
    Node(NodeKind, Box<Signature>),
}

/// Kind of a node-like declaration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NodeKind {
    /// `node`: may have state.
    Node,
    /// `function`: has no state.
    Function,
    /// `contract`: contract over its ports, for nodes to import (Kind 2).
    Contract,
}

/// Declaration of a node, function or contract: `node f (x: int) returns (y: int) let ... tel`.
#[derive(Clone, PartialEq, Debug)]
pub struct NodeDecl {
    /// Kind of the declaration.
    pub kind: NodeKind,
    /// Modifier before `node` or `function`.
    pub modifier: Modifier,
    /// Name, static parameters and ports. The ports are absent only in `node f = g<<3>>;`.
    pub signature: Signature,
    /// `const` in-ports that determine array sizes (Kind 2). They act as static parameters.
    pub size_params: Vec<ConstDef>,
    /// Contract: `con ... noc`.
    pub contract: Option<Contract>,
    /// Definition: body, alias or external.
    pub definition: NodeDef,
    /// Notation of an external definition; meaningless for other definitions.
    pub external_form: ExternalForm,
}

/// Modifier before `node` or `function`.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Modifier {
    /// No modifier.
    #[default]
    None,
    /// `unsafe`: the node may have side effects (Lustre V6).
    Unsafe,
    /// `opaque`: callers see only the contract (Kind 2).
    Opaque,
    /// `transparent`: callers see the body (Kind 2).
    Transparent,
}

/// Notation of an externally defined node. All notations are equivalent.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ExternalForm {
    /// `extern node f ...;`
    #[default]
    Extern,
    /// `node imported f ...;` (Kind 2)
    Imported,
    /// `node f (x: int) returns (y: int);` (Lustre V4)
    NoBody,
}

impl ExternalForm {
    /// Returns the keyword of the notation, if it has one.
    #[must_use]
    pub fn keyword(self) -> Option<&'static str> {
        match self {
            ExternalForm::Extern => Some("extern"),
            ExternalForm::Imported => Some("imported"),
            ExternalForm::NoBody => None,
        }
    }
}

/// How a node is defined: by a body, as an alias of another node, or outside of the program.
#[derive(Clone, PartialEq, Debug)]
pub enum NodeDef {
    /// `let ... tel`
    Body(Body),
    /// `= g<<3>>`
    Alias(Callee),
    /// `extern`, `imported`, or no body: defined externally.
    Extern,
}

/// Contract: `con assume ...; guarantee ...; noc`.
#[derive(Clone, PartialEq, Debug)]
pub struct Contract {
    /// Ghost variables and constants: `var x: int = e;`, `const n = 3;`.
    pub locals: Vec<Locals>,
    /// Ghost variables defined by a common equation: `var x, y: int = f(z);`.
    pub ghost_tuples: Vec<GhostTuple>,
    /// Assumptions and guarantees of every mode.
    pub claims: Vec<Claim>,
    /// Modes (Kind 2).
    pub modes: Vec<ContractMode>,
    /// Contracts that this contract imports, each with the flows that it is about.
    pub imports: Vec<ContractImport>,
    /// Source range.
    pub span: Span,
}

/// Ghost variables of a contract with a common equation: `var x: int, y: bool = value;`.
#[derive(Clone, PartialEq, Debug)]
pub struct GhostTuple {
    /// Declared variables.
    pub vars: Vec<VarDecl>,
    /// Equation that defines the variables.
    pub equation: super::Equation,
    /// Source range.
    pub span: Span,
}

/// Import of a contract: `import c(x, y) returns (z);`.
#[derive(Clone, PartialEq, Debug)]
pub struct ContractImport {
    /// Call of the contract with the inputs, followed by the outputs, as arguments.
    pub call: Expr,
    /// Number of arguments that are inputs.
    pub input_count: usize,
}

/// Mode of a contract: `mode m (require e; ensure e;);`.
#[derive(Clone, PartialEq, Debug)]
pub struct ContractMode {
    /// Name of the mode.
    pub name: Ident,
    /// Conditions under which the contract is in this mode.
    pub requires: Vec<Claim>,
    /// Conditions that the body must satisfy while the mode applies.
    pub ensures: Vec<Claim>,
}

/// Fragment, at top level or local to a body.
#[derive(Clone, PartialEq, Debug)]
pub struct FragmentDecl {
    /// Name, static parameters and ports. The ports of a local fragment may be left out.
    pub signature: Signature,
    /// Activation: `when c restart`. If absent, the fragment is active whenever its parent is.
    pub when: Option<FragmentWhen>,
    /// Execution time budget per cycle: `budget 40[us]`.
    pub budget: Option<Expr>,
    /// Contract: `con ... noc`.
    pub contract: Option<Contract>,
    /// Equations of the fragment.
    pub body: Body,
}

/// Activation of a fragment: `when condition restart`.
#[derive(Clone, PartialEq, Debug)]
pub struct FragmentWhen {
    /// Condition under which the fragment is active.
    pub condition: Expr,
    /// Whether each activation resets the fragment to its initial state.
    pub resets: bool,
}

/// Declaration of a primitive: `primitive Core::Clock <<...>> (...) returns (...) budget 1[us];`.
#[derive(Clone, PartialEq, Debug)]
pub struct PrimitiveDecl {
    /// Name, static parameters and ports.
    pub signature: Signature,
    /// Execution time per cycle.
    pub budget: Option<Expr>,
}

/// Declaration of a device type: `device Arm <<n: int>> actuator ...; sensor ...; status ...;`.
#[derive(Clone, PartialEq, Debug)]
pub struct DeviceDecl {
    /// Declared name.
    pub name: Ident,
    /// Static parameters: `<<...>>`.
    pub statics: Vec<StaticParam>,
    /// Port sections in text order.
    pub sections: Vec<DeviceSection>,
}

/// Port section of a device type, after `actuator`, `sensor` or `status`.
#[derive(Clone, PartialEq, Debug)]
pub struct DeviceSection {
    /// Whether the ports are actuators, sensors or status ports.
    pub kind: PortKind,
    /// Ports, at least one.
    pub ports: Vec<DevicePort>,
    /// Source range.
    pub span: Span,
}

/// Kind of a port of a device.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PortKind {
    /// `actuator`: written by a command.
    Actuator,
    /// `sensor`: read by a command.
    Sensor,
    /// `status`: status of the device, read by a command.
    Status,
}

/// Port of a device, or several ports separated by `|` that are alternatives.
#[derive(Clone, PartialEq, Debug)]
pub struct DevicePort {
    /// Alternatives, at least one; more than one only for actuators.
    pub alternatives: Vec<VarDecl>,
    /// Source range.
    pub span: Span,
}

/// Declaration of coordinate frames: `frame a, b in c = pose;`.
#[derive(Clone, PartialEq, Debug)]
pub struct FrameDecl {
    /// Declared names, at least one.
    pub names: Vec<Ident>,
    /// Parent frame.
    pub parent: Option<Dotted>,
    /// Pose in the parent frame; absent if it is not fixed.
    pub pose: Option<Expr>,
}

/// Declaration of a command: `command C (params) given (ports) let ... tel`.
#[derive(Clone, PartialEq, Debug)]
pub struct CommandDecl {
    /// Declared name.
    pub name: Ident,
    /// Static parameters: `<<...>>`.
    pub statics: Vec<StaticParam>,
    /// Parameters: devices, and values fixed at load time.
    pub params: Vec<VarDecl>,
    /// `given` ports: values taken over from the predecessor.
    pub given: Vec<VarDecl>,
    /// Execution time budget per cycle: `budget 40[us]`.
    pub budget: Option<Expr>,
    /// Contract: `con ... noc`.
    pub contract: Option<Contract>,
    /// Body: the root fragment.
    pub body: Body,
}

/// Declaration of a test: `test "name" let ... tel`.
#[derive(Clone, PartialEq, Debug)]
pub struct TestDecl {
    /// Title of the test.
    pub title: Ident,
    /// Stimuli and expectations.
    pub body: Body,
}
