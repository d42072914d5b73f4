//! Commands: load, start, cancel, abort, set, unload.

use std::collections::BTreeMap;
use std::sync::Arc;

use rpi_core::OnOverrun;
use rpi_image::Image;
use rpi_image::image::{End, EndKind, InputPort};
use rpi_net::Given;
use rpi_runtime::control::{
    Adopted, Board, Cause, CommandId, Control, Ending, Rejected, Setting, State, Ticket, Why,
};

use super::completion::Reasons;
use super::eval::Eval;
use super::loader::{Job, Language, Loaded, Made, Origin, What};
use super::types::shortened;
use super::watch::Subscription;
use super::{Desk, Failure, Phase, Reply, Status, Then, answer, number_of};

/// State of a command in the server.
pub(crate) struct Record {
    /// Id in the core, once the command is on its way there.
    pub(crate) id: Option<CommandId>,
    pub(crate) session: u64,
    /// Title chosen by the owner, for display.
    pub(crate) title: String,
    /// Number of the task that the command is part of.
    pub(super) task: Option<u64>,
    /// Source of the command; `None` for a command of a task.
    pub(crate) origin: Option<Origin>,
    /// Source text, also for a command of a task.
    pub(super) text: Option<Arc<str>>,
    /// Inputs that are taken over when the command starts. An input that was set is no longer needed.
    pub(super) given: Vec<Given>,
    pub(crate) status: Status,
    pub(crate) image: Option<Arc<Image>>,
    pub(super) board: Option<Arc<Board>>,
    pub(super) subscriptions: Vec<Subscription>,
    /// For each exported Boolean, the conditions under which it can be true.
    pub(super) reasons: Reasons,
    /// Keys of the results that end the command: its session has made rules that stop it when one of them is true.
    pub(super) ends_by: Vec<String>,
    /// Key of the result that is reported as true because another command has taken over.
    pub(super) completed: Option<String>,
    /// Until when values are withheld from subscribers that depend on the order of updates.
    pub(super) held: Option<std::time::Instant>,
    /// Callback for the result of loading.
    pub(super) loading: Option<Reply>,
    /// Present if the command runs for a single cycle.
    pub(super) eval: Option<Eval>,
    /// Whether the command is to be unloaded once it has ended.
    pub(super) unload_at_end: bool,
    /// Memory of the command in bytes.
    pub(super) bytes: usize,
}

/// A request to load a command or task.
pub(crate) struct Load<'a> {
    pub(crate) session: &'a str,
    pub(crate) title: &'a str,
    pub(crate) language: Language,
    pub(crate) text: &'a str,
    /// Name of the command or task within the text; `None` if there is only one.
    pub(crate) command: Option<&'a str>,
    /// Period in nanoseconds; 0 for one tick.
    pub(crate) period_ns: u64,
    /// Policy for cycles that take too long; `None` for the server's default.
    pub(crate) on_overrun: Option<OnOverrun>,
}

impl Desk {
    /// Loads a command on the loader thread. The reply has its name.
    pub(crate) fn load(&mut self, load: &Load<'_>, reply: Reply) {
        match self.session(load.session) {
            Ok(session) => self.load_for(session, load, None, reply),
            Err(why) => reply(Err(why)),
        }
    }

    pub(super) fn load_for(
        &mut self,
        session: u64,
        load: &Load<'_>,
        eval: Option<Eval>,
        reply: Reply,
    ) {
        if let Err(why) = self.has_room(session, load.bytes()) {
            return reply(Err(why));
        }
        let (number, title) = (self.number(), shortened(load.title, self.limits.name));
        let job = Job {
            number,
            session,
            client: self.client_of(session),
            what: What::Command,
            origin: Origin {
                language: load.language,
                text: load.text.into(),
                command: load.command.map(str::to_owned),
            },
            period_ns: self.period(load.period_ns),
            tick_ns: self.tick_ns,
            on_overrun: load.on_overrun.unwrap_or(self.on_overrun),
        };
        let record = Record {
            origin: Some(job.origin.clone()),
            text: Some(Arc::clone(&job.origin.text)),
            loading: Some(reply),
            eval,
            bytes: load.bytes(),
            ..Record::new(session, &title, Phase::Is(State::Loading))
        };
        self.commands.insert(number, record);
        self.send(job);
    }

