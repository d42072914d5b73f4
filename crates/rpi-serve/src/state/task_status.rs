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
    /// The task has ended and runs no command any more. The value is the outcome.
    Ended(TaskEnd),
    /// The task was removed from the server.
    Unloaded,
}

impl TaskPhase {
    /// All states.
    pub(crate) const ALL: [TaskPhase; 8] = [
        TaskPhase::Loading,
        TaskPhase::Ready,
        TaskPhase::Running,
        TaskPhase::Cancelling,
        TaskPhase::Ended(TaskEnd::Done),
        TaskPhase::Ended(TaskEnd::Failed),
        TaskPhase::Ended(TaskEnd::Cancelled),
        TaskPhase::Unloaded,
    ];

    /// Returns the name of the state in the JSON-RPC protocol.
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

/// Report about an ended command of a task, for clients.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Step {
    pub(super) id: CommandId,
    pub(crate) title: String,
    pub(crate) result: Option<String>,
    pub(crate) cause: &'static str,
    /// Fault or reason of the abort; `None` if the command ended regularly.
    pub(crate) why: Option<String>,
    /// Location of the fault in the program; `None` if no fault ended the command.
    pub(crate) place: Option<SourceLocation>,
    /// Names of the devices that were moving when the command ended; they brake within their own limits.
    pub(crate) braked: Vec<String>,
    /// Description of the discontinuity of the set-points at the command's takeover; `None` if there was none.
    pub(crate) jump: Option<String>,
    pub(crate) error: i64,
    pub(crate) cycles: u64,
    /// Whether a branch of the task handles the error with which the command ended.
    pub(crate) handled: bool,
}

/// Progress of a task, as reported to clients.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct TaskStatus {
    pub(crate) phase: TaskPhase,
    /// Names and titles of the running commands.
    pub(crate) running: Vec<(String, String)>,
    /// The latest ended commands, oldest first; at most [`REMEMBERED`].
    pub(crate) steps: Vec<Step>,
    /// Number of commands whose predecessors ended before they were scheduled as successors, so that they started late.
    pub(crate) late: u64,
    /// Number of late commands that could have taken over while the devices moved, if they had been scheduled in time.
    pub(crate) missed_in_motion: u64,
    /// Commands of the task that could not be started, and the reason; `None` if there was no such error.
    pub(crate) error: Option<String>,
}

/// Maximum number of ended commands in the status of a task; the oldest is removed.
const REMEMBERED: usize = 100;

impl Step {
    /// Creates the report about the command with this id, which is part of a task; `None` if the command has not ended.
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

    /// Adds an ended command, and removes the oldest one if there are too many.
    pub(super) fn push(&mut self, step: Step) {
        self.steps.push(step);
        if self.steps.len() > REMEMBERED {
            self.steps.remove(0);
        }
    }

    /// Marks the latest report about the command with this id: a branch of the task handles the error with which the
    /// command ended.
    pub(super) fn handled(&mut self, id: CommandId) {
        let mut steps = self.steps.iter_mut().rev();
        if let Some(step) = steps.find(|step| step.id == id) {
            step.handled = true;
        }
    }
}
