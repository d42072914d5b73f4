//! Bodies: equations, local fragments, automata.

use super::{Access, Clock, Doc, Dotted, Expr, FragmentDecl, Ident, Type};
use rpi_diag::Span;

/// Declaration of variables (ports, locals, struct fields): `a, b: T when c = d`.
#[derive(Clone, PartialEq, Debug)]
pub struct VarDecl {
    /// Doc comment before the declaration.
    pub doc: Option<Doc>,
    /// Whether the port is declared `const`: its value is fixed when the program is loaded (Kind 2).
    pub is_const: bool,
    /// Declared names, in text order; at least one.
    pub names: Vec<Ident>,
    /// Type of the variables.
    pub ty: Type,
    /// Clock of the variables; absent without `when`.
    pub clock: Option<Clock>,
    /// Value where nothing else defines the flow, such as an omitted argument.
    pub default: Option<Expr>,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Definition of constants: `a, b: T = e`. A missing type is inferred from the value; a constant without a value is
/// external. If both are missing, an error has been reported.
#[derive(Clone, PartialEq, Debug)]
pub struct ConstDef {
    /// Doc comment before the definition.
    pub doc: Option<Doc>,
    /// Declared names, in text order; at least one.
    pub names: Vec<Ident>,
    /// Type of the constants; inferred if absent.
    pub ty: Option<Type>,
    /// Value of the constants; absent if they are external.
    pub value: Option<Expr>,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Body of a node, fragment, command, state or test: local declarations and `let ... tel`.
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
    /// Declarations of local flows: `var x: int; y: bool;`
    Var(Vec<VarDecl>),
    /// Definitions of local constants: `const n = 3;`
    Const(Vec<ConstDef>),
}

/// Statement of a body, such as an equation.
#[derive(Clone, PartialEq, Debug)]
pub struct Statement {
    /// Doc comment before the statement.
    pub doc: Option<Doc>,
    /// Form of the statement (equation, claim, automaton, ...), with its parts.
    pub kind: StatementKind,
    /// Range of the whole construct in the source text, `;` included.
    pub span: Span,
}

/// Forms of statements in a body, each with its syntax tree.
#[derive(Clone, PartialEq, Debug)]
pub enum StatementKind {
    /// Equation, which defines one or several flows: `x, y = e;`
    Equation(Box<Equation>),
    /// Call for its side effect: `f(x);`. The expression is an [`ExprKind::Call`](super::ExprKind::Call).
    Call(Box<Expr>),
    /// Claim about the program: `assert e;`, `assume e;`, `guarantee e;`, `check e;`
    Claim(Box<Claim>),
    /// Result of a command with its condition: `finish r when c;`, `yield ...`, `fail ...`
    CommandEnd(Box<CommandEnd>),
    /// Flows that are visible outside of the command: `export x, y.z;`
    Export(Vec<Dotted>),
    /// Local fragment: a net of its own that is active only while its condition holds.
    Fragment(Box<FragmentDecl>),
    /// State machine: `automaton ... end`
    Automaton(Box<Automaton>),
    /// Block of equations under conditions: `if c then x = 1; else x = 2; fi` (Kind 2)
    Conditional(Box<ConditionalBlock>),
    /// Block of flows with initial values: `frame (x) x = 0; let ... tel` (Kind 2)
    FrameBlock(Box<FrameBlock>),
    /// Placeholder for a statement with a syntax error, with the names that it seems to define.
    Error(Vec<Ident>),
}

/// Block of equations under conditions (Kind 2), in one of the notations of [`ConditionalKeyword`].
#[derive(Clone, PartialEq, Debug)]
pub struct ConditionalBlock {
    /// Keyword with which the block is written.
    pub keyword: ConditionalKeyword,
    /// Branches in text order, at least one.
    pub branches: Vec<BlockBranch>,
    /// Statements of the `else` branch; absent without `else`.
    pub else_statements: Option<Vec<Statement>>,
    /// Equations, one for each flow, that have the same meaning as the block.
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
    /// Boolean condition under which the statements of the branch define their flows.
    pub condition: Expr,
    /// Statements of the branch, which apply while its condition holds.
    pub statements: Vec<Statement>,
}

/// Frame block of Kind 2, `frame (names) initial let statements tel`: equations for flows with previous values as
/// defaults.
#[derive(Clone, PartialEq, Debug)]
pub struct FrameBlock {
    /// Flows that keep their values if no equation of the block defines them.
    pub names: Vec<Ident>,
    /// Equations of the values in the first cycle.
    pub initial: Vec<Statement>,
    /// Statements that define the flows.
    pub statements: Vec<Statement>,
    /// Equations, one for each flow, that have the same meaning as the block.
    pub desugared: Desugared,
}

/// Translation of a block of Kind 2: equations with the same meaning, and the errors found during the translation.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Desugared {
    /// Equations, each with the source range of the statement that it comes from.
    pub equations: Vec<(Equation, Span)>,
    /// Errors found while the block was translated to equations.
    pub errors: Vec<BlockError>,
}

