//! Tasks: sequences and branches of commands.

use super::{Arg, Callee, Doc, Expr, Ident, StaticParam, VarDecl};
use rpi_diag::Span;

/// Declaration of a task: `task T (params) let steps tel`.
#[derive(Clone, PartialEq, Debug)]
pub struct TaskDecl {
    /// Declared name.
    pub name: Ident,
    /// Static parameters: `<<...>>`.
    pub statics: Vec<StaticParam>,
    /// Parameters: devices and values.
    pub params: Vec<VarDecl>,
    /// Steps in text order.
    pub steps: Vec<Step>,
}

/// Step of a task: the call of a command or task, a repetition, or parallel branches.
#[derive(Clone, PartialEq, Debug)]
pub struct Step {
    /// Doc comment before the step.
    pub doc: Option<Doc>,
    /// Form of the step, with its parts.
    pub kind: StepKind,
    /// Source range, `;` included.
    pub span: Span,
}

/// Forms of steps in a task: a call, a repetition or parallel branches.
#[derive(Clone, PartialEq, Debug)]
pub enum StepKind {
    /// `search: Search(arm, hole) on found then push;`
    Run(Box<Run>),
    /// `repeat n times let ... tel`; endless without a count
    Repeat {
        /// Number of repetitions; endless if absent.
        count: Option<Expr>,
        /// Repeated steps in text order.
        steps: Vec<Step>,
    },
    /// `parallel let ... tel let ... tel`: concurrent branches
    Parallel(Vec<ParallelBranch>),
    /// `start search;`: label of the first step
    Start(Ident),
    /// Step with an error; the labels that it seems to define
    Error(Vec<Ident>),
}

/// Concurrent branch of a `parallel` step.
#[derive(Clone, PartialEq, Debug)]
pub struct ParallelBranch {
    /// Steps in text order.
    pub steps: Vec<Step>,
    /// Source range from `let` to `tel`.
    pub span: Span,
}

/// Step that runs a command or task.
#[derive(Clone, PartialEq, Debug)]
pub struct Run {
    /// Label of the step.
    pub label: Option<Ident>,
    /// Command or task to run.
    pub callee: Callee,
    /// Arguments of the command or task, in text order.
    pub args: Vec<Arg>,
    /// Branches on the result. If empty, the next step follows.
    pub branches: Vec<Branch>,
}

/// Branch on results: `on lost, fail then retreat`.
#[derive(Clone, PartialEq, Debug)]
pub struct Branch {
    /// Results, at least one.
    pub results: Vec<ResultPattern>,
    /// Continuation.
    pub next: NextStep,
    /// Source range.
    pub span: Span,
}

/// Result that selects a branch.
#[derive(Clone, PartialEq, Debug)]
pub enum ResultPattern {
    /// `lost`
    Named(Ident),
    /// `fail`: any `fail` result
    Fail(Span),
    /// `any`: any result
    Any(Span),
}

/// Where a task goes on after a step.
#[derive(Clone, PartialEq, Debug)]
pub enum NextStep {
    /// Continues with the step that has this label.
    Step(Ident),
    /// `end`: ends the task or the enclosing parallel branch.
    End(Span),
}
