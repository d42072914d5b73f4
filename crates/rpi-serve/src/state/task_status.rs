//! Progress of a task, as clients see it.

use rpi_runtime::control::CommandId;
use rpi_runtime::run::TaskEnd;

use super::record::CommandRecord;
use super::source_location::SourceLocation;
use super::types::{cause_text, fault_text};

/// Life-cycle state of a task.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum TaskPhase {
    /// The commands of the task are being compiled.
    Loading,
    /// The task can be started.
    Ready,
    /// The task is running.
    Running,
    /// The task was cancelled and has not ended yet.
    Cancelling,
    /// The task runs no command any more. The value says with which outcome it ended.
    Ended(TaskEnd),
    /// The task was unloaded.
    Unloaded,
}

impl TaskPhase {
    /// Returns the name of the state in the protocol.
    pub(crate) fn name(self) -> &'static str {
        match self {
            TaskPhase::Loading => "loading",
            TaskPhase::Ready => "ready",
            TaskPhase::Running => "running",
            TaskPhase::Cancelling => "cancelling",
            TaskPhase::Ended(TaskEnd::Done) => "done",
            TaskPhase::Ended(TaskEnd::Failed) => "failed",
            TaskPhase::Ended(TaskEnd::Cancelled) => "cancelled",
            TaskPhase::Unloaded => "unloaded",
        }
    }
}

/// Ended command of a task, as reported to clients.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Step {
    pub(super) id: CommandId,
    pub(crate) title: String,
    pub(crate) result: Option<String>,
    pub(crate) cause: &'static str,
    /// Fault or reason of the abort, if the command did not end regularly.
    pub(crate) why: Option<String>,
    /// Location of the fault in the program, if a fault ended the command.
    pub(crate) place: Option<SourceLocation>,
    /// Devices that the command left moving; they brake on their own.
    pub(crate) braked: Vec<String>,
    /// Description of the discontinuity at its takeover, if there was one.
    pub(crate) jump: Option<String>,
    pub(crate) error: i64,
    pub(crate) cycles: u64,
    /// Whether a branch of the task handles its error.
    pub(crate) handled: bool,
}

/// Progress of a task, as reported to clients.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct TaskStatus {
    pub(crate) phase: TaskPhase,
    /// Names and titles of the running commands.
    pub(crate) running: Vec<(String, String)>,
    /// The latest ended commands.
    pub(crate) steps: Vec<Step>,
    /// Number of successors that were not scheduled when their predecessors ended.
    pub(crate) late: u64,
    /// Number of late successors that could have taken over while the devices moved.
    pub(crate) missed_in_motion: u64,
    /// Commands that could not be started, and the reason.
    pub(crate) error: Option<String>,
}

/// Maximum number of ended commands kept for a task.
const REMEMBERED: usize = 100;

impl Step {
    /// Creates the report about a command of a task; `None` if it has not ended.
    pub(super) fn of(id: CommandId, record: &CommandRecord) -> Option<Step> {
        let ending = record.status.ending?;
        Some(Step {
            id,
            title: record.title.clone(),
            result: record.status.result.clone(),
            cause: cause_text(&ending),
            why: fault_text(&ending),
            place: record.status.location.clone(),
            braked: record.status.braked.clone(),
            jump: record.status.discontinuity.clone(),
            error: ending.error,
            cycles: ending.cycles,
            handled: false,
        })
    }
}

impl TaskStatus {
    /// Creates the status of a task that is being loaded.
    pub(super) fn loading() -> TaskStatus {
        TaskStatus {
            phase: TaskPhase::Loading,
            running: Vec::new(),
            steps: Vec::new(),
            late: 0,
            missed_in_motion: 0,
            error: None,
        }
    }

    /// Adds an ended command.
    pub(super) fn push(&mut self, step: Step) {
        self.steps.push(step);
        if self.steps.len() > REMEMBERED {
            self.steps.remove(0);
        }
    }

    /// Notes that a branch of the task handles the error with which a command ended.
    pub(super) fn handled(&mut self, id: CommandId) {
        let mut steps = self.steps.iter_mut().rev();
        if let Some(step) = steps.find(|step| step.id == id) {
            step.handled = true;
        }
    }
}
