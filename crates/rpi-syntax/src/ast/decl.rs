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
    /// Form of the declaration (`node`, `type`, `command`, ...), with its parts.
    pub kind: ItemKind,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Forms of declarations in a file, each with its syntax tree.
#[derive(Clone, PartialEq, Debug)]
pub enum ItemKind {
    /// Imports of modules: `use motion, logic;`
    Use(Vec<Ident>),
    /// Inclusion of another file: `include "file.lus"`
    Include(Ident),
    /// Definitions of constants: `const a: int = 1; b = 2;`
    Const(Vec<ConstDef>),
    /// Definitions of types: `type T = int; U = enum { A, B };`
    Type(Vec<TypeDef>),
    /// Declaration of a `node`, `function` or `contract`.
    Node(Box<NodeDecl>),
    /// Declaration of a `fragment`: a net that is active only while its condition holds.
    Fragment(Box<FragmentDecl>),
    /// Declaration of a `primitive`, which adds units and coordinate frames to the ports of a basic operation of the
    /// control core.
    Primitive(Box<PrimitiveDecl>),
    /// Declaration of a `device` type.
    Device(Box<DeviceDecl>),
    /// Declaration of coordinate frames: `frame a, b in c = pose;`
    Frame(Box<FrameDecl>),
    /// Declaration of a `command`, which the control core runs.
    Command(Box<CommandDecl>),
    /// Declaration of a `task`, a program of commands.
    Task(Box<TaskDecl>),
    /// Declaration of a test: `test "name" let ... tel`
    Test(Box<TestDecl>),
    /// Placeholder for a declaration with a syntax error, with the names that it seems to declare.
    Error(Vec<DeclaredName>),
}

/// Name that a declaration with a syntax error seems to declare. Uses of the name then cause no further errors.
#[derive(Clone, PartialEq, Debug)]
pub struct DeclaredName {
    /// Kind of the declared entity, by the keyword of the declaration.
    pub kind: DeclaredKind,
    /// Name that the declaration introduces.
    pub name: Ident,
}

/// Kind of entity that a [`DeclaredName`] denotes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DeclaredKind {
    /// A constant, declared by `const`.
    Const,
    /// A type, declared by `type`.
    Type,
    /// A callable, declared by `node`, `function`, `fragment` or `primitive`.
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

/// Definition of a type: `T = definition`. Without a right side, the type is defined outside of the program.
#[derive(Clone, PartialEq, Debug)]
pub struct TypeDef {
    /// Doc comment before the definition.
    pub doc: Option<Doc>,
    /// Name of the type.
    pub name: Ident,
    /// Type parameters: `<T; U>` (Kind 2).
    pub statics: Vec<StaticParam>,
    /// Type on the right side; absent if the type is defined outside of the program.
    pub ty: Option<Type>,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Signature of a node, function, fragment or primitive: name, static parameters and ports.
#[derive(Clone, PartialEq, Debug)]
pub struct Signature {
    /// Declared name. The name of a primitive may be qualified, as in `Core::Clock`.
    pub name: Ident,
    /// Static parameters, written `<<...>>`; empty if there are none.
    pub statics: Vec<StaticParam>,
    /// In-ports; [`None`] if the declaration does not write them, so that the compiler infers them.
    pub inputs: Option<Vec<VarDecl>>,
    /// Out-ports; [`None`] if the declaration does not write them.
    pub outputs: Option<Vec<VarDecl>>,
}

/// Static parameter, declared between `<<` and `>>`.
#[derive(Clone, PartialEq, Debug)]
pub struct StaticParam {
    /// Doc comment before the parameter.
    pub doc: Option<Doc>,
    /// Form of the parameter: a type, a value or a node, with its declaration.
    pub kind: StaticParamKind,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Form of a static parameter: the kind of argument that it accepts, with its declaration.
#[derive(Clone, PartialEq, Debug)]
pub enum StaticParamKind {
    /// Type parameter, `type t`, or with a constraint on the types that it accepts, `type T: number`.
    Type(Ident, Option<Ident>),
    /// Value parameters with an optional type and default: `a, b: T = d`, `const n: int`.
    Value(ConstDef),
    /// Node or function parameter with its signature: `node f (x: int) returns (y: int)`.
    Node(NodeKind, Box<Signature>),
}

/// Keyword of a node-like declaration.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NodeKind {
    /// Declaration by `node`: the node may have state.
    Node,
    /// Declaration by `function`: the node has no state.
    Function,
    /// `contract`: a contract over its ports, which nodes import (Kind 2).
    Contract,
}

/// Declaration of a node, function or contract: `node f (x: int) returns (y: int) let ... tel`.
#[derive(Clone, PartialEq, Debug)]
pub struct NodeDecl {
    /// Whether the declaration is a `node`, a `function` or a `contract`.
    pub kind: NodeKind,
    /// Modifier before the keyword: `unsafe`, `opaque`, `transparent`, or none.
    pub modifier: Modifier,
    /// Name, static parameters and ports. The ports are absent only in `node f = g<<3>>;`.
    pub signature: Signature,
    /// `const` in-ports that determine array sizes (Kind 2). Callers pass them as static arguments.
    pub size_params: Vec<ConstDef>,
    /// Contract before the body, `con ... noc`, if there is one.
    pub contract: Option<Contract>,
    /// Body, alias of another node, or external definition.
    pub definition: NodeDef,
    /// Notation in which an external definition is written. Irrelevant for nodes with a body or alias.
    pub external_form: ExternalForm,
    /// Name of an external function in C, `= "c_name"`; `None` if it has the name of the declaration.
    pub c_name: Option<Ident>,
}

/// Modifier before `node` or `function`: whether callers see the body, and whether the node has side effects.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Modifier {
    /// The declaration has no modifier.
    #[default]
    None,
    /// `unsafe`: the node may have side effects (Lustre V6).
    Unsafe,
    /// `opaque`: callers see only the contract (Kind 2).
    Opaque,
    /// `transparent`: callers see the body (Kind 2).
    Transparent,
}

