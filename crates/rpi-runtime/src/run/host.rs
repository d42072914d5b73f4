//! Host side of a run: handles events, collects the outcome, forwards samples and advances the tasks.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rpi_core::{CommandId, Ending, LoadError, Notice, OverrunStats, Rule, RuleId};
use rpi_device::Discontinuity;
use rpi_image::Image;
use rpi_sim::Cell;

use super::end_text;
use super::inputs::IndexedValue;
use super::outcome::{CommandEnd, CommandOverruns, RunEnd};
use super::plan::ExecutablePlan;
use super::recorder::RunRecorder;
use super::samples::{Channel, SampleReceiver, Sink};
use super::task_runner::{NotStartedError, Task, TaskCore};
use crate::control::{Control, Event, InputValue, RequestError, Ticket};

/// Maximum number of commands that the outcome of a run lists. The limit bounds the memory of an endless task.
const LISTED: usize = 1000;

/// The part of a run outside the cycle: it advances the tasks, processes the events of the core and collects the
/// outcome.
pub(super) struct Host<'a> {
    pub(super) context: TaskContext<'a>,
    pub(super) tasks: Vec<Task<&'a ExecutablePlan>>,
    pub(super) drain: SampleReceiver,
    pub(super) channels: Vec<Channel>,
    pub(super) command_log: CommandLog<'a>,
    /// Number of the last tick from which a sample has arrived.
    pub(super) last_tick: u64,
    /// Recorder of the run; `None` if the run is not recorded.
    pub(super) recorder: Option<Box<dyn RunRecorder>>,
}

/// State that the tasks of a run need to load and start commands.
pub(super) struct TaskContext<'a> {
    pub(super) control: Control,
    pub(super) images: &'a [Arc<Image>],
    pub(super) cell: &'a Cell,
    /// For each image, the values that the user gives for its inputs.
    pub(super) input_values: Vec<Vec<IndexedValue>>,
    /// Number of the next tick, which the cycle updates.
    pub(super) now: Arc<AtomicU64>,
    /// Number of ticks to wait after the start of a command before its successors are scheduled. It simulates the time
    /// that planning takes.
    pub(super) planning_ticks: u64,
    /// Number of successors that were not yet scheduled when their predecessors ended.
    pub(super) late_successors: u64,
    /// Number of these late successors that could have taken over while the devices moved.
    pub(super) missed_takeovers: u64,
}

impl TaskContext<'_> {
    pub(super) fn tick(&self) -> u64 {
        self.now.load(Ordering::Acquire)
    }

    /// Loads the command with this index in the list of images and sets the input values given by the user.
    pub(super) fn load(&mut self, index: usize) -> Result<CommandId, RequestError> {
        let id = self.control.load(Arc::clone(&self.images[index]))?;
        let setting = |(input, value): &IndexedValue| InputValue {
            command: id,
            input: *input,
            value: value.clone().into(),
        };
        let settings: Vec<InputValue> = self.input_values[index].iter().map(setting).collect();
        if !settings.is_empty() {
            self.control.set(settings)?;
        }
        Ok(id)
    }
}

/// Adapter through which the tasks of a run use the control core and report to the command log.
struct TaskCoreAdapter<'b, 'a> {
    context: &'b mut TaskContext<'a>,
    command_log: &'b mut CommandLog<'a>,
}

impl TaskCore for TaskCoreAdapter<'_, '_> {
    fn image(&self, index: usize) -> Arc<Image> {
        Arc::clone(&self.context.images[index])
    }

    fn load(&mut self, index: usize) -> Result<CommandId, RequestError> {
        self.context.load(index)
    }

    fn start(&mut self, id: CommandId) -> Result<Ticket, RequestError> {
        self.context.control.start(id)
    }

    fn schedule(&mut self, rule: Rule) -> Result<(RuleId, Ticket), RequestError> {
        self.context.control.schedule(rule)
    }

    fn cancel(&mut self, id: CommandId) {
        // A command that has ended in the meantime need not be cancelled, so a refusal is ignored.
        let _ = self.context.control.cancel(id);
    }

