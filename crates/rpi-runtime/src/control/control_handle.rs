//! Host side of the control core: loads commands, sends requests, receives events, frees memory.

use std::collections::BTreeMap;
use std::sync::Arc;

use rpi_core::{
    AbortReason, Command, CommandId, CommandOverrunPolicy, CommandState, Continuity, Ending, Fact,
    IdAllocator, MotionControls, Notice, Rule, RuleId,
};
use rpi_device::DeviceBank;
use rpi_image::image::CommandEnd;
use rpi_image::{Image, Scalar, Type};

use super::admission::Admission;
use super::event::{Event, RequestError, Ticket};
use super::export_snapshot::ExportSnapshot;
use super::queue::{HostQueues, InputValue, Options, Released, Request};
use super::request_log::{RequestLog, RequestRecord};
use super::subscription::{self, Subscription};

/// Information about a loaded command on the host side, derived from its requests and the received events.
#[derive(Clone, Debug)]
pub struct CommandInfo {
    /// Compiled program of the command.
    pub image: Arc<Image>,
    /// Life-cycle state of the command according to the latest event.
    pub state: CommandState,
    /// Cause and circumstances of the command's end; `None` if the command has not ended.
    pub ending: Option<Ending>,
    /// Number of the tick of the command's first cycle; `None` if the command was not started.
    pub first_tick: Option<u64>,
}

/// A loaded command that was sent to the core, with the snapshot in which the core stores its exports.
#[derive(Debug)]
pub struct AdoptedCommand {
    /// Identifier of the command in the core.
    pub id: CommandId,
    /// Ticket of the request that inserts the command. Its answer means that the command is ready.
    pub ticket: Ticket,
    /// Snapshot in which the core stores the exports of the command after every cycle.
    pub snapshot: Arc<ExportSnapshot>,
}

/// Host side of a control core, owned by one thread. No method makes the cycle wait. `T` is the type of a device.
pub struct Control<T = rpi_sim::NamedDevice> {
    queues: HostQueues<T>,
    names: Box<dyn DeviceBank + Send>,
    ids: IdAllocator,
    commands: BTreeMap<CommandId, CommandInfo>,
    /// Commands that the core has freed. They are reported once all earlier events have been reported.
    freed: Vec<CommandId>,
    tickets: u64,
    /// Number of rules that the core has at present, including those whose requests are not answered yet.
    rules: usize,
    max_rules: usize,
    continuity: Continuity,
    on_overrun: CommandOverrunPolicy,
    buffer: Vec<u64>,
    samples_lost: u64,
    request_log: Option<RequestLog>,
    admission: Admission,
}

impl<T> Control<T> {
    pub(super) fn new(
        ends: HostQueues<T>,
        names: Box<dyn DeviceBank + Send>,
        options: Options,
    ) -> Control<T> {
        Control {
            queues: ends,
            names,
            ids: IdAllocator::new(options.commands),
            commands: BTreeMap::new(),
            freed: Vec::new(),
            tickets: 0,
            rules: 0,
            max_rules: options.rules(),
            continuity: options.continuity,
            on_overrun: options.on_overrun,
            buffer: Vec::new(),
            samples_lost: 0,
            request_log: None,
            admission: Admission::new(options.budget),
        }
    }

    /// Registers a callback that receives every request sent to the core from now on, for a recording.
    pub fn set_request_log(&mut self, request_log: RequestLog) {
        self.request_log = Some(request_log);
    }

    /// Loads an image and sends the command to the cycle. The returned identifier can be used in requests immediately;
    /// the command is ready once its insertion is answered.
    ///
    /// # Errors
    /// Returns an error with all load errors if the command cannot run in this cell, or if the command table or the
    /// queue is full.
    pub fn load(&mut self, image: Arc<Image>) -> Result<CommandId, RequestError> {
        let mut command = Command::load(image, &mut *self.names).map_err(RequestError::Load)?;
        command.set_continuity(self.continuity);
        command.set_overrun_policy(self.on_overrun);
        self.adopt(Box::new(command))
    }

