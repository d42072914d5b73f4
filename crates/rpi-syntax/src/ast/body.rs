//! What stands in a body: equations, fragments in place, automata.

use super::{Access, Clock, Doc, Dotted, Expr, FragmentDecl, Ident, Type};
use rpi_diag::Span;

/// Variables: `a, b: T when c = d`, as ports, locals, struct fields.
#[derive(Clone, PartialEq, Debug)]
pub struct VarDecl {
    /// Doc comment before it.
    pub doc: Option<Doc>,
    /// `const`: fixed at load time (a parameter among the ports, as in Kind 2).
    pub is_const: bool,
    /// The names, at least one.
    pub names: Vec<Ident>,
    /// Their type.
    pub ty: Type,
    /// Their clock.
    pub clock: Option<Clock>,
    /// Value where none is given.
    pub default: Option<Expr>,
    /// All of it.
    pub span: Span,
}

/// Constants: `a, b: T = e`. Without a type it is inferred from the value, without a value it comes
/// from outside. Where both are absent a fault has been reported.
#[derive(Clone, PartialEq, Debug)]
pub struct ConstDef {
    /// Doc comment before it.
    pub doc: Option<Doc>,
    /// The names, at least one.
    pub names: Vec<Ident>,
    /// Their type, inferred if absent.
    pub ty: Option<Type>,
    /// Their value; absent if it comes from outside.
    pub value: Option<Expr>,
    /// All of it.
    pub span: Span,
}

/// Local declarations and `let ... tel`.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Body {
    /// `var` and `const` sections before `let`.
    pub locals: Vec<Locals>,
    /// What stands between `let` and `tel`.
    pub statements: Vec<Statement>,
}

/// One section of local declarations.
#[derive(Clone, PartialEq, Debug)]
pub enum Locals {
    /// `var x: int; y: bool;`
    Var(Vec<VarDecl>),
    /// `const n = 3;`
    Const(Vec<ConstDef>),
}

/// One equation, or what else stands in a body.
#[derive(Clone, PartialEq, Debug)]
pub struct Statement {
    /// Doc comment before it.
    pub doc: Option<Doc>,
    /// What it is.
    pub kind: StatementKind,
    /// All of it, with its `;`.
    pub span: Span,
}

/// The kinds of statements.
#[derive(Clone, PartialEq, Debug)]
pub enum StatementKind {
    /// `x, y = e;`
    Equation(Box<Equation>),
    /// `f(x);`: a call for its effect; the expression is an [`ExprKind::Call`](super::ExprKind::Call)
    Call(Box<Expr>),
    /// `assert e;`, `assume e;`, `guarantee e;`, `check e;`
    Claim(Box<Claim>),
    /// `finish r when c;`, `yield ...`, `fail ...`
    End(Box<End>),
    /// `export x, y.z;`
    Export(Vec<Dotted>),
    /// A fragment in place
    Fragment(Box<FragmentDecl>),
    /// `automaton ... end`
    Automaton(Box<Automaton>),
    /// `if c then x = 1; else x = 2; fi` (Kind 2)
    Choice(Box<Choice>),
    /// `frame (x) x = 0; let ... tel` (Kind 2)
    Keep(Box<Keep>),
    /// A statement with a fault; the names that it seems to define
    Broken(Vec<Ident>),
}

/// Equations that hold by conditions.
#[derive(Clone, PartialEq, Debug)]
pub struct Choice {
    /// How it is written.
    pub word: ChoiceWord,
    /// The branches in text order, at least one.
    pub branches: Vec<ChoiceBranch>,
    /// What holds if no condition does.
    pub otherwise: Option<Vec<Statement>>,
    /// What it stands for: an equation for each flow.
    pub means: Meaning,
}

/// The ways to write a [`Choice`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ChoiceWord {
    /// `if c then ... elsif d then ... else ... fi`
    If,
    /// `when c then ... else ... end`
    When,
    /// `cond | c: ... | d: ... otherwise: ... end`
    Cond,
}

/// One branch of a [`Choice`].
#[derive(Clone, PartialEq, Debug)]
pub struct ChoiceBranch {
    /// When it is taken.
    pub condition: Expr,
    /// What holds then.
    pub statements: Vec<Statement>,
}