/// Error found while a block of equations is translated to separate equations.
#[derive(Clone, PartialEq, Debug)]
pub enum BlockError {
    /// A branch does not define a flow: the flow as defined in another branch, and the branch.
    MissingDefinition(Ident, MissingBranch),
    /// A statement is neither an equation nor a block: its place, and a description.
    NotAnEquation(Span, &'static str),
    /// An equation defines a flow that the `frame` does not list.
    NotInFrame(Ident),
    /// A branch defines a flow twice: the second definition, and the place of the first.
    DuplicateDefinition(Ident, Span),
}

/// Branch of a block of equations that does not define a flow.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum MissingBranch {
    /// The branch of the condition at this place.
    Condition(Span),
    /// The `else` of a block; the place is that of its first statement.
    Else(Span),
    /// The block has no `else`; the place is that of the last condition.
    NoElse(Span),
}

impl MissingBranch {
    /// Returns the place that stands for the branch.
    #[must_use]
    pub fn span(self) -> Span {
        match self {
            MissingBranch::Condition(span)
            | MissingBranch::Else(span)
            | MissingBranch::NoElse(span) => span,
        }
    }
}

/// Equation: `x, arm.tcp, a[2] = value`.
#[derive(Clone, PartialEq, Debug)]
pub struct Equation {
    /// Left side; empty in `() = f(x)`.
    pub targets: Vec<Target>,
    /// Expression on the right side of `=`.
    pub value: Expr,
}

/// Left side of an equation: a flow, or a part of one.
#[derive(Clone, PartialEq, Debug)]
pub struct Target {
    /// Name of the flow or device that is defined.
    pub name: Ident,
    /// Path to the part; empty for the whole flow.
    pub path: Vec<Access>,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Condition that is claimed to hold in every cycle: assertion, property, or clause of a contract.
#[derive(Clone, PartialEq, Debug)]
pub struct Claim {
    /// Keyword that introduces the claim.
    pub kind: ClaimKind,
    /// Name of the claim in messages, as in `assume "sensor range" x < 5.0`; absent if not written.
    pub label: Option<Ident>,
    /// Condition that is claimed to hold.
    pub condition: Expr,
    /// Condition under which the claim must hold, `provided c` (Kind 2); absent if it must always hold.
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

/// Statement of a result of a command: `finish result when condition`.
#[derive(Clone, PartialEq, Debug)]
pub struct CommandEnd {
    /// Keyword of the result: `finish`, `fail` or `yield`.
    pub kind: CommandEndKind,
    /// Name of the result with which the command ends.
    pub result: Ident,
    /// Condition under which the command ends with the result.
    pub condition: Expr,
}

/// Keyword of a [`CommandEnd`]: whether the command ends at rest, in motion, or with an error.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CommandEndKind {
    /// `finish`: the command ends with all motion at rest.
    Finish,
    /// `yield`: the command ends, possibly in motion, and its successor takes over.
    Yield,
    /// `fail`: the command ends with an error.
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
    /// Whether the automaton starts in this state.
    pub is_initial: bool,
    /// Name of the state.
    pub name: Ident,
    /// Strong transitions, evaluated in each cycle before the body; the target state is active in the same cycle.
    pub unless: Vec<Transition>,
    /// Local declarations and equations that are active while the automaton is in the state.
    pub body: Body,
    /// Weak transitions, which take effect in the next cycle.
    pub until: Vec<Transition>,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Transition, one alternative of an `unless` or `until`: `condition then target`.
#[derive(Clone, PartialEq, Debug)]
pub struct Transition {
    /// Condition of the transition; absent for `otherwise`, which applies if no earlier transition does.
    pub condition: Option<Expr>,
    /// Whether the transition is written with `continue` instead of `then`: the target state continues with its
    /// previous memory instead of its initial values.
    pub resumes: bool,
    /// Name of the state that the transition makes active.
    pub target: Ident,
    /// Range of the whole construct in the source text.
    pub span: Span,
}