    fn unload(&mut self, id: CommandId) {
        // A refusal means that the command was already unloaded.
        let _ = self.context.control.unload(id);
    }

    fn can_plan(&self, first_tick: Option<u64>) -> bool {
        let planning = self.context.planning_ticks;
        first_tick.map_or(planning == 0, |first| {
            self.context.tick() >= first + planning
        })
    }

    fn report_late(&mut self, in_motion: bool) {
        self.context.late_successors += 1;
        self.context.missed_takeovers += u64::from(in_motion);
    }

    fn report_handled(&mut self, id: CommandId) {
        self.command_log.set_handled(id);
    }

    fn report_not_started(&mut self, indices: &[usize], why: NotStartedError) {
        let why = match why {
            NotStartedError::Rejected(RequestError::Load(faults)) => {
                return self.command_log.set_load_failure(indices, faults);
            }
            NotStartedError::Rejected(why) => why.to_string(),
            NotStartedError::Refused(why) => end_text::refusal_text(why, self.context.cell),
            // Rules are dropped when everything is stopped. The stop is reported for the running commands.
            NotStartedError::Dropped => return,
        };
        for index in indices {
            self.command_log.add_refused(*index, why.clone());
        }
    }
}

/// Log of the commands of a run and of their ends, filled in during the run.
pub(super) struct CommandLog<'a> {
    images: &'a [Arc<Image>],
    /// Commands in the order of their start, each with its id until it is freed.
    pub(super) commands: Vec<(Option<CommandId>, CommandEnd)>,
    /// Number of earlier commands that were removed from the log, because it was full.
    pub(super) unlisted: u64,
    /// Number of commands that ended in motion and were taken over.
    pub(super) blended: u64,
    /// Name of the command that could not be loaded, with the load errors; `None` if there was no such command.
    pub(super) load_failure: Option<(String, Vec<LoadError>)>,
}

impl<'a> CommandLog<'a> {
    pub(super) fn new(images: &'a [Arc<Image>]) -> CommandLog<'a> {
        CommandLog {
            images,
            commands: Vec::new(),
            unlisted: 0,
            blended: 0,
            load_failure: None,
        }
    }

    fn add_started(&mut self, id: CommandId, image: &Image, tick: u64) {
        if self.commands.len() == LISTED {
            self.commands.remove(0);
            self.unlisted += 1;
        }
        let end = CommandEnd {
            name: image.name.clone(),
            first_tick: Some(tick),
            cycles: 0,
            end: RunEnd::CutOff,
            braked: Vec::new(),
            handled: false,
            jump: None,
            overruns: None,
        };
        self.commands.push((Some(id), end));
    }

    /// Returns the log entry of a command; `None` if the command has none.
    fn entry_mut(&mut self, id: CommandId) -> Option<&mut CommandEnd> {
        let mut latest_first = self.commands.iter_mut().rev();
        let found = latest_first.find(|(known, _)| *known == Some(id));
        found.map(|(_, command)| command)
    }

    fn set_end(&mut self, id: CommandId, image: &Image, ending: Ending) {
        let end = end_text::run_end(image, ending);
        self.blended += u64::from(matches!(end, RunEnd::Result { moving: true, .. }));
        if let Some(command) = self.entry_mut(id) {
            command.cycles = ending.cycles;
            command.end = end;
        }
    }

    /// Records that the device with this name was moving when the command ended, and braked.
    fn add_braked(&mut self, id: CommandId, device: &str) {
        if let Some(command) = self.entry_mut(id)
            && !command.braked.iter().any(|known| known == device)
        {
            command.braked.push(device.to_owned());
        }
    }

    /// Records the number of overruns of a command and the worst one.
    pub(super) fn set_overruns(&mut self, id: CommandId, overruns: &OverrunStats) {
        let images = self.images;
        let (Some(command), Some(worst)) = (self.entry_mut(id), overruns.worst) else {
            return;
        };
        let image = images.iter().find(|image| image.name == command.name);
        let fragment = image.and_then(|i| i.fragments.get(worst.fragment as usize));
        command.overruns = Some(CommandOverruns {
            count: overruns.count,
            tick: worst.tick,
            took_ns: worst.took_ns,
            late_ns: worst.late_ns,
            fragment: fragment.map_or_else(String::new, |f| f.path.clone()),
        });
    }

    /// Records that a branch of the task handles the error with which the command ended.
    fn set_handled(&mut self, id: CommandId) {
        if let Some(command) = self.entry_mut(id) {
            command.handled = true;
        }
    }

    fn set_discontinuity(&mut self, id: CommandId, jump: &Discontinuity, cell: &Cell) {
        if let Some(command) = self.entry_mut(id) {
            command
                .jump
                .get_or_insert_with(|| end_text::discontinuity_text(jump, cell));
        }
    }

    /// Records that a command could not be loaded. `indices` are positions in the list of images; the first one is
    /// reported.
    pub(super) fn set_load_failure(&mut self, indices: &[usize], faults: Vec<LoadError>) {
        let name = indices
            .first()
            .map(|index| self.images[*index].name.clone());
        self.load_failure = name.map(|name| (name, faults));
    }

    /// Records that the command with this index in the list of images could not be started, for the reason `why`.
    pub(super) fn add_refused(&mut self, index: usize, why: String) {
        let end = CommandEnd {
            name: self.images[index].name.clone(),
            first_tick: None,
            cycles: 0,
            end: RunEnd::Refused { why },
            braked: Vec::new(),
            handled: false,
            jump: None,
            overruns: None,
        };
        self.commands.push((None, end));
    }
}

impl Host<'_> {
    /// Processes events, forwards samples to `sink` and advances the tasks. Called repeatedly during the run; never
    /// blocks.
    pub(super) fn serve(&mut self, sink: &mut dyn Sink) {
        self.process_events(sink);
        let mut core = TaskCoreAdapter {
            context: &mut self.context,
            command_log: &mut self.command_log,
        };
        for task in &mut self.tasks {
            task.advance(&mut core);
        }
    }

