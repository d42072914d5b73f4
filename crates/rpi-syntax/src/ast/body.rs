//! Bodies: equations, local fragments, automata.

use super::{Access, Clock, Doc, Dotted, Expr, FragmentDecl, Ident, Type};
use rpi_diag::Span;

/// Declaration of variables (ports, locals, struct fields): `a, b: T when c = d`.
#[derive(Clone, PartialEq, Debug)]
pub struct VarDecl {
    /// Doc comment before the declaration.
    pub doc: Option<Doc>,
    /// Whether the port is declared `const`: its value is fixed at load time (Kind 2).
    pub is_const: bool,
    /// Names, at least one.
    pub names: Vec<Ident>,
    /// Type of the variables.
    pub ty: Type,
    /// Clock of the variables.
    pub clock: Option<Clock>,
    /// Value where nothing else defines the flow, such as an omitted argument.
    pub default: Option<Expr>,
    /// Source range.
    pub span: Span,
}

/// Definition of constants: `a, b: T = e`. A missing type is inferred from the value; a constant without a value is
/// external. If both are missing, an error has been reported.
#[derive(Clone, PartialEq, Debug)]
pub struct ConstDef {
    /// Doc comment before the definition.
    pub doc: Option<Doc>,
    /// Names, at least one.
    pub names: Vec<Ident>,
    /// Type of the constants; inferred if absent.
    pub ty: Option<Type>,
    /// Value of the constants; absent if they are external.
    pub value: Option<Expr>,
    /// Source range.
    pub span: Span,
}

/// Body: local declarations and `let ... tel`.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Body {
    /// `var` and `const` sections before `let`.
    pub locals: Vec<Locals>,
    /// Statements between `let` and `tel`.
    pub statements: Vec<Statement>,
}

/// Section of local declarations.
#[derive(Clone, PartialEq, Debug)]
pub enum Locals {
    /// `var x: int; y: bool;`
    Var(Vec<VarDecl>),
    /// `const n = 3;`
    Const(Vec<ConstDef>),
}

/// Statement of a body, such as an equation.
#[derive(Clone, PartialEq, Debug)]
pub struct Statement {
    /// Doc comment before the statement.
    pub doc: Option<Doc>,
    /// Form of the statement, with its parts.
    pub kind: StatementKind,
    /// Source range, `;` included.
    pub span: Span,
}

/// Forms of statements in a body, each with its syntax tree.
#[derive(Clone, PartialEq, Debug)]
pub enum StatementKind {
    /// Equation: `x, y = e;`
    Equation(Box<Equation>),
    /// `f(x);`: call for its side effect; the expression is an [`ExprKind::Call`](super::ExprKind::Call)
    Call(Box<Expr>),
    /// `assert e;`, `assume e;`, `guarantee e;`, `check e;`
    Claim(Box<Claim>),
    /// `finish r when c;`, `yield ...`, `fail ...`
    CommandEnd(Box<CommandEnd>),
    /// `export x, y.z;`
    Export(Vec<Dotted>),
    /// Fragment declared in a body.
    Fragment(Box<FragmentDecl>),
    /// State machine: `automaton ... end`
    Automaton(Box<Automaton>),
    /// `if c then x = 1; else x = 2; fi` (Kind 2)
    Conditional(Box<ConditionalBlock>),
    /// `frame (x) x = 0; let ... tel` (Kind 2)
    FrameBlock(Box<FrameBlock>),
    /// Statement with an error; the names that it seems to define
    Error(Vec<Ident>),
}

/// Block of equations under conditions (Kind 2), in one of the notations of [`ConditionalKeyword`].
#[derive(Clone, PartialEq, Debug)]
pub struct ConditionalBlock {
    /// Notation of the block.
    pub keyword: ConditionalKeyword,
    /// Branches in text order, at least one.
    pub branches: Vec<BlockBranch>,
    /// Statements of the `else` branch.
    pub else_statements: Option<Vec<Statement>>,
    /// Equivalent equations, one for each flow.
    pub desugared: Desugared,
}

/// Keyword with which a [`ConditionalBlock`] is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ConditionalKeyword {
    /// `if c then ... elsif d then ... else ... fi`
    If,
    /// `when c then ... else ... end`
    When,
    /// `cond | c: ... | d: ... otherwise: ... end`
    Cond,
}

/// Branch of a [`ConditionalBlock`].
#[derive(Clone, PartialEq, Debug)]
pub struct BlockBranch {
    /// Condition of the branch.
    pub condition: Expr,
    /// Statements of the branch.
    pub statements: Vec<Statement>,
}