    /// Sends a command to the core that was loaded elsewhere, for example on another thread, with equal devices.
    ///
    /// # Errors
    /// Returns an error if the command table or the queue is full, or if the command exceeds the time budget.
    pub fn adopt(&mut self, command: Box<Command>) -> Result<CommandId, RequestError> {
        self.insert_command(command, None).map(|(id, _)| id)
    }

    /// Sends a command to the core that was loaded elsewhere, as [`Control::adopt`] does. The core writes the command's
    /// exports to the returned snapshot after every cycle.
    ///
    /// # Errors
    /// Returns an error if the command table or the queue is full, or if the command exceeds the time budget.
    pub fn adopt_with_snapshot(
        &mut self,
        command: Box<Command>,
    ) -> Result<AdoptedCommand, RequestError> {
        let snapshot = Arc::new(ExportSnapshot::new(&command.instance().image().exports));
        let (id, ticket) = self.insert_command(command, Some(Arc::clone(&snapshot)))?;
        Ok(AdoptedCommand {
            id,
            ticket,
            snapshot,
        })
    }

    fn insert_command(
        &mut self,
        command: Box<Command>,
        snapshot: Option<Arc<ExportSnapshot>>,
    ) -> Result<(CommandId, Ticket), RequestError> {
        self.ensure_queue_space()?;
        self.admission.check_alone(&command)?;
        let id = self.ids.allocate().ok_or(RequestError::TableFull)?;
        self.admission.insert(id, &command);
        let info = CommandInfo {
            image: Arc::clone(command.instance().image()),
            state: CommandState::Ready,
            ending: None,
            first_tick: None,
        };
        self.commands.insert(id, info);
        let ticket = self.send_request(Request::Insert(id, command, snapshot))?;
        Ok((id, ticket))
    }

    /// Requests the start of a command. Its first cycle is in the tick in which the core carries out the request.
    ///
    /// # Errors
    /// Returns an error if the command is unknown, the queue is full, or the time budget left by the other commands is
    /// exceeded. Other reasons for a refusal are reported in the answer.
    pub fn start(&mut self, id: CommandId) -> Result<Ticket, RequestError> {
        let cause = self.admission.admit_start(id)?;
        let ticket = self.send_command_request(id, Request::Start(id))?;
        self.admission.request_sent(ticket, cause);
        Ok(ticket)
    }

    /// Requests a command to end: its input `cancel` becomes true.
    ///
    /// # Errors
    /// Returns an error if the command is unknown or there are too many pending requests.
    pub fn cancel(&mut self, id: CommandId) -> Result<Ticket, RequestError> {
        self.send_command_request(id, Request::Cancel(id))
    }

    /// Ends a command immediately. Its devices brake within their own limits.
    ///
    /// # Errors
    /// Returns an error if the command is unknown or there are too many pending requests.
    pub fn abort(&mut self, id: CommandId, why: AbortReason) -> Result<Ticket, RequestError> {
        self.send_command_request(id, Request::Abort(id, why))
    }

    /// Removes a command from all rules that would start it. The command is then ready again.
    ///
    /// # Errors
    /// Returns an error if the command is unknown or there are too many pending requests.
    pub fn unschedule(&mut self, id: CommandId) -> Result<Ticket, RequestError> {
        self.send_command_request(id, Request::Unschedule(id))
    }

    /// Removes a command that does not run from the core and frees it.
    ///
    /// # Errors
    /// Returns an error if the command is unknown or there are too many pending requests.
    pub fn unload(&mut self, id: CommandId) -> Result<Ticket, RequestError> {
        self.send_command_request(id, Request::Unload(id))
    }

    /// Adds a rule, which starts or ends commands on a condition; see [`Rule`] and [`Control::fact`].
    ///
    /// # Errors
    /// Returns an error if there are too many rules or pending requests, or if the started commands exceed the time
    /// budget left by the commands that may run with them. Other reasons for a refusal are reported in the answer.
    pub fn schedule(&mut self, rule: Rule) -> Result<(RuleId, Ticket), RequestError> {
        if self.rules >= self.max_rules {
            return Err(RequestError::QueueFull);
        }
        let id = self.ids.allocate_rule();
        let cause = self.admission.admit_rule(id, &rule)?;
        let ticket = self.send_request(Request::Schedule(id, Box::new(rule)))?;
        self.admission.request_sent(ticket, cause);
        self.rules += 1;
        Ok((id, ticket))
    }

