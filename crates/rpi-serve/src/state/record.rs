//! State of one command in the server.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rpi_core::Overrun;
use rpi_image::Image;
use rpi_image::image::{CommandEnd, CommandEndKind};
use rpi_net::CommandInput;
use rpi_runtime::control::{Cause, CommandId, CommandState, Ending, ExportSnapshot};

use super::completion::Completion;
use super::eval::Eval;
use super::subscriptions::{Exported, Subscriptions};
use super::types::{ApiError, Phase, Reply, Status};
use crate::compile::Source;

/// State of a command in the server: its sources, its life-cycle state, its subscribers and its policies.
pub(crate) struct CommandRecord {
    /// Id of the command in the core; `None` until the command was sent to the core.
    pub(crate) id: Option<CommandId>,
    pub(crate) session: u64,
    /// Title for display: the one chosen by the client, else the name of the command in its source text.
    pub(crate) title: String,
    /// Number of the task that the command is part of; `None` for a command that a client has loaded itself.
    pub(super) task: Option<u64>,
    /// Source text of the command with its language, for pages that show the command; `None` for a command of a task.
    pub(crate) origin: Option<Source>,
    /// Source text of the command or of its task, to convert offsets of errors to lines.
    pub(super) text: Option<Arc<str>>,
    /// Inputs whose values the command takes over from its predecessor when it starts. Those that a client has set are
    /// no longer required.
    pub(super) given: Vec<CommandInput>,
    pub(crate) status: Status,
    pub(crate) image: Option<Arc<Image>>,
    pub(super) snapshot: Option<Arc<ExportSnapshot>>,
    pub(super) subscriptions: Subscriptions,
    pub(super) completion: Completion,
    /// Callback for the result of loading; `None` once the result was reported.
    pub(super) loading: Option<Reply>,
    /// Request to evaluate a net, if the command runs for a single cycle only.
    pub(super) eval: Option<Eval>,
    /// Whether the command is to be unloaded once it has ended.
    pub(super) unload_at_end: bool,
    /// Time within which the command must end after a cancel request; `None` for the time of its session.
    pub(super) grace: Option<Duration>,
    /// Time at which the command is aborted because it has not ended after a cancel request; `None` without such a
    /// request.
    pub(super) deadline: Option<Instant>,
    /// Memory of the command in bytes. The source text counts if a client has loaded the command itself, not as part of
    /// a task.
    pub(super) bytes: usize,
}

impl CommandRecord {
    /// Creates the record of a command that is not loaded yet, of the session with this number.
    pub(super) fn new(session: u64, title: &str, phase: Phase) -> CommandRecord {
        CommandRecord {
            id: None,
            session,
            title: title.to_owned(),
            task: None,
            origin: None,
            text: None,
            given: Vec::new(),
            status: Status::new(phase),
            image: None,
            snapshot: None,
            subscriptions: Subscriptions::default(),
            completion: Completion::default(),
            loading: None,
            eval: None,
            unload_at_end: false,
            grace: None,
            deadline: None,
            bytes: 0,
        }
    }

    /// Returns the name and the title of the command with this number, for the log.
    pub(super) fn display_name(&self, number: u64) -> String {
        display_name(&format!("n{number}"), &self.title)
    }

    /// Returns whether the command runs or is being cancelled.
    pub(super) fn runs(&self) -> bool {
        let runs = [CommandState::Running, CommandState::Cancelling].map(Phase::Core);
        runs.contains(&self.status.phase)
    }

    /// Returns whether the command has ended and is not unloaded yet.
    pub(super) fn has_ended(&self) -> bool {
        self.status.phase == Phase::Core(CommandState::Terminated)
    }

    /// Returns an error if a required input has no value: a command that is started by request has no predecessor from
    /// which it could take the value over. `name` is the name of the command.
    pub(super) fn ensure_inputs_set(&self, name: &str) -> Result<(), ApiError> {
        let needed = self.given.iter().filter(|given| given.is_required);
        let needed: Vec<&str> = needed.map(|given| given.key.as_str()).collect();
        let waits = self.status.phase == Phase::Core(CommandState::Ready);
        match needed.is_empty() || !waits {
            true => Ok(()),
            false => Err(ApiError::Invalid(format!(
                "{name} takes over {} but has no predecessor; set it (`command.set`) or schedule {name} after a command",
                needed.join(", ")
            ))),
        }
    }