    /// Processes events and forwards samples to `sink`, without advancing the tasks.
    pub(super) fn process_events(&mut self, sink: &mut dyn Sink) {
        while let Some(event) = self.context.control.poll() {
            self.handle_event(&event);
        }
        let last_tick = &mut self.last_tick;
        self.drain.drain(|channel, tick, value| {
            *last_tick = tick;
            sink.sample(channel, tick, value);
        });
    }

    /// Returns true while the recorder of the run accepts data.
    pub(super) fn is_recorded(&self) -> bool {
        self.recorder
            .as_ref()
            .is_some_and(|recorder| recorder.writes())
    }

    /// Returns true once no task will start another command.
    pub(super) fn is_over(&self) -> bool {
        self.command_log.load_failure.is_some() || self.tasks.iter().all(|t| t.end().is_some())
    }

    /// Returns the command that was started last.
    pub(super) fn latest_command(&self) -> Option<&CommandEnd> {
        self.command_log.commands.last().map(|c| &c.1)
    }

    fn handle_event(&mut self, event: &Event) {
        if let Some(recorder) = &self.recorder {
            recorder.event(event);
        }
        if let Event::Notice(notice) = event {
            self.log_notice(notice);
        }
        for task in &mut self.tasks {
            task.handle_event(event);
        }
    }

    fn log_notice(&mut self, notice: &Notice) {
        let image = |id: CommandId| Some(Arc::clone(&self.context.control.get(id)?.image));
        match *notice {
            Notice::Started { command, tick } => {
                if let Some(image) = image(command) {
                    self.command_log.add_started(command, &image, tick);
                }
            }
            Notice::Braked {
                command, resource, ..
            } => {
                if let Some((device, _)) = self.context.cell.resource_owner(resource) {
                    self.command_log.add_braked(command, device);
                }
            }
            Notice::Discontinuity {
                command,
                discontinuity: jump,
            } => self
                .command_log
                .set_discontinuity(command, &jump, self.context.cell),
            Notice::Ended {
                command, ending, ..
            } => {
                if let Some(image) = image(command) {
                    self.command_log.set_end(command, &image, ending);
                }
            }
            _ => {}
        }
    }
}
