//! Commands: loaded, started, asked to end, set, unloaded.

use std::collections::BTreeMap;
use std::sync::Arc;

use rpi_core::OnOverrun;
use rpi_host::control::{
    Adopted, Board, Cause, CommandId, Control, Ending, Rejected, Setting, State, Ticket, Why,
};
use rpi_image::Image;
use rpi_image::image::{End, EndKind, InputPort};
use rpi_net::{Given, literal};

use super::completion::Reasons;
use super::eval::Eval;
use super::loader::{Job, Language, Loaded, Made, Origin, What};
use super::types::shortened;
use super::watch::Subscription;
use super::{Desk, Failure, Phase, Reply, Status, Then, answer, number_of};

/// What the desk knows about a command.
pub(crate) struct Record {
    /// Its name in the core, once it is on its way there.
    pub(crate) id: Option<CommandId>,
    pub(crate) session: u64,
    /// What its owner calls it.
    pub(crate) title: String,
    /// The task that it is part of.
    pub(super) task: Option<u64>,
    /// What it was loaded from; nothing for a command of a task.
    pub(crate) origin: Option<Origin>,
    /// The text that it was made of.
    pub(super) text: Option<Arc<str>>,
    /// Inputs that are taken over when it starts; those that were set are not needed any more.
    pub(super) given: Vec<Given>,
    pub(crate) status: Status,
    pub(crate) image: Option<Arc<Image>>,
    pub(super) board: Option<Arc<Board>>,
    pub(super) subscriptions: Vec<Subscription>,
    /// For which reasons its exported Booleans can be true.
    pub(super) reasons: Reasons,
    /// The results by which it ends: its session has made rules that stop it when one of them is up.
    pub(super) ends_by: Vec<String>,
    /// The one of them that is told to be up since another has taken over.
    pub(super) completed: Option<String>,
    /// Until when its values are held back from those who need the order of things.
    pub(super) held: Option<std::time::Instant>,
    /// Whoever waits for it to be loaded.
    pub(super) loading: Option<Reply>,
    /// It only lives for one cycle.
    pub(super) eval: Option<Eval>,
    /// Nobody will look at it once it has ended.
    pub(super) unload_at_end: bool,
    /// Bytes that it takes.
    pub(super) bytes: usize,
}

/// What is to be loaded.
pub(crate) struct Load<'a> {
    pub(crate) session: &'a str,
    pub(crate) title: &'a str,
    pub(crate) language: Language,
    pub(crate) text: &'a str,
    /// Which command of the text, if there are several.
    pub(crate) command: Option<&'a str>,
    /// Nanoseconds; 0 for that of the tick.
    pub(crate) period_ns: u64,
    /// What becomes of it if its cycles take too long, where that is not as usual.
    pub(crate) on_overrun: Option<OnOverrun>,
}

impl Desk {
    /// Loads a command beside the cycle; the reply has its name.
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

    /// The period in which a command runs: whole ticks, at least one.
    pub(crate) fn period(&self, wanted_ns: u64) -> u64 {
        let ticks = wanted_ns.div_ceil(self.tick_ns).max(1);
        ticks.saturating_mul(self.tick_ns)
    }

    pub(super) fn send(&mut self, job: Job) {
        let number = job.number;
        if !self.jobs.push(job) {
            self.reject(number, Failure::Limit("loads that wait, of one client"));
        }
    }

