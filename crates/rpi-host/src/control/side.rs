//! The host's side: loads, asks, listens, frees.

use std::collections::BTreeMap;
use std::sync::Arc;

use rpi_core::{
    Command, CommandId, Continuity, Ending, Fact, Notice, OnOverrun, Places, Rule, RuleId, State,
    Why,
};
use rpi_device::DeviceBank;
use rpi_image::image::End;
use rpi_image::{Image, Scalar, Type};

use super::admission::Admission;
use super::board::Board;
use super::event::{Event, Rejected, Ticket};
use super::journal::{Asked, Journal};
use super::queue::{Dead, HostEnds, Options, Request, Setting};
use super::subscription::{self, Subscription};

/// What is known of a command.
#[derive(Clone, Debug)]
pub struct Info {
    /// What it runs.
    pub image: Arc<Image>,
    /// Its state as last heard.
    pub state: State,
    /// How it has ended, if it has.
    pub ending: Option<Ending>,
    /// Tick of its first cycle, if it was started.
    pub first_tick: Option<u64>,
}

/// A command that was taken in with a board.
#[derive(Debug)]
pub struct Adopted {
    /// Its name.
    pub id: CommandId,
    /// Answered once it is ready.
    pub ticket: Ticket,
    /// What it exports.
    pub board: Arc<Board>,
}

/// The host's side of a control core. One thread owns it; nothing that it does makes the cycle wait.
pub struct Control<T = rpi_sim::Part> {
    ends: HostEnds<T>,
    names: Box<dyn DeviceBank + Send>,
    places: Places,
    commands: BTreeMap<CommandId, Info>,
    /// Freed by the host, to be told once all that happened before has been.
    freed: Vec<CommandId>,
    tickets: u64,
    /// Rules that are with the cycle.
    rules: usize,
    most_rules: usize,
    continuity: Continuity,
    on_overrun: OnOverrun,
    buffer: Vec<u64>,
    samples_lost: u64,
    journal: Option<Journal>,
    admission: Admission,
}

impl<T> Control<T> {
    pub(super) fn new(
        ends: HostEnds<T>,
        names: Box<dyn DeviceBank + Send>,
        options: Options,
    ) -> Control<T> {
        Control {
            ends,
            names,
            places: Places::new(options.commands),
            commands: BTreeMap::new(),
            freed: Vec::new(),
            tickets: 0,
            rules: 0,
            most_rules: options.rules(),
            continuity: options.continuity,
            on_overrun: options.on_overrun,
            buffer: Vec::new(),
            samples_lost: 0,
            journal: None,
            admission: Admission::new(options.budget),
        }
    }

    /// Tells this every request from now on.
    pub fn write_down(&mut self, journal: Journal) {
        self.journal = Some(journal);
    }

    /// Loads an image and sends it to the cycle; it is ready from the answer to its insertion on, and can be named at once.
    ///
    /// # Errors
    /// If it cannot run in this cell, with every reason, or there is no room.
    pub fn load(&mut self, image: Arc<Image>) -> Result<CommandId, Rejected> {
        let mut command = Command::load(image, &mut *self.names).map_err(Rejected::Loading)?;
        command.guard(self.continuity);
        command.bound_overruns(self.on_overrun);
        self.adopt(Box::new(command))
    }

    /// Takes a command that was loaded elsewhere, on another thread for example, against equal devices.
    ///
    /// # Errors
    /// If there is no room.
    pub fn adopt(&mut self, command: Box<Command>) -> Result<CommandId, Rejected> {
        self.take_in(command, None).map(|(id, _)| id)
    }

    /// As [`Control::adopt`], with a board on which the command puts what it exports in every cycle.
    ///
    /// # Errors
    /// If there is no room.
    pub fn adopt_with_board(&mut self, command: Box<Command>) -> Result<Adopted, Rejected> {
        let board = Arc::new(Board::new(&command.machine().image().exports));
        let (id, ticket) = self.take_in(command, Some(Arc::clone(&board)))?;
        Ok(Adopted { id, ticket, board })
    }

    fn take_in(
        &mut self,
        command: Box<Command>,
        board: Option<Arc<Board>>,
    ) -> Result<(CommandId, Ticket), Rejected> {
        self.has_room()?;
        self.admission.fits(&command)?;
        let id = self.places.take().ok_or(Rejected::Full)?;
        self.admission.enter(id, &command);
        let info = Info {
            image: Arc::clone(command.machine().image()),
            state: State::Ready,
            ending: None,
            first_tick: None,
        };
        self.commands.insert(id, info);
        let ticket = self.ask(Request::Insert(id, command, board))?;
        Ok((id, ticket))
    }

