//! Host side of a run: handles events, collects the outcome, forwards samples and advances the tasks.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rpi_core::{CommandId, Ending, LoadFault, Notice, Overruns, Rule, RuleId};
use rpi_device::Jump;
use rpi_image::Image;
use rpi_sim::Cell;

use super::end;
use super::inputs::Set;
use super::outcome::{Blame, CommandEnd, RunEnd};
use super::plan::Plan;
use super::recorder::RunRecorder;
use super::samples::{Channel, Drain, Sink};
use super::task::{NotStarted, Task, Workshop};
use crate::control::{Control, Event, Rejected, Setting, Ticket};

/// Maximum number of listed commands. The limit bounds the memory of an endless task.
const LISTED: usize = 1000;

/// Host side of a run.
pub(super) struct Host<'a> {
    pub(super) desk: Desk<'a>,
    pub(super) tasks: Vec<Task<&'a Plan>>,
    pub(super) drain: Drain,
    pub(super) channels: Vec<Channel>,
    pub(super) books: Books<'a>,
    /// Last tick of which a sample has arrived.
    pub(super) last_tick: u64,
    /// Recorder of the run, if any.
    pub(super) recorder: Option<Box<dyn RunRecorder>>,
}

/// State that tasks need to load and start commands.
pub(super) struct Desk<'a> {
    pub(super) control: Control,
    pub(super) images: &'a [Arc<Image>],
    pub(super) cell: &'a Cell,
    /// Input values for each image.
    pub(super) sets: Vec<Vec<Set>>,
    /// Number of the next tick.
    pub(super) now: Arc<AtomicU64>,
    /// Number of ticks after the start of a command before its successors are scheduled.
    pub(super) planning: u64,
    /// Number of successors that were not yet scheduled when their predecessor ended.
    pub(super) late: u64,
    /// Number of these successors that could have taken over in motion.
    pub(super) missed: u64,
}

impl Desk<'_> {
    pub(super) fn tick(&self) -> u64 {
        self.now.load(Ordering::Acquire)
    }

    /// Loads a command and sets its input values.
    pub(super) fn load(&mut self, index: usize) -> Result<CommandId, Rejected> {
        let id = self.control.load(Arc::clone(&self.images[index]))?;
        let setting = |(input, value): &Set| Setting {
            command: id,
            input: *input,
            value: value.clone().into(),
        };
        let settings: Vec<Setting> = self.sets[index].iter().map(setting).collect();
        if !settings.is_empty() {
            self.control.set(settings)?;
        }
        Ok(id)
    }
}

/// Interface between the tasks of a run and the control core.
struct Bench<'b, 'a> {
    desk: &'b mut Desk<'a>,
    books: &'b mut Books<'a>,
}

impl Workshop for Bench<'_, '_> {
    fn image(&self, index: usize) -> Arc<Image> {
        Arc::clone(&self.desk.images[index])
    }

    fn load(&mut self, index: usize) -> Result<CommandId, Rejected> {
        self.desk.load(index)
    }

    fn start(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        self.desk.control.start(id)
    }

    fn schedule(&mut self, rule: Rule) -> Result<(RuleId, Ticket), Rejected> {
        self.desk.control.schedule(rule)
    }

    fn cancel(&mut self, id: CommandId) {
        // A command that has ended in the meantime need not be cancelled, so a refusal is ignored.
        let _ = self.desk.control.cancel(id);
    }

    fn unload(&mut self, id: CommandId) {
        // A refusal means that the command was already unloaded.
        let _ = self.desk.control.unload(id);
    }

    fn may_plan(&self, first_tick: Option<u64>) -> bool {
        let planning = self.desk.planning;
        first_tick.map_or(planning == 0, |first| self.desk.tick() >= first + planning)
    }

    fn late(&mut self, in_motion: bool) {
        self.desk.late += 1;
        self.desk.missed += u64::from(in_motion);
    }

    fn handled(&mut self, id: CommandId) {
        self.books.handled(id);
    }

    fn not_started(&mut self, indices: &[usize], why: NotStarted) {
        let why = match why {
            NotStarted::Rejected(Rejected::Loading(faults)) => {
                return self.books.not_loaded(indices, faults);
            }
            NotStarted::Rejected(why) => why.to_string(),
            NotStarted::Refused(why) => end::refused(why, self.desk.cell),
            // Rules are dropped when everything is stopped. The stop is reported for the running commands.
            NotStarted::Dropped => return,
        };
        for index in indices {
            self.books.not_started(*index, why.clone());
        }
    }
}

/// Outcome of the commands, collected during the run.
pub(super) struct Books<'a> {
    images: &'a [Arc<Image>],
    /// Commands in the order of their start.
    pub(super) commands: Vec<(Option<CommandId>, CommandEnd)>,
    /// Number of commands that are no longer listed.
    pub(super) unlisted: u64,
    /// Command that could not be loaded, with the load errors.
    pub(super) failed: Option<(String, Vec<LoadFault>)>,
}

