//! Top-level declarations.

use super::{
    Body, Callee, Claim, ConstDef, Doc, Dotted, Expr, Ident, Locals, TaskDecl, Type, VarDecl,
};
use rpi_diag::Span;

/// A top-level declaration.
#[derive(Clone, PartialEq, Debug)]
pub struct Item {
    /// Doc comment before it.
    pub doc: Option<Doc>,
    /// What it is.
    pub kind: ItemKind,
    /// All of it.
    pub span: Span,
}

/// The kinds of declarations.
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
    /// `fragment`
    Fragment(Box<FragmentDecl>),
    /// `primitive`
    Primitive(Box<PrimitiveDecl>),
    /// `device`
    Device(Box<DeviceDecl>),
    /// `frame a, b in c = pose;`
    Frame(Box<FrameDecl>),
    /// `command`
    Command(Box<CommandDecl>),
    /// `task`
    Task(Box<TaskDecl>),
    /// `test "name" let ... tel`
    Test(Box<TestDecl>),
    /// A declaration with a fault that left nothing to check; the names that it seems to declare
    Broken(Vec<Declared>),
}

/// A name that a broken declaration seems to declare.
#[derive(Clone, PartialEq, Debug)]
pub struct Declared {
    /// What kind of thing, by the word that begins the declaration.
    pub kind: DeclaredKind,
    /// The name.
    pub name: Ident,
}

/// Kinds of [`Declared`] names.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DeclaredKind {
    /// `const`
    Const,
    /// `type`
    Type,
    /// `node`, `function`, `fragment`, `primitive`
    Callable,
    /// `device`
    Device,
    /// `frame`
    Frame,
    /// `command`
    Command,
    /// `task`
    Task,
}

/// `T = definition`; without one the type comes from outside.
#[derive(Clone, PartialEq, Debug)]
pub struct TypeDef {
    /// Doc comment before it.
    pub doc: Option<Doc>,
    /// The name declared.
    pub name: Ident,
    /// `<T; U>` (Kind 2)
    pub statics: Vec<StaticParam>,
    /// What it stands for.
    pub ty: Option<Type>,
    /// All of it.
    pub span: Span,
}

/// Name, static parameters and ports of what can be called.
#[derive(Clone, PartialEq, Debug)]
pub struct Signature {
    /// The name declared; of a primitive it may be qualified.
    pub name: Ident,
    /// `<<...>>`
    pub statics: Vec<StaticParam>,
    /// In-ports; [`None`] where they are not written and therefore inferred.
    pub inputs: Option<Vec<VarDecl>>,
    /// Out-ports; [`None`] where they are not written.
    pub outputs: Option<Vec<VarDecl>>,
}

/// One declaration between `<<` and `>>`.
#[derive(Clone, PartialEq, Debug)]
pub struct StaticParam {
    /// Doc comment before it.
    pub doc: Option<Doc>,
    /// What it is.
    pub kind: StaticParamKind,
    /// All of it.
    pub span: Span,
}

/// What a static parameter can be.
#[derive(Clone, PartialEq, Debug)]
pub enum StaticParamKind {
    /// `type t`, `type T: number`
    Type(Ident, Option<Ident>),
    /// `a, b: T = d`, `const n: int`
    Value(ConstDef),
    /// `node f (x: int) returns (y: int)`
    Node(NodeKind, Box<Signature>),
}

/// Whether a callable may have state.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum NodeKind {
    /// It may.
    Node,
    /// It has none.
    Function,
    /// It is a contract for others to import: what it claims about all its ports (Kind 2).
    Contract,
}

/// `node f (x: int) returns (y: int) let ... tel`
#[derive(Clone, PartialEq, Debug)]
pub struct NodeDecl {
    /// `node` or `function`.
    pub kind: NodeKind,
    /// What stands before `node` or `function`.
    pub modifier: Modifier,
    /// Name, parameters, ports. Without ports only in `node f = g<<3>>;`.
    pub signature: Signature,
    /// Its `const` in-ports that decide about sizes (Kind 2): static parameters in all but their place.
    pub sizes: Vec<ConstDef>,
    /// `con ... noc`
    pub contract: Option<Contract>,
    /// What it does.
    pub definition: NodeDef,
    /// How it is said that it is defined outside; of no meaning for other definitions.
    pub outside: Outside,
}

/// What may stand before `node` or `function`.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Modifier {
    /// Nothing.
    #[default]
    None,
    /// `unsafe`: it may have side effects (Lustre V6).
    Unsafe,
    /// `opaque`: callers know its contract alone (Kind 2).
    Opaque,
    /// `transparent`: callers look into its body (Kind 2).
    Transparent,
}

/// The ways to say that a node is defined outside; they mean the same.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Outside {
    /// `extern node f ...;`
    #[default]
    Extern,
    /// `node imported f ...;` (Kind 2)
    Imported,
    /// `node f (x: int) returns (y: int);` (Lustre V4)
    NoBody,
}

impl Outside {
    /// The word for it, if it takes one.
    #[must_use]
    pub fn word(self) -> Option<&'static str> {
        match self {
            Outside::Extern => Some("extern"),
            Outside::Imported => Some("imported"),
            Outside::NoBody => None,
        }
    }
}

