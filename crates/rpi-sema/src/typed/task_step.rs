//! Steps of tasks.

use crate::program::DeclId;
use crate::typed::{ExprId, FlowId, UnitId};
use rpi_diag::Span;

/// Step of a task after checking: the command or task that it runs, with its arguments.
#[derive(Clone, PartialEq, Debug)]
pub struct TaskStep {
    /// Location of the name of the command or task in the step.
    pub span: Span,
    /// Declaration of the command or task that the step runs.
    pub decl: DeclId,
    /// Unit of the command or task for the given static arguments.
    pub unit: UnitId,
    /// Arguments, one for each of the unit's [inputs](super::Unit::inputs); `None` for an input that uses its default.
    pub args: Vec<Option<ExprId>>,
    /// Values that the command takes over from preceding commands, listed for each command that may run before it.
    pub taken_over: Vec<TakenOverValue>,
}

/// Value that a command takes over (`given`) from a command that runs before it (M7.3).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct TakenOverValue {
    /// Flow of the command that takes over the value, which gets the value.
    pub flow: FlowId,
    /// Unit of the command that runs before and provides the value.
    pub predecessor: UnitId,
    /// Index of the value among the exports of the body of the command that runs before.
    pub export: usize,
    /// Location of the step that runs the command before.
    pub span: Span,
}
