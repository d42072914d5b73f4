//! Tasks of programs: loaded as a whole and executed outside the cycle thread, with lookahead.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use rpi_core::CommandOverrunPolicy;
use rpi_runtime::control::{CommandId, Event};
use rpi_runtime::run::{ExecutablePlan, Task, TaskEnd};

use super::commands::Commands;
use super::event_log::EventLog;
use super::parse_number;
use super::pending::answer;
use super::record::display_name;
use super::subscribers::Subscribers;
use super::task_status::{Step, TaskPhase, TaskStatus};
use super::types::{ApiError, Reply, Subscriber, Update};
use crate::task_bundle::TaskBundle;

/// State of a task in the server: its images and plan, its execution state, its progress and its subscribers.
pub(super) struct TaskRecord {
    pub(super) session: u64,
    title: String,
    /// Memory of the task in bytes: its source text and the images of its commands.
    bytes: usize,
    /// Source text of the program with the task.
    pub(super) text: Arc<str>,
    pub(super) script: Option<TaskBundle>,
    /// Policy for cycles of the task's commands that take too long.
    pub(super) on_overrun: CommandOverrunPolicy,
    task: Option<Task<ExecutablePlan>>,
    pub(super) status: TaskStatus,
    watchers: Subscribers,
    /// Callback for the result of loading; `None` once the result was reported.
    load_reply: Option<Reply>,
    /// Whether the task is to be unloaded once it has ended.
    unload_at_end: bool,
    /// Whether the status has changed since the latest report to the subscribers.
    pub(super) changed: bool,
    /// Resources (actuators) of all commands of the task so far.
    pub(super) resources: BTreeSet<u32>,
}

impl TaskRecord {
    /// Creates the record of a task that is being loaded, of the session with this number. `bytes` is the memory of its
    /// text. `reply` receives the result of loading.
    pub(super) fn new(
        session: u64,
        title: String,
        (text, bytes): (Arc<str>, usize),
        on_overrun: CommandOverrunPolicy,
        reply: Reply,
    ) -> TaskRecord {
        TaskRecord {
            session,
            text,
            title,
            bytes,
            script: None,
            on_overrun,
            task: None,
            status: TaskStatus::loading(),
            watchers: Subscribers::default(),
            load_reply: Some(reply),
            unload_at_end: false,
            changed: false,
            resources: BTreeSet::new(),
        }
    }

    fn has_ended(&self) -> bool {
        matches!(self.status.phase, TaskPhase::Ended(_))
    }

    fn display_name(&self, number: u64) -> String {
        display_name(&format!("t{number}"), &self.title)
    }

    fn report_progress(&mut self) {
        if std::mem::take(&mut self.changed) {
            self.watchers.notify(&Update::Task(&self.status));
        }
    }
}

/// Table of the loaded tasks by the number in their names (`t7` has number 7).
#[derive(Default)]
pub(crate) struct Tasks {
    records: BTreeMap<u64, TaskRecord>,
}

impl Tasks {
    /// Adds the record of a task that is being loaded.
    pub(super) fn insert(&mut self, number: u64, record: TaskRecord) {
        self.records.insert(number, record);
    }

    /// Returns the record of the task with this number; `None` if the task is unknown or was removed.
    pub(super) fn get(&self, number: u64) -> Option<&TaskRecord> {
        self.records.get(&number)
    }

    /// Returns the record of the task with this number, to change it; `None` if there is no such task.
    pub(super) fn get_mut(&mut self, number: u64) -> Option<&mut TaskRecord> {
        self.records.get_mut(&number)
    }

    /// Returns whether there is a task with this number.
    pub(super) fn contains(&self, number: u64) -> bool {
        self.records.contains_key(&number)
    }

    /// Returns the session number of the task with this number; `None` if there is no such task.
    pub(super) fn session_of(&self, number: u64) -> Option<u64> {
        self.records.get(&number).map(|r| r.session)
    }

    /// Returns for each task the number of its session and its memory in bytes.
    pub(super) fn sizes(&self) -> impl Iterator<Item = (u64, usize)> + Clone {
        self.records.values().map(|r| (r.session, r.bytes))
    }

