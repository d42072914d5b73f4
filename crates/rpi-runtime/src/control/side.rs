//! Host side of the control core: loads commands, sends requests, receives events, frees memory.

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

/// Host-side information about a command.
#[derive(Clone, Debug)]
pub struct Info {
    /// Image that the command runs.
    pub image: Arc<Image>,
    /// State according to the latest event.
    pub state: State,
    /// How the command ended, if it has ended.
    pub ending: Option<Ending>,
    /// Tick of the first cycle, if the command was started.
    pub first_tick: Option<u64>,
}

/// A loaded command with a board.
#[derive(Debug)]
pub struct Adopted {
    /// Identifier of the command.
    pub id: CommandId,
    /// Ticket of the insertion. Its answer means that the command is ready.
    pub ticket: Ticket,
    /// Board with the exports of the command.
    pub board: Arc<Board>,
}

/// Host side of a control core, owned by one thread. No method makes the cycle wait.
pub struct Control<T = rpi_sim::Part> {
    ends: HostEnds<T>,
    names: Box<dyn DeviceBank + Send>,
    places: Places,
    commands: BTreeMap<CommandId, Info>,
    /// Freed commands that are reported once all earlier events have been reported.
    freed: Vec<CommandId>,
    tickets: u64,
    /// Number of rules in the cycle.
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

    /// Registers a callback that receives every request from now on.
    pub fn write_down(&mut self, journal: Journal) {
        self.journal = Some(journal);
    }

    /// Loads an image and sends the command to the cycle. The returned identifier can be used in requests immediately;
    /// the command is ready once its insertion is answered.
    ///
    /// # Errors
    /// Returns an error with all load errors if the command cannot run in this cell, or if the command table or the
    /// queue is full.
    pub fn load(&mut self, image: Arc<Image>) -> Result<CommandId, Rejected> {
        let mut command = Command::load(image, &mut *self.names).map_err(Rejected::Loading)?;
        command.guard(self.continuity);
        command.bound_overruns(self.on_overrun);
        self.adopt(Box::new(command))
    }

    /// Takes a command that was loaded elsewhere, for example on another thread, against identical devices.
    ///
    /// # Errors
    /// Returns an error if the command table or the queue is full, or if the command exceeds the time budget.
    pub fn adopt(&mut self, command: Box<Command>) -> Result<CommandId, Rejected> {
        self.take_in(command, None).map(|(id, _)| id)
    }

    /// Like [`Control::adopt`], with a board to which the command's exports are written in every cycle.
    ///
    /// # Errors
    /// Returns an error if the command table or the queue is full, or if the command exceeds the time budget.
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

    /// Starts a command. Its first cycle is in the tick that takes the request.
    ///
    /// # Errors
    /// Returns an error if the command is unknown, the queue is full, or the time budget left by the other commands is
    /// exceeded. Other reasons for a refusal are reported in the answer.
    pub fn start(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        let way = self.admission.admit_start(id)?;
        let ticket = self.ask_about(id, Request::Start(id))?;
        self.admission.ask(ticket, way);
        Ok(ticket)
    }

    /// Requests a command to end: its input `cancel` becomes true.
    ///
    /// # Errors
    /// As for [`Control::start`].
    pub fn cancel(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        self.ask_about(id, Request::Cancel(id))
    }

    /// Ends a command immediately. Its devices brake within their own limits.
    ///
    /// # Errors
    /// As for [`Control::start`].
    pub fn abort(&mut self, id: CommandId, why: Why) -> Result<Ticket, Rejected> {
        self.ask_about(id, Request::Abort(id, why))
    }

    /// Takes a command off the schedule. The command is then ready again.
    ///
    /// # Errors
    /// As for [`Control::start`].
    pub fn unschedule(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        self.ask_about(id, Request::Unschedule(id))
    }

    /// Unloads a command that does not run.
    ///
    /// # Errors
    /// As for [`Control::start`].
    pub fn unload(&mut self, id: CommandId) -> Result<Ticket, Rejected> {
        self.ask_about(id, Request::Unload(id))
    }

    /// Adds a rule; see [`Rule`] and [`Control::fact`].
    ///
    /// # Errors
    /// Returns an error if there are too many rules or pending requests, or if the started commands exceed the time
    /// budget left by the commands that may run with them. Other reasons for a refusal are reported in the answer.
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

    /// Removes a rule.
    ///
    /// # Errors
    /// Returns an error if there are too many pending requests.
    pub fn withdraw(&mut self, rule: RuleId) -> Result<Ticket, Rejected> {
        self.ask(Request::Withdraw(rule))
    }

    /// Sets inputs of any commands between the same two cycles.
    ///
    /// # Errors
    /// Returns an error if a command is unknown or a value has the wrong size. Nothing is set then.
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

    /// Subscribes to exported flows of a command (by index). `every` is the sampling period in cycles. The subscription
    /// replaces an earlier one of the same command.
    ///
    /// # Errors
    /// Returns an error if the command is unknown or there are too many pending requests. Indices without an export are
    /// ignored.
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

    /// Inserts a device at an index, or removes it if `part` is `None`.
    ///
    /// Commands whose ports were resolved against the previous device must have been unloaded.
    ///
    /// # Errors
    /// Returns an error if there are too many pending requests.
    pub fn put_device(&mut self, place: usize, part: Option<T>) -> Result<Ticket, Rejected> {
        self.ask(Request::Device(place, part))
    }

    /// Ends all commands, drops all rules and brakes all devices.
    ///
    /// # Errors
    /// Returns an error if there are too many pending requests.
    pub fn emergency_stop(&mut self) -> Result<Ticket, Rejected> {
        self.ask(Request::EmergencyStop)
    }

    /// Returns the next event, and frees objects released by the cycle.
    pub fn poll(&mut self) -> Option<Event> {
        if let Some(event) = self.next_event() {
            return Some(event);
        }
        self.free();
        // The events that led to the release of the objects were sent before the objects, so they are reported first.
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

    /// Passes all samples received so far to `take`: command, export index, tick, value. The value is `None` if the
    /// flow is absent.
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

    /// Returns the number of samples that were lost because they were not taken in time. Only subscriptions that have
    /// ended are counted.
    #[must_use]
    pub fn samples_lost(&self) -> u64 {
        self.samples_lost
    }

    /// Returns the information about a command; `None` if it is unknown.
    #[must_use]
    pub fn get(&self, id: CommandId) -> Option<&Info> {
        self.commands.get(&id)
    }

    /// Iterates over all commands in the order of their identifiers.
    pub fn commands(&self) -> impl Iterator<Item = (CommandId, &Info)> + '_ {
        self.commands.iter().map(|(id, info)| (*id, info))
    }

    /// Returns the fact by which a condition refers to an exported Boolean or a named result of a command.
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

    /// Returns the worst-case time of a command in a tick in nanoseconds; 0 if admission control is disabled.
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
        // `has_room` was checked above, and this is the only producer.
        let _ = self.ends.requests.push((ticket, request));
        Ok(ticket)
    }

    /// Returns the number of requests that can still be sent.
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

    /// Updates the information about a command from an event.
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