/// Notation of a node that is defined outside of the program. All notations are equivalent.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum ExternalForm {
    /// Declaration of an external node or function in the form `extern node f ...;`.
    #[default]
    Extern,
    /// `node imported f ...;`, or `function imported f ...;` (Kind 2)
    Imported,
    /// `node f (x: int) returns (y: int);` (Lustre V4)
    NoBody,
}

impl ExternalForm {
    /// Returns the keyword of the notation; `None` for a declaration that only lacks its body.
    #[must_use]
    pub fn keyword(self) -> Option<&'static str> {
        match self {
            ExternalForm::Extern => Some("extern"),
            ExternalForm::Imported => Some("imported"),
            ExternalForm::NoBody => None,
        }
    }
}

/// Definition of a node: a body, an alias of another node, or an external definition.
#[derive(Clone, PartialEq, Debug)]
pub enum NodeDef {
    /// Body with equations: `let ... tel`
    Body(Body),
    /// Another node with static arguments: `= g<<3>>`
    Alias(Callee),
    /// No definition in the program: `extern`, `imported`, or a declaration without a body.
    Extern,
}

/// Contract of a node, fragment or command: `con assume ...; guarantee ...; noc`.
#[derive(Clone, PartialEq, Debug)]
pub struct Contract {
    /// Ghost variables and constants, which only the contract refers to: `var x: int = e;`, `const n = 3;`.
    pub locals: Vec<Locals>,
    /// Ghost variables defined by a common equation: `var x, y: int = f(z);`.
    pub ghost_tuples: Vec<GhostTuple>,
    /// `assume` and `guarantee` clauses outside of modes, which always apply.
    pub claims: Vec<Claim>,
    /// Modes, each with a condition under which its guarantees apply (Kind 2).
    pub modes: Vec<ContractMode>,
    /// Contracts that this contract imports, each with the flows that it is applied to.
    pub imports: Vec<ContractImport>,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Ghost variables of a contract that share one equation: `var x: int, y: bool = value;`.
#[derive(Clone, PartialEq, Debug)]
pub struct GhostTuple {
    /// Variables that the tuple declares, with their types.
    pub vars: Vec<VarDecl>,
    /// Equation that defines all variables of the tuple.
    pub equation: super::Equation,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Import of a contract: `import c(x, y) returns (z);`.
#[derive(Clone, PartialEq, Debug)]
pub struct ContractImport {
    /// Call of the imported contract. Its arguments are the inputs, followed by the outputs.
    pub call: Expr,
    /// Number of arguments of `call` that are inputs; the remaining arguments are outputs.
    pub input_count: usize,
}

/// Mode of a contract: `mode m (require e; ensure e;);`.
#[derive(Clone, PartialEq, Debug)]
pub struct ContractMode {
    /// Name of the mode in messages.
    pub name: Ident,
    /// Conditions (`require`) under which the contract is in this mode.
    pub requires: Vec<Claim>,
    /// Conditions (`ensure`) that the body must satisfy while the contract is in this mode.
    pub ensures: Vec<Claim>,
}

/// Declaration of a fragment, at top level or local to a body: a net that is active only while its condition holds.
#[derive(Clone, PartialEq, Debug)]
pub struct FragmentDecl {
    /// Name, static parameters and ports. The ports of a local fragment may be left out.
    pub signature: Signature,
    /// Activation `when c restart`; absent if the fragment is active whenever the enclosing net is.
    pub when: Option<FragmentWhen>,
    /// Maximum execution time per cycle, `budget 40[us]`; absent if none is given.
    pub budget: Option<Expr>,
    /// Contract before the body, `con ... noc`, if there is one.
    pub contract: Option<Contract>,
    /// Local declarations and equations of the fragment.
    pub body: Body,
}

/// Activation clause of a fragment: `when condition restart`.
#[derive(Clone, PartialEq, Debug)]
pub struct FragmentWhen {
    /// Boolean condition; the fragment is active in the cycles in which it is true.
    pub condition: Expr,
    /// Whether `restart` is written: the fragment starts from its initial state each time it becomes active.
    pub resets: bool,
}

/// Declaration of a primitive: `primitive Core::Clock <<...>> (...) returns (...) budget 1[us];`.
#[derive(Clone, PartialEq, Debug)]
pub struct PrimitiveDecl {
    /// Name, static parameters and ports.
    pub signature: Signature,
    /// Maximum execution time per cycle, `budget 1[us]`; absent if none is given.
    pub budget: Option<Expr>,
}

/// Declaration of a device type: `device Arm <<n: int>> actuator ...; sensor ...; status ...;`.
#[derive(Clone, PartialEq, Debug)]
pub struct DeviceDecl {
    /// Name of the device type.
    pub name: Ident,
    /// Static parameters, written `<<...>>`; empty if there are none.
    pub statics: Vec<StaticParam>,
    /// Port sections in text order.
    pub sections: Vec<DeviceSection>,
}

/// Port section of a device type, after `actuator`, `sensor` or `status`.
#[derive(Clone, PartialEq, Debug)]
pub struct DeviceSection {
    /// Keyword of the section, which says whether its ports are actuator, sensor or status ports.
    pub kind: PortKind,
    /// Ports of the section, at least one.
    pub ports: Vec<DevicePort>,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Kind of a port of a device: written or read by commands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PortKind {
    /// `actuator`: written by a command.
    Actuator,
    /// `sensor`: read by a command.
    Sensor,
    /// `status`: status of the device, read by a command.
    Status,
}

/// Port of a device, or several ports separated by `|` of which a command drives one.
#[derive(Clone, PartialEq, Debug)]
pub struct DevicePort {
    /// Declarations of the alternative ports, at least one. Only an actuator can have several.
    pub alternatives: Vec<VarDecl>,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Declaration of coordinate frames: `frame a, b in c = pose;`.
#[derive(Clone, PartialEq, Debug)]
pub struct FrameDecl {
    /// Names of the frames, at least one.
    pub names: Vec<Ident>,
    /// Frame relative to which the declared frames are placed; `None` for a root frame.
    pub parent: Option<Dotted>,
    /// Constant pose in the parent frame; absent if the pose is not constant.
    pub pose: Option<Expr>,
}

/// Declaration of a command: `command C (params) given (ports) let ... tel`.
#[derive(Clone, PartialEq, Debug)]
pub struct CommandDecl {
    /// Name of the command.
    pub name: Ident,
    /// Static parameters, written `<<...>>`; empty if there are none.
    pub statics: Vec<StaticParam>,
    /// Parameters of the command: devices, and values that are fixed at load time.
    pub params: Vec<VarDecl>,
    /// `given` ports: values that the command takes over from its predecessor.
    pub given: Vec<VarDecl>,
    /// Maximum execution time per cycle, `budget 40[us]`; absent if none is given.
    pub budget: Option<Expr>,
    /// Contract before the body, `con ... noc`, if there is one.
    pub contract: Option<Contract>,
    /// Local declarations and equations of the command.
    pub body: Body,
}

/// Declaration of a test: `test "name" let ... tel`.
#[derive(Clone, PartialEq, Debug)]
pub struct TestDecl {
    /// Title of the test, the string after `test`.
    pub title: Ident,
    /// Body of the test: equations that drive the tested nodes, and the conditions that must hold.
    pub body: Body,
}