    /// Returns the number of each ended task and that of its session, oldest task first.
    pub(super) fn ended(&self) -> impl Iterator<Item = (u64, u64)> {
        let ended = self.records.iter().filter(|(_, r)| r.has_ended());
        ended.map(|(number, r)| (*number, r.session))
    }

    /// Returns the numbers of the tasks of the session with this number.
    pub(super) fn of_session(&self, session: u64) -> Vec<u64> {
        let own = self.records.iter().filter(|(_, r)| r.session == session);
        own.map(|(number, _)| *number).collect()
    }

    /// Returns whether the session with this number owns a task.
    pub(super) fn any_of_session(&self, session: u64) -> bool {
        self.records.values().any(|r| r.session == session)
    }

    /// Makes the task with this number ready to start, after its loading is finished. `bytes` is the memory of its
    /// images.
    pub(super) fn loaded(&mut self, number: u64, script: TaskBundle, bytes: usize) {
        if let Some(record) = self.records.get_mut(&number) {
            record.script = Some(script);
            record.bytes += bytes;
            record.status.phase = TaskPhase::Ready;
            answer(record.load_reply.take(), Ok(format!("t{number}")));
        }
    }

    /// Removes the task with this number, which could not be loaded. Returns its display name, the number of its
    /// session and the callback for the result; `None` if there is no such task.
    pub(super) fn remove(&mut self, number: u64) -> Option<(String, u64, Option<Reply>)> {
        let record = self.records.remove(&number)?;
        Some((
            record.display_name(number),
            record.session,
            record.load_reply,
        ))
    }

    fn number(&self, name: &str) -> Result<u64, ApiError> {
        let found = parse_number(name, 't').filter(|n| self.records.contains_key(n));
        found.ok_or_else(|| ApiError::Unknown(format!("task {name}")))
    }

    fn find(&mut self, name: &str) -> Result<(u64, &mut TaskRecord), ApiError> {
        let number = self.number(name)?;
        let record = self.records.get_mut(&number);
        let record = record.ok_or_else(|| ApiError::Unknown(format!("task {name}")))?;
        Ok((number, record))
    }

    /// Starts the task with this name; its first commands start in one of the next ticks. A task can be started only
    /// once.
    pub(super) fn start(&mut self, name: &str) -> Result<(), ApiError> {
        let (_, record) = self.find(name)?;
        let ready = record.status.phase == TaskPhase::Ready;
        let script = record.script.as_ref().filter(|_| ready);
        let phase = record.status.phase.name();
        let script = script.ok_or_else(|| ApiError::Invalid(format!("{name} is {phase}")))?;
        record.task = Some(Task::new(script.plan.clone()));
        record.status.phase = TaskPhase::Running;
        record.changed = true;
        Ok(())
    }

    /// Marks the running task with this name as being cancelled, and returns its number. Returns an error if it does
    /// not run.
    pub(super) fn cancel(&mut self, name: &str) -> Result<u64, ApiError> {
        let (number, record) = self.find(name)?;
        match record.status.phase {
            TaskPhase::Running | TaskPhase::Cancelling => {
                record.status.phase = TaskPhase::Cancelling;
                record.changed = true;
                Ok(number)
            }
            phase => Err(ApiError::Invalid(format!("{name} is {}", phase.name()))),
        }
    }

    /// Returns the numbers of all tasks that have started and not ended.
    pub(super) fn under_way(&self) -> Vec<u64> {
        let under_way = self.records.iter().filter(|(_, r)| r.task.is_some());
        under_way.map(|(number, _)| *number).collect()
    }

    /// Removes the execution state of a running task from its record and returns it, so that the task can be advanced
    /// while the table is changed. [`Tasks::put_back`] must follow.
    pub(super) fn take(&mut self, number: u64) -> Option<Task<ExecutablePlan>> {
        self.records.get_mut(&number)?.task.take()
    }

    /// Puts the execution state of a running task back into its record, after [`Tasks::take`].
    pub(super) fn put_back(&mut self, number: u64, task: Task<ExecutablePlan>) {
        if let Some(record) = self.records.get_mut(&number) {
            record.task = Some(task);
        }
    }

    /// Marks the task with this name to be unloaded once it has ended. Returns its number.
    pub(super) fn unload_at_end(&mut self, name: &str) -> Result<u64, ApiError> {
        let (number, record) = self.find(name)?;
        record.unload_at_end = true;
        Ok(number)
    }

