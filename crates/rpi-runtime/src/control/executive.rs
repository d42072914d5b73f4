//! Cycle side of the control core: takes requests, ticks the core, steps the devices and sends events.

use std::sync::Arc;

use rpi_core::{Command, CommandId, Core, Refused, Watch};

use super::board::Board;
use super::event::Event;
use super::plant::{Late, Plant};
use super::queue::{CycleEnds, Dead, Options, Request};
use super::subscription::Subscription;
use crate::realtime::Stopwatch;

/// A control core with its devices. One thread ticks it.
pub struct Executive<P: Plant> {
    core: Core,
    plant: P,
    ends: CycleEnds<P::Part>,
    /// Subscriptions, indexed by command slot.
    subscriptions: Box<[Option<Box<Subscription>>]>,
    /// Boards, indexed by command slot.
    boards: Boards,
    /// Last reported error code and motion state of each device.
    told: Vec<(i64, bool)>,
    per_tick: usize,
    stopwatch: Stopwatch,
}

/// For each command slot, the owner of its board and the board.
type Boards = Box<[Option<(CommandId, Arc<Board>)>]>;

/// Effort per tick after which no further request is taken, in units of about ten nanoseconds. At least one request of
/// any size is taken per tick.
const EFFORT: usize = 8192;

/// Maximum number of devices whose state changes are reported.
const DEVICES: usize = 256;

impl<P: Plant> Executive<P> {
    pub(super) fn new(plant: P, ends: CycleEnds<P::Part>, options: Options) -> Self {
        Executive {
            core: Core::with_capacity(options.commands, options.tick_ns),
            plant,
            ends,
            subscriptions: (0..options.commands).map(|_| None).collect(),
            boards: (0..options.commands).map(|_| None).collect(),
            told: vec![(0, false); DEVICES],
            per_tick: options.requests_per_tick.max(1),
            stopwatch: Stopwatch::new(options.timed),
        }
    }

