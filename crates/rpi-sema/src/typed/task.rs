//! What is known of a task beside its parameters.

use super::{ExprId, FlowId, UnitId};
use crate::program::DeclId;
use rpi_diag::Span;

/// What a step of a task runs, and with what.
#[derive(Clone, Debug)]
pub struct TaskStep {
    /// Where it is named.
    pub span: Span,
    /// The command or task.
    pub decl: DeclId,
    /// It, for the static arguments that are given.
    pub unit: UnitId,
    /// For each of its [inputs](super::Unit::inputs) what is given, if something is.
    pub args: Vec<Option<ExprId>>,
    /// What it takes over, from each command that may come before it.
    pub handed: Vec<Handed>,
}

/// A value that a command takes over (`given`) from one that runs before it (M7.3).
#[derive(Clone, Copy, Debug)]
pub struct Handed {
    /// The flow of the command that takes it over.
    pub flow: FlowId,
    /// The command that hands it over.
    pub by: UnitId,
    /// Index among the exports of that one's body.
    pub export: usize,
    /// Where the task runs that one.
    pub span: Span,
}