    /// Marks the task with this number to be unloaded once it has ended.
    pub(super) fn abandon(&mut self, number: u64) {
        if let Some(record) = self.records.get_mut(&number) {
            record.unload_at_end = true;
        }
    }

    /// Returns the progress of the task with this name, or an error if there is none.
    pub(crate) fn status(&self, name: &str) -> Result<&TaskStatus, ApiError> {
        let number = self.number(name)?;
        let record = self.records.get(&number);
        let record = record.ok_or_else(|| ApiError::Unknown(format!("task {name}")))?;
        Ok(&record.status)
    }

    /// Returns all tasks: name, title and progress of each.
    pub(crate) fn all(&self) -> impl Iterator<Item = (String, &str, &TaskStatus)> {
        let tasks = self.records.iter();
        tasks.map(|(number, r)| (format!("t{number}"), r.title.as_str(), &r.status))
    }

    /// Subscribes to the task with this name: reports its progress now and at each change.
    pub(crate) fn watch(&mut self, name: &str, sink: Box<dyn Subscriber>) -> Result<(), ApiError> {
        let (_, record) = self.find(name)?;
        record.watchers.add(sink, &Update::Task(&record.status));
        Ok(())
    }

    /// Returns the list of subscribers of each task.
    pub(super) fn watchers(&mut self) -> impl Iterator<Item = &mut Subscribers> {
        self.records.values_mut().map(|r| &mut r.watchers)
    }

    /// Passes an event of the core to all running tasks.
    pub(super) fn handle_event(&mut self, event: &Event) {
        let tasks = self.records.values_mut().filter_map(|r| r.task.as_mut());
        tasks.for_each(|task| task.handle_event(event));
    }

    /// Updates the progress of the task with this number after it was advanced, and reports changes to its subscribers. Returns
    /// the resources (actuators) that must take their safe values, because the task has ended before its end in the program.
    pub(super) fn update_progress(
        &mut self,
        number: u64,
        commands: &Commands,
        log: &mut EventLog,
    ) -> BTreeSet<u32> {
        let mut released = BTreeSet::new();
        let Some(record) = self.records.get_mut(&number) else {
            return released;
        };
        let task = record.task.as_ref();
        let running = task.map(Task::running).unwrap_or_default();
        let named = running.iter().filter_map(|id| {
            let (number, record) = commands.find_by_id(*id)?;
            record
                .runs()
                .then(|| (format!("n{number}"), record.title.clone()))
        });
        let (named, end): (Vec<_>, _) = (named.collect(), task.and_then(Task::end));
        record.changed |= record.status.running != named;
        record.status.running = named;
        if let Some(end) = end {
            record.task = None;
            record.status.phase = TaskPhase::Ended(end);
            record.changed = true;
            let resources = std::mem::take(&mut record.resources);
            if end != TaskEnd::Done {
                released = resources;
            }
            let word = record.status.phase.name();
            log.write(format_args!(
                "{} has ended: {word}",
                record.display_name(number)
            ));
        }
        record.report_progress();
        released
    }

    /// Adds the ended command with this id to the progress of the task that it is part of, if any.
    pub(super) fn add_step(&mut self, id: CommandId, commands: &Commands) {
        let Some((_, record)) = commands.find_by_id(id) else {
            return;
        };
        let task = record.task.and_then(|task| self.records.get_mut(&task));
        if let Some((task, step)) = task.zip(Step::of(id, record)) {
            task.changed = true;
            task.status.push(step);
        }
    }

    /// Returns the session of the task with this number if the task is marked to be unloaded and can be unloaded now,
    /// else `None`.
    pub(super) fn abandoned(&self, number: u64) -> Option<u64> {
        let record = self.records.get(&number).filter(|r| r.unload_at_end)?;
        let can = record.has_ended() || record.status.phase == TaskPhase::Ready;
        can.then_some(record.session)
    }

    /// Removes the task with this number and reports to its subscribers that it is unloaded.
    pub(super) fn forget(&mut self, number: u64) {
        if let Some(mut record) = self.records.remove(&number) {
            record.report_progress();
            record.status.phase = TaskPhase::Unloaded;
            record.watchers.notify(&Update::Task(&record.status));
        }
    }
}
