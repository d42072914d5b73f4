//! Tasks: sequences and branches of commands.

use super::{Arg, Callee, Doc, Expr, Ident, StaticParam, VarDecl};
use rpi_diag::Span;

/// Declaration of a task: `task T (params) let steps tel`.
#[derive(Clone, PartialEq, Debug)]
pub struct TaskDecl {
    /// Name of the task.
    pub name: Ident,
    /// Static parameters, written `<<...>>`; empty if there are none.
    pub statics: Vec<StaticParam>,
    /// Parameters of the task: devices and values.
    pub params: Vec<VarDecl>,
    /// Steps in text order.
    pub steps: Vec<Step>,
}

/// Step of a task: the call of a command or task, a repetition, or parallel branches.
#[derive(Clone, PartialEq, Debug)]
pub struct Step {
    /// Doc comment before the step.
    pub doc: Option<Doc>,
    /// Form of the step (call, repetition, ...), with its parts.
    pub kind: StepKind,
    /// Range of the whole construct in the source text, `;` included.
    pub span: Span,
}

/// Form of a step in a task, with its parts.
#[derive(Clone, PartialEq, Debug)]
pub enum StepKind {
    /// Call of a command or task, with branches on its result: `search: Search(arm, hole) on found then push;`
    Run(Box<Run>),
    /// Repetition of steps: `repeat n times let ... tel`, or endless without `n times`
    Repeat {
        /// Number of repetitions; endless if absent.
        count: Option<Expr>,
        /// Repeated steps in text order.
        steps: Vec<Step>,
    },
    /// Branches that run concurrently: `parallel let ... tel let ... tel`
    Parallel(Vec<ParallelBranch>),
    /// Label of the step with which the task starts: `start search;`
    Start(Ident),
    /// Placeholder for a step with a syntax error, with the labels that it seems to define.
    Error(Vec<Ident>),
}

/// Concurrent branch of a `parallel` step.
#[derive(Clone, PartialEq, Debug)]
pub struct ParallelBranch {
    /// Steps of the branch in text order.
    pub steps: Vec<Step>,
    /// Source range from `let` to `tel`.
    pub span: Span,
}

/// Step that runs a command or task.
#[derive(Clone, PartialEq, Debug)]
pub struct Run {
    /// Label of the step, to which branches refer; absent if not written.
    pub label: Option<Ident>,
    /// Command or task to run.
    pub callee: Callee,
    /// Arguments of the command or task, in text order.
    pub args: Vec<Arg>,
    /// Continuations by result, in text order. If empty, the next step in the text follows.
    pub branches: Vec<Branch>,
}

/// Branch of a step on results of its command: `on lost, fail then retreat`.
#[derive(Clone, PartialEq, Debug)]
pub struct Branch {
    /// Results that select the branch, at least one.
    pub results: Vec<ResultPattern>,
    /// Step with which the task continues, or its end.
    pub next: NextStep,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Result that selects a branch of a step.
#[derive(Clone, PartialEq, Debug)]
pub enum ResultPattern {
    /// The result with this name: `lost`
    Named(Ident),
    /// Any result of the kind `fail`, written `fail`. The span is that of the word.
    Fail(Span),
    /// Any result, written `any`. The span is that of the word.
    Any(Span),
}

/// Continuation of a task after a step: a step with a label, or the end.
#[derive(Clone, PartialEq, Debug)]
pub enum NextStep {
    /// Continues with the step that has this label.
    Step(Ident),
    /// Ends the task or the enclosing parallel branch, written `end`. The span is that of the word.
    End(Span),
}