/// `frame (names) initial let statements tel`
#[derive(Clone, PartialEq, Debug)]
pub struct Keep {
    /// The flows that keep their values where nothing in the block defines them.
    pub names: Vec<Ident>,
    /// Their values in the first cycle.
    pub initial: Vec<Statement>,
    /// What defines them.
    pub statements: Vec<Statement>,
    /// What it stands for: an equation for each flow.
    pub means: Meaning,
}

/// The equations that a block stands for.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Meaning {
    /// The equations with their places.
    pub equations: Vec<(Equation, Span)>,
    /// What is wrong with the block.
    pub faults: Vec<BlockFault>,
}

/// What can be wrong with a block of equations.
#[derive(Clone, PartialEq, Debug)]
pub enum BlockFault {
    /// A flow without equation in some branch: the flow as it is defined in another, and the branch.
    MissingIn(Ident, Span),
    /// Something else than an equation or a block in it, in words.
    NoEquation(Span, &'static str),
    /// An equation for a flow that the `frame` does not name.
    NotNamed(Ident),
    /// Flows that a branch defines twice: again, and first.
    Twice(Ident, Span),
}

/// `x, arm.tcp, a[2] = rhs`
#[derive(Clone, PartialEq, Debug)]
pub struct Equation {
    /// What is defined; empty in `() = f(x)`.
    pub targets: Vec<Target>,
    /// By what.
    pub value: Expr,
}

/// A flow, or a part of one, that an equation defines.
#[derive(Clone, PartialEq, Debug)]
pub struct Target {
    /// The flow or device.
    pub name: Ident,
    /// The part of it.
    pub path: Vec<Access>,
    /// All of it.
    pub span: Span,
}

/// A condition that is claimed to hold in every cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct Claim {
    /// By whom it must hold.
    pub kind: ClaimKind,
    /// What it is about, in words: `assume "sensor range" x < 5.0`.
    pub label: Option<Ident>,
    /// The condition.
    pub condition: Expr,
    /// `provided c`: when it has to hold (Kind 2).
    pub provided: Option<Expr>,
}

/// The kinds of claims.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ClaimKind {
    /// In a body: holds, by the writer's word.
    Assert,
    /// In a body: to be shown (Kind 2).
    Check,
    /// The same as a remark for tools: `--%PROPERTY x;`.
    Property,
    /// In a contract: the caller sees to it.
    Assume,
    /// In a contract: the body sees to it.
    Guarantee,
}

/// `finish result when condition`
#[derive(Clone, PartialEq, Debug)]
pub struct End {
    /// In which way the command ends.
    pub kind: EndKind,
    /// The name of the result.
    pub result: Ident,
    /// When.
    pub condition: Expr,
}

/// In which way a command ends.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum EndKind {
    /// `finish`: everything at rest.
    Finish,
    /// `yield`: may be in motion, into a successor.
    Yield,
    /// `fail`: an error.
    Fail,
}

/// `automaton states end`
#[derive(Clone, PartialEq, Debug)]
pub struct Automaton {
    /// The states in text order, at least one.
    pub states: Vec<State>,
}

/// One state of an automaton.
#[derive(Clone, PartialEq, Debug)]
pub struct State {
    /// Doc comment before it.
    pub doc: Option<Doc>,
    /// Whether the automaton starts here.
    pub initial: bool,
    /// Its name.
    pub name: Ident,
    /// Strong transitions, decided before the state runs in a cycle.
    pub unless: Vec<Transition>,
    /// What runs in it.
    pub body: Body,
    /// Weak transitions, which act in the next cycle.
    pub until: Vec<Transition>,
    /// All of it.
    pub span: Span,
}

/// `condition then target`, one alternative of an `unless` or `until`.
#[derive(Clone, PartialEq, Debug)]
pub struct Transition {
    /// When; absent for `otherwise`.
    pub condition: Option<Expr>,
    /// `continue` instead of `then`: the target resumes its state.
    pub resumes: bool,
    /// The next state.
    pub target: Ident,
    /// All of it.
    pub span: Span,
}