/// Frame block, `frame (names) initial let statements tel` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct FrameBlock {
    /// Flows that keep their values if no equation of the block defines them.
    pub names: Vec<Ident>,
    /// Equations of the values in the first cycle.
    pub initial: Vec<Statement>,
    /// Statements that define the flows.
    pub statements: Vec<Statement>,
    /// Equivalent equations, one for each flow.
    pub desugared: Desugared,
}

/// Equations that a block is short for, and the errors found in it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Desugared {
    /// Equations with their source ranges.
    pub equations: Vec<(Equation, Span)>,
    /// Errors found while the block was translated to equations.
    pub errors: Vec<BlockError>,
}

/// Error in a block of equations.
#[derive(Clone, PartialEq, Debug)]
pub enum BlockError {
    /// A branch does not define a flow: the flow as defined in another branch, and the place of the branch.
    MissingDefinition(Ident, Span),
    /// A statement is neither an equation nor a block: its place, and a description.
    NotAnEquation(Span, &'static str),
    /// An equation defines a flow that the `frame` does not list.
    NotInFrame(Ident),
    /// A branch defines a flow twice: the second definition, and the place of the first.
    DuplicateDefinition(Ident, Span),
}

/// Equation: `x, arm.tcp, a[2] = value`.
#[derive(Clone, PartialEq, Debug)]
pub struct Equation {
    /// Left side; empty in `() = f(x)`.
    pub targets: Vec<Target>,
    /// Right side.
    pub value: Expr,
}

/// Left side of an equation: a flow, or a part of one.
#[derive(Clone, PartialEq, Debug)]
pub struct Target {
    /// Flow or device.
    pub name: Ident,
    /// Path to the part; empty for the whole flow.
    pub path: Vec<Access>,
    /// Source range.
    pub span: Span,
}

/// Condition that is claimed to hold in every cycle: assertion, property, or clause of a contract.
#[derive(Clone, PartialEq, Debug)]
pub struct Claim {
    /// Keyword that introduces the claim.
    pub kind: ClaimKind,
    /// Label: `assume "sensor range" x < 5.0`.
    pub label: Option<Ident>,
    /// Claimed condition.
    pub condition: Expr,
    /// `provided c`: condition under which the claim must hold (Kind 2).
    pub provided: Option<Expr>,
}

/// Keywords that introduce a claim: `assert`, `check`, `assume`, `guarantee`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ClaimKind {
    /// `assert` in a body: assumed to hold.
    Assert,
    /// `check` in a body: to be proved (Kind 2).
    Check,
    /// `--%PROPERTY x;`: a check in a comment (Kind 2).
    Property,
    /// `assume` in a contract: the caller must ensure it.
    Assume,
    /// `guarantee` in a contract: the body must ensure it.
    Guarantee,
}

/// Result of a command: `finish result when condition`.
#[derive(Clone, PartialEq, Debug)]
pub struct CommandEnd {
    /// How the command ends.
    pub kind: CommandEndKind,
    /// Name of the result.
    pub result: Ident,
    /// Condition under which the command ends.
    pub condition: Expr,
}

/// Keyword of a [`CommandEnd`]: whether the robot is at rest, in motion, or the command has failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CommandEndKind {
    /// `finish`: with all motion at rest.
    Finish,
    /// `yield`: possibly in motion, for a takeover by the successor.
    Yield,
    /// `fail`: with an error.
    Fail,
}

/// Automaton (state machine): `automaton states end`.
#[derive(Clone, PartialEq, Debug)]
pub struct Automaton {
    /// States in text order, at least one.
    pub states: Vec<State>,
}

/// State of an automaton.
#[derive(Clone, PartialEq, Debug)]
pub struct State {
    /// Doc comment before the state.
    pub doc: Option<Doc>,
    /// Whether the automaton begins in this state.
    pub is_initial: bool,
    /// Name of the state.
    pub name: Ident,
    /// Strong transitions, evaluated in each cycle before the body.
    pub unless: Vec<Transition>,
    /// Equations that are active in the state.
    pub body: Body,
    /// Weak transitions, which take effect in the next cycle.
    pub until: Vec<Transition>,
    /// Source range.
    pub span: Span,
}

/// Transition, one alternative of an `unless` or `until`: `condition then target`.
#[derive(Clone, PartialEq, Debug)]
pub struct Transition {
    /// Condition; absent for `otherwise`.
    pub condition: Option<Expr>,
    /// Whether the transition is written with `continue` instead of `then`: the target state resumes with its previous
    /// memory.
    pub resumes: bool,
    /// Next state.
    pub target: Ident,
    /// Source range.
    pub span: Span,
}