    /// Removes a rule, so that it cannot fire.
    ///
    /// # Errors
    /// Returns an error if there are too many pending requests.
    pub fn withdraw(&mut self, rule: RuleId) -> Result<Ticket, RequestError> {
        self.send_request(Request::Withdraw(rule))
    }

    /// Sets inputs of commands, all of them between the same two cycles.
    ///
    /// # Errors
    /// Returns an error if a command is unknown or a value has the wrong size. Nothing is set then.
    pub fn set(&mut self, settings: Vec<InputValue>) -> Result<Ticket, RequestError> {
        for setting in &settings {
            let info = self
                .get(setting.command)
                .ok_or(RequestError::UnknownCommand)?;
            let port = info.image.inputs.get(setting.input);
            if port.is_none_or(|p| p.value.ty.slots() as usize != setting.value.len()) {
                let (command, input) = (setting.command, setting.input);
                return Err(RequestError::ValueSize { command, input });
            }
        }
        self.send_request(Request::Set(settings.into()))
    }

    /// Subscribes to exported flows of a command, given by their indices in the image. Their values are sampled every
    /// `every` cycles. The subscription replaces an earlier one of the same command.
    ///
    /// # Errors
    /// Returns an error if the command is unknown or there are too many pending requests. Indices without an export are
    /// ignored.
    pub fn subscribe(
        &mut self,
        id: CommandId,
        exports: &[u32],
        every: u64,
    ) -> Result<Ticket, RequestError> {
        let image = &self.get(id).ok_or(RequestError::UnknownCommand)?.image;
        let flow = |k: &u32| Some((*k, image.exports.get(*k as usize)?.value));
        let flows: Vec<_> = exports.iter().filter_map(flow).collect();
        self.send_request(Request::Subscribe(Box::new(Subscription::new(
            id, &flows, every,
        ))))
    }

    /// Inserts the device `part` at the index `place`, or removes the device there if `part` is `None`.
    ///
    /// Commands that use the previous device must have been unloaded.
    ///
    /// # Errors
    /// Returns an error if there are too many pending requests.
    pub fn replace_device(
        &mut self,
        place: usize,
        part: Option<T>,
    ) -> Result<Ticket, RequestError> {
        self.send_request(Request::Device(place, part))
    }

    /// Sets the speed override (0 to 1) and the pause of all motions. Commands see them from their next cycle on.
    ///
    /// # Errors
    /// Returns an error if there are too many pending requests.
    pub fn set_controls(&mut self, controls: MotionControls) -> Result<Ticket, RequestError> {
        self.send_request(Request::SetControls(controls))
    }

    /// Aborts all commands, drops all rules and brakes all devices.
    ///
    /// # Errors
    /// Returns an error if there are too many pending requests.
    pub fn emergency_stop(&mut self) -> Result<Ticket, RequestError> {
        self.send_request(Request::EmergencyStop)
    }

    /// Returns the next event of the core; `None` if there is none now. Frees objects that the core no longer uses.
    pub fn poll(&mut self) -> Option<Event> {
        if let Some(event) = self.next_event() {
            return Some(event);
        }
        self.free_released();
        // The events that led to the release of the objects were sent before the objects, so they are reported first.
        if let Some(event) = self.next_event() {
            return Some(event);
        }
        let id = self.freed.pop()?;
        self.commands.remove(&id);
        self.admission.remove(id);
        self.ids.release(id);
        Some(Event::Freed(id))
    }

    fn next_event(&mut self) -> Option<Event> {
        let event = self.queues.events.pop().ok()?;
        self.admission.handle_event(&event);
        self.update_info(&event);
        Some(event)
    }

    /// Passes all samples received so far to `take`: command, export index, tick number, and memory words of the value.
    /// The value is `None` if the flow is absent.
    pub fn samples(&mut self, mut take: impl FnMut(CommandId, u32, u64, Option<&[u64]>)) {
        let commands = &self.commands;
        subscription::drain_samples(
            &mut self.queues.samples,
            &mut self.buffer,
            |number, export, tick, value| {
                if let Some(id) = commands.keys().find(|id| id.to_number() == number) {
                    take(*id, export, tick, value);
                }
            },
        );
    }

