//! Tasks of programs: loaded as a whole and executed outside the cycle thread, with lookahead.

use std::sync::Arc;

use rpi_core::OnOverrun;
use rpi_runtime::control::{CommandId, Event, State};
use rpi_runtime::run::{Plan, Task, TaskEnd};

use super::commands::called;
use super::loader::{Job, Origin, What};
use super::place::Place;
use super::shop::Shop;
use super::types::shortened;
use super::{Desk, Failure, Load, Phase, Reply, Sink, Update, answer, cause, number_of, why};
use crate::limits::OnLoss;
use crate::script::Script;

/// Life-cycle state of a task.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum TaskPhase {
    /// Its commands are being compiled.
    Loading,
    /// The task can be started.
    Ready,
    /// The task is running.
    Running,
    /// The task was cancelled and has not ended yet.
    Cancelling,
    /// The task has ended.
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

/// An ended command of a task.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Step {
    pub(super) id: CommandId,
    pub(crate) title: String,
    pub(crate) result: Option<String>,
    pub(crate) cause: &'static str,
    /// Fault or reason of the abort, if the command did not end regularly.
    pub(crate) why: Option<&'static str>,
    /// Location of the fault in the program, if a fault ended the command.
    pub(crate) place: Option<Place>,
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
    /// Number of those that could have taken over in motion.
    pub(crate) missed: u64,
    /// Commands that could not be started, and the reason.
    pub(crate) trouble: Option<String>,
}

/// State of a task in the server.
pub(super) struct TaskRecord {
    pub(super) session: u64,
    title: String,
    /// Memory of the task in bytes.
    pub(super) bytes: usize,
    /// Source text.
    pub(super) text: Arc<str>,
    pub(super) script: Option<Script>,
    /// Policy for its commands if their cycles take too long.
    pub(super) on_overrun: OnOverrun,
    task: Option<Task<Plan>>,
    pub(super) status: TaskStatus,
    pub(super) watchers: Vec<Box<dyn Sink>>,
    /// Callback for the result of loading.
    loading: Option<Reply>,
    /// Whether the task is to be unloaded once it has ended.
    unload_at_end: bool,
    /// Whether the status has changed since the latest report.
    pub(super) changed: bool,
}

/// Maximum number of ended commands kept for a task.
const REMEMBERED: usize = 100;

impl TaskRecord {
    pub(super) fn has_ended(&self) -> bool {
        matches!(self.status.phase, TaskPhase::Ended(_))
    }
}

impl Desk {
    /// Loads a task on the loader thread. The reply has its name.
    pub(crate) fn load_task(&mut self, load: &Load<'_>, reply: Reply) {
        let room = self.session(load.session);
        let room = room.and_then(|s| self.has_room(s, load.bytes()).map(|()| s));
        let session = match room {
            Ok(session) => session,
            Err(why) => return reply(Err(why)),
        };
        let number = self.number();
        let on_overrun = load.on_overrun.unwrap_or(self.on_overrun);
        let text: Arc<str> = load.text.into();
        let record = TaskRecord {
            session,
            text: Arc::clone(&text),
            title: shortened(load.title, self.limits.name),
            bytes: load.bytes(),
            script: None,
            on_overrun,
            task: None,
            status: TaskStatus {
                phase: TaskPhase::Loading,
                running: Vec::new(),
                steps: Vec::new(),
                late: 0,
                missed: 0,
                trouble: None,
            },
            watchers: Vec::new(),
            loading: Some(reply),
            unload_at_end: false,
            changed: false,
        };
        self.tasks.insert(number, record);
        let job = Job {
            what: What::Task,
            number,
            session,
            client: self.client_of(session),
            origin: Origin {
                language: load.language,
                text,
                command: load.command.map(str::to_owned),
            },
            period_ns: self.period(load.period_ns),
            tick_ns: self.tick_ns,
            on_overrun,
        };
        self.send(job);
    }

    /// Called when loading is finished: makes the task ready, or reports why it failed.
    pub(super) fn task_loaded(&mut self, number: u64, loaded: Result<Script, Vec<String>>) {
        let script = match loaded {
            Ok(script) => script,
            Err(reasons) => return self.reject_task(number, Failure::Rejected(reasons)),
        };
        let bytes = script.images.iter().map(|image| image.footprint()).sum();
        if let Err(why) = self.has_memory(number, bytes) {
            return self.reject_task(number, why);
        }
        if let Some(record) = self.tasks.get_mut(&number) {
            record.script = Some(script);
            record.bytes += bytes;
            record.status.phase = TaskPhase::Ready;
            answer(record.loading.take(), Ok(format!("t{number}")));
        }
        self.forget_task_if_abandoned(number);
    }