impl<'a> Books<'a> {
    pub(super) fn new(images: &'a [Arc<Image>]) -> Books<'a> {
        Books {
            images,
            commands: Vec::new(),
            unlisted: 0,
            failed: None,
        }
    }

    fn started(&mut self, id: CommandId, image: &Image, tick: u64) {
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

    /// Returns the list entry of a command.
    fn listed(&mut self, id: CommandId) -> Option<&mut CommandEnd> {
        let mut latest_first = self.commands.iter_mut().rev();
        let found = latest_first.find(|(known, _)| *known == Some(id));
        found.map(|(_, command)| command)
    }

    fn ended(&mut self, id: CommandId, image: &Image, ending: Ending) {
        if let Some(command) = self.listed(id) {
            command.cycles = ending.cycles;
            command.end = end::of(image, ending);
        }
    }

    /// Records that a command left a device moving and that the device braked.
    fn braked(&mut self, id: CommandId, device: &str) {
        if let Some(command) = self.listed(id)
            && !command.braked.iter().any(|known| known == device)
        {
            command.braked.push(device.to_owned());
        }
    }

    /// Records the overruns of a command.
    pub(super) fn overran(&mut self, id: CommandId, overruns: &Overruns) {
        let images = self.images;
        let (Some(command), Some(worst)) = (self.listed(id), overruns.worst) else {
            return;
        };
        let image = images.iter().find(|image| image.name == command.name);
        let fragment = image.and_then(|i| i.fragments.get(worst.fragment as usize));
        command.overruns = Some(Blame {
            count: overruns.count,
            tick: worst.tick,
            took_ns: worst.took_ns,
            late_ns: worst.late_ns,
            fragment: fragment.map_or_else(String::new, |f| f.path.clone()),
        });
    }

    /// Records that the task handles the error with which the command ended.
    fn handled(&mut self, id: CommandId) {
        if let Some(command) = self.listed(id) {
            command.handled = true;
        }
    }

    fn jumped(&mut self, id: CommandId, jump: &Jump, cell: &Cell) {
        if let Some(command) = self.listed(id) {
            command.jump.get_or_insert_with(|| end::jump(jump, cell));
        }
    }

    /// Records that a command could not be loaded.
    pub(super) fn not_loaded(&mut self, indices: &[usize], faults: Vec<LoadFault>) {
        let name = indices
            .first()
            .map(|index| self.images[*index].name.clone());
        self.failed = name.map(|name| (name, faults));
    }

    /// Records that a command could not be started.
    pub(super) fn not_started(&mut self, index: usize, why: String) {
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
        self.listen(sink);
        let mut bench = Bench {
            desk: &mut self.desk,
            books: &mut self.books,
        };
        for task in &mut self.tasks {
            task.advance(&mut bench);
        }
    }

    /// Processes events and forwards samples to `sink`, without advancing the tasks.
    pub(super) fn listen(&mut self, sink: &mut dyn Sink) {
        while let Some(event) = self.desk.control.poll() {
            self.note(&event);
        }
        let last_tick = &mut self.last_tick;
        self.drain.each(|channel, tick, value| {
            *last_tick = tick;
            sink.sample(channel, tick, value);
        });
    }

    /// Returns true while the recorder accepts data.
    pub(super) fn is_recorded(&self) -> bool {
        self.recorder
            .as_ref()
            .is_some_and(|recorder| recorder.writes())
    }

    /// Returns true once no task will start another command.
    pub(super) fn is_over(&self) -> bool {
        self.books.failed.is_some() || self.tasks.iter().all(|t| t.end().is_some())
    }

    /// Returns the command that was started last.
    pub(super) fn running(&self) -> Option<&CommandEnd> {
        self.books.commands.last().map(|c| &c.1)
    }

    fn note(&mut self, event: &Event) {
        if let Some(recorder) = &self.recorder {
            recorder.event(event);
        }
        if let Event::Notice(notice) = event {
            self.write_down(notice);
        }
        for task in &mut self.tasks {
            task.hear(event);
        }
    }

    fn write_down(&mut self, notice: &Notice) {
        let image = |id: CommandId| Some(Arc::clone(&self.desk.control.get(id)?.image));
        match *notice {
            Notice::Started { command, tick } => {
                if let Some(image) = image(command) {
                    self.books.started(command, &image, tick);
                }
            }
            Notice::Braked {
                command, resource, ..
            } => {
                if let Some((device, _)) = self.desk.cell.actuator(resource) {
                    self.books.braked(command, device);
                }
            }
            Notice::Jumped { command, jump } => self.books.jumped(command, &jump, self.desk.cell),
            Notice::Ended {
                command, ending, ..
            } => {
                if let Some(image) = image(command) {
                    self.books.ended(command, &image, ending);
                }
            }
            _ => {}
        }
    }
}
