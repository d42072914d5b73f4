//! Steps of tasks.

use crate::program::DeclId;
use crate::typed::{ExprId, FlowId, UnitId};
use rpi_diag::Span;

/// Step of a task after checking: the command or task that it runs, with its arguments.
#[derive(Clone, Debug)]
pub struct TaskStep {
    /// Span of the name in the step.
    pub span: Span,
    /// Declaration of the command or task.
    pub decl: DeclId,
    /// Unit of the command or task for the given static arguments.
    pub unit: UnitId,
    /// Arguments, one for each of the unit's [inputs](super::Unit::inputs); none for a default.
    pub args: Vec<Option<ExprId>>,
    /// Values that the command takes over, from each possible predecessor.
    pub taken_over: Vec<TakenOverValue>,
}

/// Value that a command takes over (`given`) from a preceding command (M7.3).
#[derive(Clone, Copy, Debug)]
pub struct TakenOverValue {
    /// Flow of the command that takes over the value.
    pub flow: FlowId,
    /// Preceding command.
    pub predecessor: UnitId,
    /// Index among the exports of the preceding command's body.
    pub export: usize,
    /// Span of the step that runs the preceding command.
    pub span: Span,
}