    /// Returns whether the command uses the device with this name as a sensor, as an actuator or in a function.
    pub(super) fn uses(&self, device: &str) -> bool {
        self.image.as_ref().is_some_and(|image| {
            let sensors = image.sensors.iter().map(|s| &s.port);
            let actuators = image.actuators.iter().map(|a| &a.port);
            let functions = image.functions.iter().map(|f| &f.port);
            let mut ports = sensors.chain(actuators).chain(functions);
            ports.any(|port| port.device == device)
        })
    }

    /// Changes the life-cycle state of the command and reports a new state to all subscribers.
    pub(super) fn set_phase(&mut self, phase: Phase) {
        if self.status.phase != phase {
            self.status.phase = phase;
            self.publish_state();
        }
    }

    fn publish_state(&mut self) {
        let exported = Exported::new(self.snapshot.as_deref(), self.image.as_deref());
        self.subscriptions.report_state(&self.status, &exported);
    }

    /// Reports changed exports to the subscribers whose update periods have elapsed at `now`.
    pub(super) fn publish(&mut self, now: Instant) {
        let exported = Exported::new(self.snapshot.as_deref(), self.image.as_deref());
        self.subscriptions.publish(now, &exported);
    }

    /// Reports changed exports to all subscribers, even if their update periods have not elapsed.
    pub(super) fn publish_now(&mut self) {
        let exported = Exported::new(self.snapshot.as_deref(), self.image.as_deref());
        self.subscriptions.publish_now(&exported);
    }

    /// Returns the current values of the exports that have one: key and literal of each.
    pub(crate) fn values(&self) -> Vec<(String, String)> {
        Exported::new(self.snapshot.as_deref(), self.image.as_deref()).values()
    }

    /// Returns the number of cycles that the command has run; 0 before it is loaded.
    pub(crate) fn cycles(&self) -> u64 {
        self.snapshot
            .as_ref()
            .map_or(0, |snapshot| snapshot.cycles())
    }

    /// Returns the period of the command's cycles in nanoseconds; 0 before it is loaded.
    pub(crate) fn period_ns(&self) -> u64 {
        self.image.as_ref().map_or(0, |image| image.period_ns)
    }

    /// Returns the number of overruns of the command's cycles and the worst one; `None` if there was none.
    pub(crate) fn overruns(&self) -> Option<(u64, Overrun)> {
        self.snapshot
            .as_ref()
            .and_then(|snapshot| snapshot.overruns())
    }

    /// Returns the path of the fragment with this index in the command's image; empty for the command itself. `None` if
    /// the command is not loaded or has no such fragment.
    pub(crate) fn fragment(&self, index: u32) -> Option<&str> {
        let image = self.image.as_ref()?;
        let fragment = image.fragments.get(index as usize)?;
        Some(&fragment.path)
    }

    /// Returns the memory of the command in bytes, including its source text if a client has loaded the command itself.
    pub(crate) fn bytes(&self) -> usize {
        self.bytes
    }
}

/// Returns the text by which messages refer to a command or task: `name (title)`, or the name alone if the title is
/// empty.
pub(super) fn display_name(name: &str, title: &str) -> String {
    match title {
        "" => name.to_owned(),
        title => format!("{name} ({title})"),
    }
}

/// Returns the names of the results by which a command can end.
pub(crate) fn results(image: &Image) -> Vec<&str> {
    match &image.end {
        CommandEnd::Results(results) => results.iter().map(|r| r.name.as_str()).collect(),
        CommandEnd::Ports { .. } => Vec::new(),
    }
}

/// Returns whether a command has ended in motion by `yield` and a successor has continued the motion.
pub(super) fn has_yielded(image: &Image, ending: &Ending) -> bool {
    let (Cause::Result(k), CommandEnd::Results(results)) = (ending.cause, &image.end) else {
        return false;
    };
    let kind = results.get(k).map(|r| r.kind);
    kind == Some(CommandEndKind::Yield) && !ending.left_moving
}
