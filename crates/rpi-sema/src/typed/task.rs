//! What is known of a task beside its parameters.

use super::{ExprId, UnitId};
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
}