    /// Starts a command: its first cycle is in the tick that takes the request.
    ///
    /// # Errors
    /// If it is not known, too much is under way, or it takes more of a tick than what runs leaves; what the cycle has against
    /// it comes as the answer.
    pub fn start(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        let way = self.admission.admit_start(id)?;
        let ticket = self.ask_about(id, Request::Start(id))?;
        self.admission.ask(ticket, way);
        Ok(ticket)
    }

    /// Asks a command to end; it sees `cancel`.
    ///
    /// # Errors
    /// As [`Control::start`].
    pub fn cancel(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        self.ask_about(id, Request::Cancel(id))
    }

    /// Ends a command by force; its devices stop on their own limits.
    ///
    /// # Errors
    /// As [`Control::start`].
    pub fn abort(&mut self, id: CommandId, why: Why) -> Result<Ticket, Rejected> {
        self.ask_about(id, Request::Abort(id, why))
    }

    /// Takes a command off the schedule; it is ready again.
    ///
    /// # Errors
    /// As [`Control::start`].
    pub fn unschedule(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        self.ask_about(id, Request::Unschedule(id))
    }

    /// Gives a command back that does not run.
    ///
    /// # Errors
    /// As [`Control::start`].
    pub fn unload(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        self.ask_about(id, Request::Unload(id))
    }

    /// Makes a rule; see [`Rule`] and [`Control::fact`].
    ///
    /// # Errors
    /// If too many rules or requests are under way, or what it starts takes more of a tick than what may run with it leaves; what the
    /// cycle has against it comes as the answer.
    pub fn schedule(&mut self, rule: Rule) -> Result<(RuleId, Ticket), Rejected> {
        if self.rules >= self.most_rules {
            return Err(Rejected::Busy);
        }
        let id = self.places.rule();
        let way = self.admission.admit_rule(id, &rule)?;
        let ticket = self.ask(Request::Schedule(id, Box::new(rule)))?;
        self.admission.ask(ticket, way);
        self.rules += 1;
        Ok((id, ticket))
    }

    /// Drops a rule.
    ///
    /// # Errors
    /// If too many requests are under way.
    pub fn withdraw(&mut self, rule: RuleId) -> Result<Ticket, Rejected> {
        self.ask(Request::Withdraw(rule))
    }

    /// Sets inputs of any commands, all between the same two cycles.
    ///
    /// # Errors
    /// If a command is not known or a value does not fit; nothing is set then.
    pub fn set(&mut self, settings: Vec<Setting>) -> Result<Ticket, Rejected> {
        for setting in &settings {
            let info = self.get(setting.command).ok_or(Rejected::Unknown)?;
            let port = info.image.inputs.get(setting.input);
            if port.is_none_or(|p| p.value.ty.cells() as usize != setting.value.len()) {
                let (command, input) = (setting.command, setting.input);
                return Err(Rejected::Value { command, input });
            }
        }
        self.ask(Request::Set(settings.into()))
    }

    /// Wants to see exported flows of a command (by index) in every so many cycles; in place of what it wanted before.
    ///
    /// # Errors
    /// If the command is not known or too much is under way. Indices without an export are passed over.
    pub fn subscribe(
        &mut self,
        id: CommandId,
        exports: &[u32],
        every: u64,
    ) -> Result<Ticket, Rejected> {
        let image = &self.get(id).ok_or(Rejected::Unknown)?.image;
        let flow = |k: &u32| Some((*k, image.exports.get(*k as usize)?.value));
        let flows: Vec<_> = exports.iter().filter_map(flow).collect();
        self.ask(Request::Subscribe(Box::new(Subscription::new(
            id, &flows, every,
        ))))
    }

    /// Puts a device into a place, or none. Commands whose ports were resolved against what was there must be gone.
    ///
    /// # Errors
    /// If too many requests are under way.
    pub fn put_device(&mut self, place: usize, part: Option<T>) -> Result<Ticket, Rejected> {
        self.ask(Request::Device(place, part))
    }

    /// Ends all commands, drops all rules, brakes all devices.
    ///
    /// # Errors
    /// If too many requests are under way.
    pub fn emergency_stop(&mut self) -> Result<Ticket, Rejected> {
        self.ask(Request::EmergencyStop)
    }

    /// The next thing that has happened. Frees what is over.
    pub fn poll(&mut self) -> Option<Event> {
        if let Some(event) = self.next_event() {
            return Some(event);
        }
        self.free();
        // What has led to their end was told before they were sent.
        if let Some(event) = self.next_event() {
            return Some(event);
        }
        let id = self.freed.pop()?;
        self.commands.remove(&id);
        self.admission.forget(id);
        self.places.give_back(id);
        Some(Event::Freed(id))
    }