/// How a node is defined.
#[derive(Clone, PartialEq, Debug)]
pub enum NodeDef {
    /// `let ... tel`
    Body(Body),
    /// `= g<<3>>`
    Alias(Callee),
    /// `extern`, `imported`, or no body: defined outside.
    Extern,
}

/// `con assume ...; guarantee ...; noc`
#[derive(Clone, PartialEq, Debug)]
pub struct Contract {
    /// Names for use in it: `var x: int = e;`, `const n = 3;`.
    pub locals: Vec<Locals>,
    /// Those that get their values together: `var x, y: int = f(z);`.
    pub together: Vec<Together>,
    /// What holds always.
    pub claims: Vec<Claim>,
    /// What holds in a mode (Kind 2).
    pub modes: Vec<ContractMode>,
    /// Contracts that are taken up.
    pub imports: Vec<ContractImport>,
    /// All of it.
    pub span: Span,
}

/// `var x: int, y: bool = value;`
#[derive(Clone, PartialEq, Debug)]
pub struct Together {
    /// What is declared.
    pub vars: Vec<VarDecl>,
    /// The same as what is defined.
    pub equation: super::Equation,
    /// All of it.
    pub span: Span,
}

/// `import c(x, y) returns (z);`
#[derive(Clone, PartialEq, Debug)]
pub struct ContractImport {
    /// The contract, applied to all of them: what goes in, then what comes out.
    pub call: Expr,
    /// How many of its arguments go in.
    pub inputs: usize,
}

/// `mode m (require e; ensure e;);`
#[derive(Clone, PartialEq, Debug)]
pub struct ContractMode {
    /// The name of the mode.
    pub name: Ident,
    /// When the contract is in this mode.
    pub requires: Vec<Claim>,
    /// What holds then.
    pub ensures: Vec<Claim>,
}

/// A fragment, declared or in place.
#[derive(Clone, PartialEq, Debug)]
pub struct FragmentDecl {
    /// Name, parameters, ports; in place the ports may be left out.
    pub signature: Signature,
    /// `when c restart`; absent: active whenever its parent is.
    pub when: Option<FragmentWhen>,
    /// `budget 40[us]`
    pub budget: Option<Expr>,
    /// `con ... noc`
    pub contract: Option<Contract>,
    /// What it does.
    pub body: Body,
}

/// `when condition restart`
#[derive(Clone, PartialEq, Debug)]
pub struct FragmentWhen {
    /// When the fragment is active.
    pub condition: Expr,
    /// Whether it starts afresh when it is activated again.
    pub restart: bool,
}

/// `primitive Core::Clock <<...>> (...) returns (...) budget 1[us];`
#[derive(Clone, PartialEq, Debug)]
pub struct PrimitiveDecl {
    /// Name, parameters, ports.
    pub signature: Signature,
    /// Its work.
    pub budget: Option<Expr>,
}

/// `device Arm <<n: int>> actuator ...; sensor ...; status ...;`
#[derive(Clone, PartialEq, Debug)]
pub struct DeviceDecl {
    /// The name declared.
    pub name: Ident,
    /// `<<...>>`
    pub statics: Vec<StaticParam>,
    /// Its ports, grouped as written.
    pub sections: Vec<DeviceSection>,
}

/// The ports after one of `actuator`, `sensor`, `status`.
#[derive(Clone, PartialEq, Debug)]
pub struct DeviceSection {
    /// Which of the three.
    pub kind: PortKind,
    /// Its ports, at least one.
    pub ports: Vec<DevicePort>,
    /// All of it.
    pub span: Span,
}

/// What a device's port is for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum PortKind {
    /// What a command writes.
    Actuator,
    /// What a command reads.
    Sensor,
    /// What it reads about the device itself.
    Status,
}

/// One or more ports that `|` makes alternatives of each other.
#[derive(Clone, PartialEq, Debug)]
pub struct DevicePort {
    /// The alternatives, at least one; more than one only for actuators.
    pub alternatives: Vec<VarDecl>,
    /// All of it.
    pub span: Span,
}

/// `frame a, b in c = pose;`
#[derive(Clone, PartialEq, Debug)]
pub struct FrameDecl {
    /// The names declared, at least one.
    pub names: Vec<Ident>,
    /// The frame that they are placed in.
    pub parent: Option<Dotted>,
    /// Where in it, a pose; absent if it is not fixed.
    pub pose: Option<Expr>,
}

/// `command C (params) given (ports) let ... tel`
#[derive(Clone, PartialEq, Debug)]
pub struct CommandDecl {
    /// The name declared.
    pub name: Ident,
    /// `<<...>>`
    pub statics: Vec<StaticParam>,
    /// Devices and values, fixed at load time.
    pub params: Vec<VarDecl>,
    /// Values taken over from the predecessor.
    pub given: Vec<VarDecl>,
    /// `budget 40[us]`
    pub budget: Option<Expr>,
    /// `con ... noc`
    pub contract: Option<Contract>,
    /// The root fragment.
    pub body: Body,
}

/// `test "name" let ... tel`
#[derive(Clone, PartialEq, Debug)]
pub struct TestDecl {
    /// What it shows, in words.
    pub title: Ident,
    /// Stimuli and expectations.
    pub body: Body,
}