    /// Rounds a period up to whole ticks, at least one.
    pub(crate) fn period(&self, wanted_ns: u64) -> u64 {
        let ticks = wanted_ns.div_ceil(self.tick_ns).max(1);
        ticks.saturating_mul(self.tick_ns)
    }

    pub(super) fn send(&mut self, job: Job) {
        let number = job.number;
        if !self.jobs.push(job) {
            self.reject(number, Failure::Limit("queued loads of one client"));
        }
    }

    /// Called when loading is finished: inserts the command into the core, or reports why it failed.
    pub(super) fn loaded(&mut self, job: Job, loaded: Result<Made, Vec<String>>) {
        let generation = self.generation();
        let loaded = match loaded {
            Ok(Made::Task(script)) => return self.task_loaded(job.number, Ok(script)),
            Ok(Made::Command(loaded)) => Ok(loaded),
            Err(reasons) if job.what == What::Task => {
                return self.task_loaded(job.number, Err(reasons));
            }
            Err(reasons) => Err(reasons),
        };
        match loaded {
            Err(reasons) => self.reject(job.number, Failure::Rejected(reasons)),
            // Devices were added or removed meanwhile, so the device names must be resolved again.
            Ok(loaded) if loaded.generation != generation => self.send(job),
            Ok(loaded) => self.insert(job.number, loaded),
        }
    }

    fn insert(&mut self, number: u64, loaded: Loaded) {
        // The command may have been removed with its session while it was being compiled.
        if !self.commands.contains_key(&number) {
            return;
        }
        let bytes = loaded.command.machine().footprint();
        let room = self.may_ask().and_then(|()| self.has_memory(number, bytes));
        if let Err(why) = room {
            return self.reject(number, why);
        }
        if let Some(record) = self.commands.get_mut(&number) {
            if record.title.is_empty() {
                record.title.clone_from(&loaded.image.name);
            }
            record.reasons = loaded.reasons;
            record.given = loaded.given;
        }
        match self.control.adopt_with_board(loaded.command) {
            Ok(adopted) => self.adopted(number, adopted, loaded.image, bytes),
            Err(why) => self.reject(number, why.into()),
        }
    }

    pub(super) fn adopted(
        &mut self,
        number: u64,
        adopted: Adopted,
        image: Arc<Image>,
        bytes: usize,
    ) {
        let Adopted { id, ticket, board } = adopted;
        self.by_id.insert(id, number);
        let mut reply = None;
        if let Some(record) = self.commands.get_mut(&number) {
            record.id = Some(id);
            record.bytes += bytes;
            record.image = Some(image);
            record.board = Some(board);
            reply = record.loading.take();
        }
        self.asked(Ok(ticket), Then::Inserted(number), reply);
    }

    /// Removes a command whose loading failed and reports the error.
    pub(super) fn reject(&mut self, number: u64, why: Failure) {
        if self.tasks.contains_key(&number) {
            return self.reject_task(number, why);
        }
        if let Some(record) = self.commands.remove(&number) {
            let called = record.called(number);
            self.journal
                .note(format_args!("{called} cannot be loaded: {why}"));
            let reply = record.eval.map(|e| e.reply).or(record.loading);
            answer(reply, Err(why));
            self.close_if_empty(record.session);
        }
    }

    /// Returns a command and its number by name.
    pub(crate) fn find(&self, name: &str) -> Result<(u64, &Record), Failure> {
        let number = number_of(name, 'n');
        let found = number.and_then(|n| Some((n, self.commands.get(&n)?)));
        found.ok_or_else(|| Failure::Unknown(format!("command {name}")))
    }