    /// Loading is done: the command goes to the cycle, or its owner hears why not.
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
            // Devices have come or gone meanwhile: its names are looked up again.
            Ok(loaded) if loaded.generation != generation => self.send(job),
            Ok(loaded) => self.insert(job.number, loaded),
        }
    }

    fn insert(&mut self, number: u64, loaded: Loaded) {
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

    /// Loading has failed: the command is no more.
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

    /// A command by its name.
    pub(crate) fn find(&self, name: &str) -> Result<(u64, &Record), Failure> {
        let number = number_of(name, 'n');
        let found = number.and_then(|n| Some((n, self.commands.get(&n)?)));
        found.ok_or_else(|| Failure::Unknown(format!("command {name}")))
    }

    /// What a command may take of a tick at most, nanoseconds, once it is loaded.
    pub(crate) fn bound_ns(&self, record: &Record) -> Option<u64> {
        Some(self.control.bound_ns(record.id?))
    }

    /// All commands by their names.
    pub(crate) fn commands(&self) -> impl Iterator<Item = (String, &Record)> {
        let commands = self.commands.iter().filter(|(_, r)| r.eval.is_none());
        commands.map(|(number, record)| (format!("n{number}"), record))
    }

    /// The name that a command has in the core.
    pub(super) fn core_id(&self, name: &str) -> Result<CommandId, Failure> {
        let (_, record) = self.find(name)?;
        let loading = || Failure::Bad(format!("{name} is still being loaded"));
        record.id.ok_or_else(loading)
    }

    /// Asks something of a command by its name.
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

    /// Fails if a command needs values that nobody has given: one that is started by request follows none.
    fn has_all(&self, name: &str) -> Result<(), Failure> {
        let (_, record) = self.find(name)?;
        let needed = record.given.iter().filter(|given| given.is_needed);
        let needed: Vec<&str> = needed.map(|given| given.key.as_str()).collect();
        let waits = record.status.phase == Phase::Is(State::Ready);
        match needed.is_empty() || !waits {
            true => Ok(()),
            false => Err(Failure::Bad(format!(
                "{name} takes {} over, and follows no command that hands it over: set it first (`command.set`), or schedule it after one that exports it",
                needed.join(", ")
            ))),
        }
    }

    /// Asks a command to end.
    pub(crate) fn cancel(&mut self, name: &str, reply: Reply) {
        self.ask(name, Control::cancel, reply);
    }

    /// Ends a command by force.
    pub(crate) fn abort(&mut self, name: &str, reply: Reply) {
        self.ask(name, |c, id| c.abort(id, Why::Request), reply);
    }

    /// Unloads a command; one that runs is unloaded as soon as it has ended.
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

    /// Sets inputs of commands, all between the same two cycles, or none.
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

    /// Fails if more is to be set at once than there is time for.
    pub(crate) fn may_set(&self, count: usize) -> Result<(), Failure> {
        match count > self.limits.values {
            true => Err(Failure::Limit("values that are set at once")),
            false => Ok(()),
        }
    }

    /// What is to be set, each input once: whoever says it twice means what comes last.
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

    /// What was set is given.
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
                "{key} of {name} is taken over when it starts, and cannot be set any more"
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

/// A name, with what its owner calls it.
pub(super) fn called(name: &str, title: &str) -> String {
    match title {
        "" => name.to_owned(),
        title => format!("{name} ({title})"),
    }
}

impl Load<'_> {
    /// Bytes of it that are kept.
    pub(super) fn bytes(&self) -> usize {
        self.text.len() + self.command.map_or(0, str::len)
    }
}

impl Record {
    /// What it is called in the log: its name, and what its owner calls it.
    pub(super) fn called(&self, number: u64) -> String {
        called(&format!("n{number}"), &self.title)
    }

    /// A command of which nothing more is known yet.
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
    let bad = |why: String| Failure::Bad(format!("`{text}` is no {ty}: {why}"));
    let value = literal::read(text, ty).map_err(|e| bad(e.to_string()))?;
    let value = value.ok_or_else(|| bad("an input needs a value".to_owned()))?;
    Ok(value.cells().into())
}

/// The names of the results by which a command can end.
pub(crate) fn results(image: &Image) -> Vec<&str> {
    match &image.end {
        End::Results(results) => results.iter().map(|r| r.name.as_str()).collect(),
        End::Ports { .. } => Vec::new(),
    }
}

/// Whether a command has ended in motion, which its successor has gone on with.
pub(super) fn yields(image: &Image, ending: &Ending) -> bool {
    let (Cause::Result(k), End::Results(results)) = (ending.cause, &image.end) else {
        return false;
    };
    let kind = results.get(k).map(|r| r.kind);
    kind == Some(EndKind::Yield) && !ending.left_moving
}