    /// Removes a task whose loading failed and reports the error.
    pub(super) fn reject_task(&mut self, number: u64, why: Failure) {
        if let Some(mut record) = self.tasks.remove(&number) {
            let task = called(&format!("t{number}"), &record.title);
            self.journal
                .note(format_args!("{task} cannot be loaded: {why}"));
            answer(record.loading.take(), Err(why));
            self.close_if_empty(record.session);
        }
    }

    fn task_number(&self, name: &str) -> Result<u64, Failure> {
        let found = number_of(name, 't').filter(|n| self.tasks.contains_key(n));
        found.ok_or_else(|| Failure::Unknown(format!("task {name}")))
    }

    fn task(&mut self, name: &str) -> Result<(u64, &mut TaskRecord), Failure> {
        let number = self.task_number(name)?;
        let record = self.tasks.get_mut(&number);
        let record = record.ok_or_else(|| Failure::Unknown(format!("task {name}")))?;
        Ok((number, record))
    }

    /// Starts a task; its first commands start in one of the next ticks. A task can be started only once.
    pub(crate) fn start_task(&mut self, name: &str) -> Result<(), Failure> {
        self.may_start()?;
        let (_, record) = self.task(name)?;
        let ready = record.status.phase == TaskPhase::Ready;
        let script = record.script.as_ref().filter(|_| ready);
        let phase = record.status.phase.name();
        let script = script.ok_or_else(|| Failure::Bad(format!("{name} is {phase}")))?;
        record.task = Some(Task::new(script.plan.clone()));
        record.status.phase = TaskPhase::Running;
        record.changed = true;
        Ok(())
    }

    /// Cancels a task: no further command starts, and running ones are cancelled.
    pub(crate) fn cancel_task(&mut self, name: &str) -> Result<(), Failure> {
        let (number, record) = self.task(name)?;
        match record.status.phase {
            TaskPhase::Running | TaskPhase::Cancelling => {
                record.status.phase = TaskPhase::Cancelling;
                record.changed = true;
                self.with_task(number, |task, shop| task.cancel(shop));
                Ok(())
            }
            phase => Err(Failure::Bad(format!("{name} is {}", phase.name()))),
        }
    }

    /// Stops all tasks because of an emergency stop.
    pub(super) fn stop_tasks(&mut self) {
        for number in self.tasks_under_way() {
            self.with_task(number, |task, shop| task.stop(shop));
        }
    }

    fn tasks_under_way(&self) -> Vec<u64> {
        let under_way = self.tasks.iter().filter(|(_, r)| r.task.is_some());
        under_way.map(|(number, _)| *number).collect()
    }

    /// Unloads a task. A running one is unloaded when it has ended.
    pub(crate) fn unload_task(&mut self, name: &str) -> Result<(), Failure> {
        let (number, record) = self.task(name)?;
        record.unload_at_end = true;
        self.forget_task_if_abandoned(number);
        Ok(())
    }

    /// Returns the progress of a task.
    pub(crate) fn task_status(&self, name: &str) -> Result<&TaskStatus, Failure> {
        let number = self.task_number(name)?;
        let record = self.tasks.get(&number);
        let record = record.ok_or_else(|| Failure::Unknown(format!("task {name}")))?;
        Ok(&record.status)
    }

    /// Returns all tasks with name, title and progress.
    pub(crate) fn tasks(&self) -> impl Iterator<Item = (String, &str, &TaskStatus)> {
        let tasks = self.tasks.iter();
        tasks.map(|(number, r)| (format!("t{number}"), r.title.as_str(), &r.status))
    }

    /// Subscribes to a task: reports its progress now and at each change.
    pub(crate) fn watch_task(
        &mut self,
        name: &str,
        mut sink: Box<dyn Sink>,
    ) -> Result<(), Failure> {
        let (_, record) = self.task(name)?;
        if sink.tell(&Update::Task(&record.status)) {
            record.watchers.push(sink);
        }
        Ok(())
    }

    /// Passes an event of the cycle to all tasks.
    pub(super) fn tasks_hear(&mut self, event: &Event) {
        let tasks = self.tasks.values_mut().filter_map(|r| r.task.as_mut());
        tasks.for_each(|task| task.hear(event));
    }

