//! Tasks: which command follows which.

use super::{Arg, Callee, Doc, Expr, Ident, StaticParam, VarDecl};
use rpi_diag::Span;

/// `task T (params) let steps tel`
#[derive(Clone, PartialEq, Debug)]
pub struct TaskDecl {
    /// The name declared.
    pub name: Ident,
    /// `<<...>>`
    pub statics: Vec<StaticParam>,
    /// Devices and values.
    pub params: Vec<VarDecl>,
    /// Its steps in text order.
    pub steps: Vec<Step>,
}

/// One step of a task.
#[derive(Clone, PartialEq, Debug)]
pub struct Step {
    /// Doc comment before it.
    pub doc: Option<Doc>,
    /// What it is.
    pub kind: StepKind,
    /// All of it, with its `;`.
    pub span: Span,
}

/// The kinds of steps.
#[derive(Clone, PartialEq, Debug)]
pub enum StepKind {
    /// `search: Search(arm, hole) on found then push;`
    Run(Box<Run>),
    /// `repeat n times let ... tel`; without a count for ever
    Repeat {
        /// How often.
        count: Option<Expr>,
        /// What.
        steps: Vec<Step>,
    },
    /// `parallel let ... tel let ... tel`: all at once
    Parallel(Vec<Strand>),
    /// `start search;`: the step that comes first
    Start(Ident),
    /// A step with a fault; the labels that it seems to define
    Broken(Vec<Ident>),
}

/// Steps of a task that are run beside others.
#[derive(Clone, PartialEq, Debug)]
pub struct Strand {
    /// In text order.
    pub steps: Vec<Step>,
    /// From its `let` to its `tel`.
    pub span: Span,
}

/// A command or task that is run.
#[derive(Clone, PartialEq, Debug)]
pub struct Run {
    /// The name of the step.
    pub label: Option<Ident>,
    /// The command or task.
    pub callee: Callee,
    /// Its parameters.
    pub args: Vec<Arg>,
    /// What follows which result; empty: the next step.
    pub branches: Vec<Branch>,
}

/// `on lost, fail then retreat`
#[derive(Clone, PartialEq, Debug)]
pub struct Branch {
    /// The results, at least one.
    pub on: Vec<OnResult>,
    /// What follows.
    pub then: Next,
    /// All of it.
    pub span: Span,
}

/// A result that a branch is for.
#[derive(Clone, PartialEq, Debug)]
pub enum OnResult {
    /// `lost`
    Named(Ident),
    /// `fail`: any `fail` result
    Fail(Span),
    /// `any`: any result
    Any(Span),
}

/// What follows a step.
#[derive(Clone, PartialEq, Debug)]
pub enum Next {
    /// Another step.
    Step(Ident),
    /// `end`: nothing, the task is done, or the strand in which it stands.
    End(Span),
}