    /// Returns the number of the next tick.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.core.now()
    }

    /// Executes one tick: requests, cycles, devices, events.
    ///
    /// `wall_ns` is the wall clock in nanoseconds since the Unix epoch. `watch` observes every command at the end of
    /// its cycle.
    pub fn tick(&mut self, wall_ns: i64, watch: &mut dyn Watch) {
        self.take_requests();
        self.tick_alone(wall_ns, watch);
    }

    /// Executes one tick without taking requests. Used after all commands were stopped, so that pending requests start
    /// nothing.
    pub fn tick_alone(&mut self, wall_ns: i64, watch: &mut dyn Watch) {
        self.stopwatch.reset();
        let mut watch = Watching {
            stopwatch: &mut self.stopwatch,
            tick: self.core.now(),
            subscriptions: &mut self.subscriptions,
            boards: &self.boards,
            samples: &mut self.ends.samples,
            further: watch,
        };
        self.core.tick(&mut self.plant, wall_ns, &mut watch);
        self.plant.step();
        self.tell();
    }

    /// Returns the devices, for access between ticks.
    pub fn plant(&mut self) -> &mut P {
        &mut self.plant
    }

    /// Returns the core, for inspection between ticks.
    #[must_use]
    pub fn core(&self) -> &Core {
        &self.core
    }

    /// Handles a tick that ended `late_ns` after the next one was due and took `excess_ns` longer than a period.
    ///
    /// The overrun is attributed to the slowest command, unless the tick would have been too long without it. The
    /// overrun policy of that command may end it. Returns true if all commands must be ended.
    pub fn too_late(&mut self, (late_ns, excess_ns): (u64, u64)) -> bool {
        let Some((id, took_ns)) = self.blamed(excess_ns) else {
            return false;
        };
        let Some(command) = self.core.command(id) else {
            return false;
        };
        let late = Late {
            command: id,
            took_ns,
            late_ns,
            fragment: command.machine().busiest(),
        };
        self.plant.too_late(&late);
        self.overran(&late)
    }

    /// Attributes an overrun to a command. The overrun was measured by [`Executive::too_late`] or is replayed from a
    /// tape. Returns true if the overrun policy of the command requires all commands to be ended.
    pub fn overran(&mut self, late: &Late) -> bool {
        let (id, times) = (late.command, (late.took_ns, late.late_ns));
        let stop = self.core.overran(id, times, &mut self.plant);
        let board = self.boards.get(id.place()).and_then(Option::as_ref);
        if let (Some((_, board)), Some(command)) =
            (board.filter(|b| b.0 == id), self.core.command(id))
        {
            board.note(command.overruns());
        }
        self.tell_notices();
        stop
    }

    /// Returns the command to which an overrun is attributed, with its time in nanoseconds.
    ///
    /// The command is the slowest of the latest tick. The result is `None` if nothing was measured, or if the tick
    /// would have exceeded its period even without that command.
    #[must_use]
    pub fn blamed(&self, excess_ns: u64) -> Option<(CommandId, u64)> {
        let longest = self.stopwatch.longest();
        longest.filter(|(_, took)| excess_ns > 0 && *took >= excess_ns)
    }

    /// Ends all commands between two ticks and drops all rules.
    pub fn halt(&mut self, why: rpi_core::Why) {
        self.core.stop_all(why, &mut self.plant);
        self.tell();
    }

    fn take_requests(&mut self) {
        let mut effort = 0;
        for _ in 0..self.per_tick {
            if !self.ends.have_room() || effort >= EFFORT {
                return;
            }
            let Ok((ticket, request)) = self.ends.requests.pop() else {
                return;
            };
            effort += request.effort(self.core.weight_of_rules());
            let tick = self.core.now();
            let refused = self.carry_out(request).err();
            // `have_room` was checked above.
            let _ = self.ends.events.push(Event::Answer {
                ticket,
                tick,
                refused,
            });
            self.tell_notices();
            self.ends.send_dead();
        }
    }

    fn carry_out(&mut self, request: Request<P::Part>) -> Result<(), Refused> {
        let (core, plant) = (&mut self.core, &mut self.plant);
        match request {
            Request::Insert(id, command, board) => self.insert(id, command, board),
            Request::Start(id) => core.start(id, plant),
            Request::Unschedule(id) => core.unschedule(id),
            Request::Cancel(id) => core.cancel(id),
            Request::Abort(id, why) => core.abort(id, why, plant),
            Request::Unload(id) => self.unload(id),
            Request::Schedule(id, rule) => {
                core.schedule_as(id, rule, plant).map_err(|(rule, why)| {
                    self.ends.bury(Dead::Rule(rule));
                    why
                })
            }
            Request::Withdraw(id) => core.withdraw(id),
            Request::Set(settings) => self.set(settings),
            Request::Subscribe(subscription) => self.subscribe(subscription),
            Request::Device(place, part) => {
                let old = plant.swap(place, part);
                old.into_iter()
                    .for_each(|old| self.ends.bury(Dead::Device(old)));
                Ok(())
            }
            Request::EmergencyStop => {
                core.emergency_stop(plant);
                Ok(())
            }
        }
    }

    fn insert(
        &mut self,
        id: CommandId,
        command: Box<Command>,
        board: Option<Arc<Board>>,
    ) -> Result<(), Refused> {
        let inserted = self.core.insert_as(id, command);
        let slot = self.boards.get_mut(id.place());
        match (inserted, slot) {
            (Ok(()), Some(slot)) => *slot = board.map(|board| (id, board)),
            (Ok(()), None) => {}
            (Err((command, why)), _) => {
                board
                    .into_iter()
                    .for_each(|b| self.ends.bury(Dead::Board(b)));
                self.ends.bury(Dead::Command(id, command));
                return Err(why);
            }
        }
        Ok(())
    }

    fn unload(&mut self, id: CommandId) -> Result<(), Refused> {
        let command = self.core.remove(id)?;
        self.bury(id, command);
        Ok(())
    }

    fn bury(&mut self, id: CommandId, command: Box<Command>) {
        let subscription = self.subscriptions.get_mut(id.place());
        if let Some(old) = subscription.and_then(|s| s.take_if(|s| s.command == id)) {
            self.ends.bury(Dead::Subscription(old));
        }
        let board = self.boards.get_mut(id.place());
        if let Some((_, old)) = board.and_then(|b| b.take_if(|b| b.0 == id)) {
            self.ends.bury(Dead::Board(old));
        }
        self.ends.bury(Dead::Command(id, command));
    }

    /// Sets all inputs, or none if a command is unknown.
    fn set(&mut self, settings: Box<[super::Setting]>) -> Result<(), Refused> {
        let known = settings
            .iter()
            .all(|s| self.core.command(s.command).is_some());
        for setting in settings.iter().filter(|_| known) {
            if let Some(command) = self.core.command_mut(setting.command) {
                command.set_input(setting.input, &setting.value);
            }
        }
        self.ends.bury(Dead::Settings(settings));
        match known {
            true => Ok(()),
            false => Err(Refused::Unknown),
        }
    }

    fn subscribe(&mut self, new: Box<Subscription>) -> Result<(), Refused> {
        let known = self.core.command(new.command).is_some();
        let slot = self.subscriptions.get_mut(new.command.place());
        let old = match slot.filter(|_| known) {
            Some(slot) => slot.replace(new),
            None => {
                self.ends.bury(Dead::Subscription(new));
                return Err(Refused::Unknown);
            }
        };
        old.into_iter()
            .for_each(|old| self.ends.bury(Dead::Subscription(old)));
        Ok(())
    }

    fn tell(&mut self) {
        self.tell_notices();
        while let Some((id, gone)) = self.core.take_gone() {
            self.bury(id, gone);
        }
        while let Some((_, rule)) = self.core.take_spent() {
            self.ends.bury(Dead::Rule(rule));
        }
        self.ends.send_dead();
        let tick = self.core.now().saturating_sub(1);
        let (told, events) = (&mut self.told, &mut self.ends.events);
        self.plant.conditions(&mut |device, code, moving| {
            let Some(last) = told.get_mut(device) else {
                return;
            };
            let event = Event::Device {
                device,
                code,
                moving,
                tick,
            };
            if *last != (code, moving) && events.push(event).is_ok() {
                *last = (code, moving);
            }
        });
    }

    /// Sends notices to the host. Notices that do not fit into the queue stay in the log of the core and are sent
    /// later.
    fn tell_notices(&mut self) {
        while !self.ends.events.is_full() {
            let Some(notice) = self.core.next_notice() else {
                return;
            };
            let _ = self.ends.events.push(Event::Notice(notice));
        }
    }
}

/// Updates subscriptions and boards at the end of each cycle and forwards the notification to another observer.
struct Watching<'a> {
    tick: u64,
    subscriptions: &'a mut [Option<Box<Subscription>>],
    boards: &'a [Option<(CommandId, Arc<Board>)>],
    samples: &'a mut rtrb::Producer<u64>,
    stopwatch: &'a mut Stopwatch,
    further: &'a mut dyn Watch,
}

impl Watch for Watching<'_> {
    fn cycle(&mut self, id: CommandId, command: &Command) {
        let subscription = self.subscriptions.get_mut(id.place());
        let subscription = subscription.and_then(Option::as_mut);
        if let Some(own) = subscription.filter(|s| s.command == id) {
            own.look(command, self.tick, self.samples);
        }
        let board = self.boards.get(id.place()).and_then(Option::as_ref);
        if let Some((_, board)) = board.filter(|b| b.0 == id) {
            board.write(command);
        }
        self.further.cycle(id, command);
    }

    fn turn(&mut self, next: Option<CommandId>) {
        self.stopwatch.turn(next);
        self.further.turn(next);
    }
}