    /// Returns the upper bound on the command's time per tick in nanoseconds, once it is loaded.
    pub(crate) fn bound_ns(&self, record: &Record) -> Option<u64> {
        Some(self.control.bound_ns(record.id?))
    }

    /// Returns all commands with their names, except those for a single cycle.
    pub(crate) fn commands(&self) -> impl Iterator<Item = (String, &Record)> {
        let commands = self.commands.iter().filter(|(_, r)| r.eval.is_none());
        commands.map(|(number, record)| (format!("n{number}"), record))
    }

    /// Returns the id of a command in the core.
    pub(super) fn core_id(&self, name: &str) -> Result<CommandId, Failure> {
        let (_, record) = self.find(name)?;
        let loading = || Failure::Bad(format!("{name} is still being loaded"));
        record.id.ok_or_else(loading)
    }

    /// Sends a request about a command to the cycle.
    fn ask(
        &mut self,
        name: &str,
        what: impl FnOnce(&mut Control, CommandId) -> Result<Ticket, Rejected>,
        reply: Reply,
    ) {
        match self.may_ask().and_then(|()| self.core_id(name)) {
            Ok(id) => {
                let ticket = what(&mut self.control, id);
                self.asked(ticket, Then::Nothing, Some(reply));
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Starts a command.
    pub(crate) fn start(&mut self, name: &str, reply: Reply) {
        match self.may_start().and_then(|()| self.has_all(name)) {
            Ok(()) => self.ask(name, Control::start, reply),
            Err(why) => reply(Err(why)),
        }
    }

    /// Returns an error if a required input has no value: a command that is started by request has no predecessor to
    /// take it from.
    fn has_all(&self, name: &str) -> Result<(), Failure> {
        let (_, record) = self.find(name)?;
        let needed = record.given.iter().filter(|given| given.is_needed);
        let needed: Vec<&str> = needed.map(|given| given.key.as_str()).collect();
        let waits = record.status.phase == Phase::Is(State::Ready);
        match needed.is_empty() || !waits {
            true => Ok(()),
            false => Err(Failure::Bad(format!(
                "{name} takes over {} but has no predecessor; set it (`command.set`) or schedule {name} after a command",
                needed.join(", ")
            ))),
        }
    }

    /// Cancels a command.
    pub(crate) fn cancel(&mut self, name: &str, reply: Reply) {
        self.ask(name, Control::cancel, reply);
    }

    /// Aborts a command.
    pub(crate) fn abort(&mut self, name: &str, reply: Reply) {
        self.ask(name, |c, id| c.abort(id, Why::Request), reply);
    }

    /// Unloads a command. A running one is unloaded as soon as it has ended.
    pub(crate) fn unload(&mut self, name: &str, reply: Reply) {
        let found = self.find(name).map(|(n, record)| (n, record.status.phase));
        match found {
            Ok((number, Phase::Is(State::Running | State::Cancelling))) => {
                self.unload_at_end(number);
                reply(Ok(String::new()));
            }
            Ok(_) => self.ask(name, Control::unload, reply),
            Err(why) => reply(Err(why)),
        }
    }

    /// Sets inputs of commands, either all of them between the same two cycles or none.
    pub(crate) fn set(&mut self, values: &[(&str, &str, &str)], reply: Reply) {
        let may = self.may_ask().and_then(|()| self.may_set(values.len()));
        match may.and_then(|()| self.settings(values)) {
            Ok(settings) => {
                let ticket = self.control.set(settings);
                if self.asked(ticket, Then::Nothing, Some(reply)) {
                    values.iter().for_each(|value| self.note_given(value));
                }
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Returns an error if `count` values are too many for one request.
    pub(crate) fn may_set(&self, count: usize) -> Result<(), Failure> {
        match count > self.limits.values {
            true => Err(Failure::Limit("values in one request")),
            false => Ok(()),
        }
    }

    /// Converts values to settings with one setting per input. The last value of an input wins.
    fn settings(&self, values: &[(&str, &str, &str)]) -> Result<Vec<Setting>, Failure> {
        let mut settings: BTreeMap<(CommandId, usize), Setting> = BTreeMap::new();
        let mut cells = 0;
        for value in values {
            let setting = self.setting(value)?;
            cells += setting.value.len();
            let old = settings.insert((setting.command, setting.input), setting);
            cells -= old.map_or(0, |old| old.value.len());
            self.may_set(cells)?;
        }
        Ok(settings.into_values().collect())
    }

    /// Marks an input as no longer needed.
    fn note_given(&mut self, (name, key, _): &(&str, &str, &str)) {
        let number = self.find(name).map(|(number, _)| number);
        let record = number.ok().and_then(|n| self.commands.get_mut(&n));
        let given = record.into_iter().flat_map(|r| &mut r.given);
        given
            .filter(|given| given.key == *key)
            .for_each(|given| given.is_needed = false);
    }

    fn setting(&self, (name, key, value): &(&str, &str, &str)) -> Result<Setting, Failure> {
        let (_, record) = self.find(name)?;
        let waits = [State::Ready, State::Scheduled].map(Phase::Is);
        let is_taken = record.given.iter().any(|given| given.key == *key);
        if is_taken && !waits.contains(&record.status.phase) {
            return Err(Failure::Bad(format!(
                "{key} of {name} is taken over at its start; it cannot be set any more"
            )));
        }
        let inputs = record.image.as_ref().map_or(&[][..], |i| &i.inputs);
        let found = inputs.iter().position(|i| i.key == *key);
        let input = found.ok_or_else(|| Failure::Unknown(format!("input {key} of {name}")))?;
        Ok(Setting {
            command: self.core_id(name)?,
            input,
            value: cells(&inputs[input], value)?,
        })
    }
}

/// Returns a name with its title for display.
pub(super) fn called(name: &str, title: &str) -> String {
    match title {
        "" => name.to_owned(),
        title => format!("{name} ({title})"),
    }
}

impl Load<'_> {
    /// Returns the number of bytes of the text that are kept.
    pub(super) fn bytes(&self) -> usize {
        self.text.len() + self.command.map_or(0, str::len)
    }
}

impl Record {
    /// Returns the name and title of the command for the log.
    pub(super) fn called(&self, number: u64) -> String {
        called(&format!("n{number}"), &self.title)
    }

    /// Creates the state of a command that is not loaded yet.
    pub(super) fn new(session: u64, title: &str, phase: Phase) -> Record {
        Record {
            id: None,
            session,
            title: title.to_owned(),
            task: None,
            origin: None,
            text: None,
            given: Vec::new(),
            status: Status::new(phase),
            image: None,
            board: None,
            subscriptions: Vec::new(),
            reasons: Reasons::default(),
            ends_by: Vec::new(),
            completed: None,
            held: None,
            loading: None,
            eval: None,
            unload_at_end: false,
            bytes: 0,
        }
    }
}

fn cells(input: &InputPort, text: &str) -> Result<Box<[u64]>, Failure> {
    let ty = input.value.ty;
    let bad = |why: String| Failure::Bad(format!("`{text}` is not of type {ty}: {why}"));
    let value = rpi_literal::read(text, ty).map_err(|e| bad(e.to_string()))?;
    let value = value.ok_or_else(|| bad("an input must have a value".to_owned()))?;
    Ok(value.cells().into())
}

/// Returns the names of the results by which a command can end.
pub(crate) fn results(image: &Image) -> Vec<&str> {
    match &image.end {
        End::Results(results) => results.iter().map(|r| r.name.as_str()).collect(),
        End::Ports { .. } => Vec::new(),
    }
}

/// Returns whether a command has ended in motion by `yield` and its successor has continued the motion.
pub(super) fn yields(image: &Image, ending: &Ending) -> bool {
    let (Cause::Result(k), End::Results(results)) = (ending.cause, &image.end) else {
        return false;
    };
    let kind = results.get(k).map(|r| r.kind);
    kind == Some(EndKind::Yield) && !ending.left_moving
}