    /// Returns the number of samples that were lost because the host did not read them in time. Subscriptions count
    /// only after they have ended.
    #[must_use]
    pub fn samples_lost(&self) -> u64 {
        self.samples_lost
    }

    /// Returns the information about a command; `None` if it is unknown.
    #[must_use]
    pub fn get(&self, id: CommandId) -> Option<&CommandInfo> {
        self.commands.get(&id)
    }

    /// Iterates over all commands in the order of their identifiers.
    pub fn commands(&self) -> impl Iterator<Item = (CommandId, &CommandInfo)> + '_ {
        self.commands.iter().map(|(id, info)| (*id, info))
    }

    /// Returns the fact by which a rule condition refers to the Boolean export or the named result `key` of a command;
    /// `None` if the command has neither.
    #[must_use]
    pub fn fact(&self, id: CommandId, key: &str) -> Option<Fact> {
        let image = &self.get(id)?.image;
        let boolean = Type::Scalar(Scalar::Bool);
        let mut exports = image.exports.iter();
        let export = exports.position(|e| e.key == key && e.value.ty == boolean);
        let result = match &image.end {
            CommandEnd::Results(results) => results.iter().position(|r| r.name == key),
            CommandEnd::Ports { .. } => None,
        };
        let export = export.and_then(|k| Some(Fact::Export(u32::try_from(k).ok()?)));
        export.or_else(|| Some(Fact::Result(u32::try_from(result?).ok()?)))
    }

    /// Returns the worst-case time of a command in a tick in nanoseconds; 0 if admission control is disabled.
    #[must_use]
    pub fn bound_ns(&self, id: CommandId) -> u64 {
        self.admission.bound_ns(id)
    }

    fn send_command_request(
        &mut self,
        id: CommandId,
        request: Request<T>,
    ) -> Result<Ticket, RequestError> {
        match self.commands.contains_key(&id) {
            true => self.send_request(request),
            false => Err(RequestError::UnknownCommand),
        }
    }

    pub(super) fn send_request(&mut self, request: Request<T>) -> Result<Ticket, RequestError> {
        self.ensure_queue_space()?;
        self.tickets += 1;
        let ticket = Ticket(self.tickets);
        if let Some(request_log) = &mut self.request_log {
            request_log(ticket, RequestRecord::from_request(&request));
        }
        // `has_room` was checked above, and this is the only producer.
        let _ = self.queues.requests.push((ticket, request));
        Ok(ticket)
    }

    /// Returns the number of further requests that the request queue has room for.
    #[must_use]
    pub fn free_requests(&self) -> usize {
        self.queues.requests.slots()
    }

    fn ensure_queue_space(&self) -> Result<(), RequestError> {
        match self.queues.requests.is_full() {
            true => Err(RequestError::QueueFull),
            false => Ok(()),
        }
    }

    fn free_released(&mut self) {
        while let Ok(released) = self.queues.released.pop() {
            // Memory is freed here and not in the cycle, because the allocator may take a lock.
            match released {
                Released::Command(id, command) => {
                    drop(command);
                    self.freed.push(id);
                }
                Released::Rule(rule) => {
                    drop(rule);
                    self.rules = self.rules.saturating_sub(1);
                }
                Released::Subscription(old) => self.samples_lost += old.lost,
                Released::Settings(settings) => drop(settings),
                Released::Resources(resources) => drop(resources),
                Released::Snapshot(snapshot) => drop(snapshot),
                Released::Device(part) => drop(part),
            }
        }
    }

    /// Updates the state, first tick and ending of a command from an event of the core.
    fn update_info(&mut self, event: &Event) {
        let Event::Notice(notice) = event else {
            return;
        };
        let (command, state) = match *notice {
            Notice::Scheduled { command } => (command, CommandState::Scheduled),
            Notice::Started { command, .. } => (command, CommandState::Running),
            Notice::Cancelling { command } => (command, CommandState::Cancelling),
            Notice::Ended { command, .. } => (command, CommandState::Terminated),
            Notice::Orphaned { command, .. } => (command, CommandState::Ready),
            Notice::Braked { .. } | Notice::Discontinuity { .. } | Notice::Rule { .. } => return,
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