    /// Advances all running tasks and reports their progress.
    pub(super) fn advance_tasks(&mut self) {
        for number in self.tasks_under_way() {
            self.with_task(number, |task, shop| task.advance(shop));
            self.note_progress(number);
        }
    }

    /// Calls `then` with a running task and its view of the core.
    fn with_task(&mut self, number: u64, then: impl FnOnce(&mut Task<Plan>, &mut Shop<'_>)) {
        let record = self.tasks.get_mut(&number);
        let Some(mut task) = record.and_then(|r| r.task.take()) else {
            return;
        };
        let desk = &mut *self;
        then(&mut task, &mut Shop { desk, number });
        if let Some(record) = self.tasks.get_mut(&number) {
            record.task = Some(task);
        }
    }

    fn note_progress(&mut self, number: u64) {
        let Some(record) = self.tasks.get(&number) else {
            return;
        };
        let task = record.task.as_ref();
        let running = task.map(Task::running).unwrap_or_default();
        let named = running.iter().filter_map(|id| {
            let number = self.by_id.get(id)?;
            let record = self.commands.get(number)?;
            let runs = [State::Running, State::Cancelling].map(Phase::Is);
            runs.contains(&record.status.phase)
                .then(|| (format!("n{number}"), record.title.clone()))
        });
        let (named, end): (Vec<_>, _) = (named.collect(), task.and_then(Task::end));
        let Some(record) = self.tasks.get_mut(&number) else {
            return;
        };
        record.changed |= record.status.running != named;
        record.status.running = named;
        if let Some(end) = end {
            record.task = None;
            record.status.phase = TaskPhase::Ended(end);
            record.changed = true;
            let word = record.status.phase.name();
            let task = called(&format!("t{number}"), &record.title);
            let line = format!("{task} has ended: {word}");
            self.journal.note(format_args!("{line}"));
        }
        self.tell_progress(number);
        self.forget_task_if_abandoned(number);
    }

    fn tell_progress(&mut self, number: u64) {
        if let Some(record) = self.tasks.get_mut(&number)
            && std::mem::take(&mut record.changed)
        {
            let TaskRecord {
                watchers, status, ..
            } = record;
            watchers.retain_mut(|sink| sink.tell(&Update::Task(status)));
        }
    }

    /// Adds an ended command to the progress of its task.
    pub(super) fn note_step(&mut self, id: CommandId) {
        let number = self.by_id.get(&id).and_then(|n| self.commands.get(n));
        let Some((task, record)) = number.and_then(|r| Some((r.task?, r))) else {
            return;
        };
        let Some(ending) = record.status.ending else {
            return;
        };
        let step = Step {
            id,
            title: record.title.clone(),
            result: record.status.result.clone(),
            cause: cause(&ending),
            why: why(&ending),
            place: record.status.place.clone(),
            braked: record.status.braked.clone(),
            jump: record.status.jump.clone(),
            error: ending.error,
            cycles: ending.cycles,
            handled: false,
        };
        if let Some(task) = self.tasks.get_mut(&task) {
            task.changed = true;
            task.status.steps.push(step);
            if task.status.steps.len() > REMEMBERED {
                task.status.steps.remove(0);
            }
        }
    }

    /// Called when the client of a session has disconnected: cancels its tasks, unless the policy lets them run.
    pub(super) fn let_go_of_tasks(&mut self, session: u64, on_loss: OnLoss) {
        let own = self.tasks.iter().filter(|(_, r)| r.session == session);
        let own: Vec<u64> = own.map(|(number, _)| *number).collect();
        for number in own {
            if on_loss != OnLoss::RunOn {
                self.with_task(number, |task, shop| task.cancel(shop));
            }
            if let Some(record) = self.tasks.get_mut(&number) {
                record.unload_at_end = true;
            }
            self.forget_task_if_abandoned(number);
        }
    }

    fn forget_task_if_abandoned(&mut self, number: u64) {
        let record = self.tasks.get(&number);
        let Some(record) = record.filter(|r| r.unload_at_end) else {
            return;
        };
        if record.has_ended() || record.status.phase == TaskPhase::Ready {
            let session = record.session;
            self.forget_task(number);
            self.close_if_empty(session);
        }
    }

    /// Removes a task and reports to its subscribers that it is unloaded.
    pub(super) fn forget_task(&mut self, number: u64) {
        self.tell_progress(number);
        if let Some(mut record) = self.tasks.remove(&number) {
            record.status.phase = TaskPhase::Unloaded;
            for mut sink in record.watchers {
                sink.tell(&Update::Task(&record.status));
            }
        }
    }
}