    fn next_event(&mut self) -> Option<Event> {
        let event = self.ends.events.pop().ok()?;
        self.admission.hear(&event);
        self.note(&event);
        Some(event)
    }

    /// Hands on the samples that have arrived: command, export, tick, value; no value where the flow is absent.
    pub fn samples(&mut self, mut take: impl FnMut(CommandId, u32, u64, Option<&[u64]>)) {
        let commands = &self.commands;
        subscription::drain(
            &mut self.ends.samples,
            &mut self.buffer,
            |number, export, tick, value| {
                if let Some(id) = commands.keys().find(|id| id.number() == number) {
                    take(*id, export, tick, value);
                }
            },
        );
    }

    /// Samples that were lost because nobody took them in time, of subscriptions that are over.
    #[must_use]
    pub fn samples_lost(&self) -> u64 {
        self.samples_lost
    }

    /// A command as it was last heard of.
    #[must_use]
    pub fn get(&self, id: CommandId) -> Option<&Info> {
        self.commands.get(&id)
    }

    /// All commands, in the order of their places.
    pub fn commands(&self) -> impl Iterator<Item = (CommandId, &Info)> + '_ {
        self.commands.iter().map(|(id, info)| (*id, info))
    }

    /// The fact by which conditions speak of a command's exported Boolean or named result.
    #[must_use]
    pub fn fact(&self, id: CommandId, key: &str) -> Option<Fact> {
        let image = &self.get(id)?.image;
        let boolean = Type::One(Scalar::Bool);
        let mut exports = image.exports.iter();
        let export = exports.position(|e| e.key == key && e.value.ty == boolean);
        let result = match &image.end {
            End::Results(results) => results.iter().position(|r| r.name == key),
            End::Ports { .. } => None,
        };
        let export = export.and_then(|k| Some(Fact::Export(u32::try_from(k).ok()?)));
        export.or_else(|| Some(Fact::Result(u32::try_from(result?).ok()?)))
    }

    /// What a command may take of a tick at most, nanoseconds; 0 where nobody sees to that.
    #[must_use]
    pub fn bound_ns(&self, id: CommandId) -> u64 {
        self.admission.bound_ns(id)
    }

    fn ask_about(&mut self, id: CommandId, request: Request<T>) -> Result<Ticket, Rejected> {
        match self.commands.contains_key(&id) {
            true => self.ask(request),
            false => Err(Rejected::Unknown),
        }
    }

    fn ask(&mut self, request: Request<T>) -> Result<Ticket, Rejected> {
        self.has_room()?;
        self.tickets += 1;
        let ticket = Ticket(self.tickets);
        if let Some(journal) = &mut self.journal {
            journal(ticket, Asked::of(&request));
        }
        // There is room, as was just seen; nobody else asks.
        let _ = self.ends.requests.push((ticket, request));
        Ok(ticket)
    }

    /// How many more requests can be under way now.
    #[must_use]
    pub fn room(&self) -> usize {
        self.ends.requests.slots()
    }

    fn has_room(&self) -> Result<(), Rejected> {
        match self.ends.requests.is_full() {
            true => Err(Rejected::Busy),
            false => Ok(()),
        }
    }

    fn free(&mut self) {
        while let Ok(dead) = self.ends.dead.pop() {
            match dead {
                Dead::Command(id, command) => {
                    drop(command);
                    self.freed.push(id);
                }
                Dead::Rule(rule) => {
                    drop(rule);
                    self.rules = self.rules.saturating_sub(1);
                }
                Dead::Subscription(old) => self.samples_lost += old.lost,
                Dead::Settings(settings) => drop(settings),
                Dead::Board(board) => drop(board),
                Dead::Device(part) => drop(part),
            }
        }
    }

    /// Keeps the books.
    fn note(&mut self, event: &Event) {
        let Event::Notice(notice) = event else {
            return;
        };
        let (command, state) = match *notice {
            Notice::Scheduled { command } => (command, State::Scheduled),
            Notice::Started { command, .. } => (command, State::Running),
            Notice::Cancelling { command } => (command, State::Cancelling),
            Notice::Ended { command, .. } => (command, State::Terminated),
            Notice::Orphaned { command, .. } => (command, State::Ready),
            Notice::Braked { .. } | Notice::Jumped { .. } | Notice::Rule { .. } => return,
        };
        let Some(info) = self.commands.get_mut(&command) else {
            return;
        };
        info.state = state;
        match *notice {
            Notice::Started { tick, .. } => info.first_tick = Some(tick),
            Notice::Ended { ending, .. } => info.ending = Some(ending),
            _ => {}
        }
    }
}
