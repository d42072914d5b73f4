//! Cycle side of the control core: takes requests, ticks the core, steps the devices and sends events.

use std::sync::Arc;

use rpi_core::{Command, CommandError, CommandId, Core, CycleObserver};

use super::event::Event;
use super::export_snapshot::ExportSnapshot;
use super::plant::{AttributedOverrun, Plant};
use super::queue::{CycleQueues, Options, Released, Request};
use super::subscription::Subscription;
use crate::realtime::CommandTimer;

/// Cycle side of a control core, with the devices that it moves. One thread calls its ticks.
pub struct Executive<P: Plant> {
    core: Core,
    plant: P,
    queues: CycleQueues<P::Device>,
    /// Subscription of each command to its exports, indexed by command slot; `None` without a subscription.
    subscriptions: Box<[Option<Box<Subscription>>]>,
    /// Snapshot of each command's exports, indexed by command slot.
    snapshots: Snapshots,
    /// For each device, by index, the error code and whether the device moves, as last reported to the host.
    reported: Vec<(i64, bool)>,
    per_tick: usize,
    stopwatch: CommandTimer,
}

/// State of a core between two ticks, from which a replay can go on.
pub struct Checkpoint {
    core: Core,
    /// For each device, by index, the error code and whether the device moves, as last reported to the host.
    reported: Vec<(i64, bool)>,
}

impl Checkpoint {
    /// Returns the number of the next tick.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.core.now()
    }

    /// Returns the memory of the commands in the checkpoint, in bytes, without their images.
    #[must_use]
    pub fn memory(&self) -> usize {
        let commands = self.core.commands();
        commands
            .map(|(_, command)| command.instance().memory())
            .sum()
    }
}

/// For each command slot, the id of the command and the snapshot to which its exports are written after each cycle;
/// `None` if the command has no snapshot.
type Snapshots = Box<[Option<(CommandId, Arc<ExportSnapshot>)>]>;

/// Effort per tick after which no further request is taken, in units of about ten nanoseconds. At least one request of
/// any size is taken per tick.
const MAX_EFFORT_PER_TICK: usize = 8192;

/// Maximum number of devices whose state changes are reported to the host; devices with higher indices are not
/// reported.
const MAX_DEVICES: usize = 256;

impl<P: Plant> Executive<P> {
    pub(super) fn new(plant: P, ends: CycleQueues<P::Device>, options: Options) -> Self {
        Executive {
            core: Core::with_capacity(options.commands, options.tick_ns),
            plant,
            queues: ends,
            subscriptions: (0..options.commands).map(|_| None).collect(),
            snapshots: (0..options.commands).map(|_| None).collect(),
            reported: vec![(0, false); MAX_DEVICES],
            per_tick: options.requests_per_tick.max(1),
            stopwatch: CommandTimer::new(options.measure_commands),
        }
    }

    /// Returns the number of the next tick.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.core.now()
    }

    /// Executes one tick: carries out requests, runs the cycles of the commands, advances the devices and sends events.
    ///
    /// `wall_ns` is the wall clock in nanoseconds since the Unix epoch. `watch` observes every command at the end of
    /// its cycle.
    pub fn tick(&mut self, wall_ns: i64, watch: &mut dyn CycleObserver) {
        self.take_requests();
        self.tick_without_requests(wall_ns, watch);
    }

    /// Executes one tick without carrying out requests. Used after all commands were stopped, so that pending requests
    /// start nothing.
    pub fn tick_without_requests(&mut self, wall_ns: i64, watch: &mut dyn CycleObserver) {
        self.stopwatch.reset();
        let mut watch = CycleObservers {
            stopwatch: &mut self.stopwatch,
            tick: self.core.now(),
            subscriptions: &mut self.subscriptions,
            snapshots: &self.snapshots,
            samples: &mut self.queues.samples,
            further: watch,
        };
        self.core.tick(&mut self.plant, wall_ns, &mut watch);
        self.plant.step();
        self.send_events();
    }

    /// Returns the device bank, for access between ticks.
    pub fn plant(&mut self) -> &mut P {
        &mut self.plant
    }

    /// Returns a copy of the state of the core between two ticks, for [`Executive::restore`]. Allocates.
    #[must_use]
    pub fn checkpoint(&self) -> Checkpoint {
        Checkpoint {
            core: self.core.clone(),
            reported: self.reported.clone(),
        }
    }

    /// Returns to the state of a checkpoint. Subscriptions end, and what the devices of the plant do is not changed: the
    /// caller brings them to the same tick.
    pub fn restore(&mut self, checkpoint: &Checkpoint) {
        self.core.clone_from(&checkpoint.core);
        self.reported.clone_from(&checkpoint.reported);
        self.subscriptions.iter_mut().for_each(|slot| *slot = None);
    }

    /// Returns the core, for inspection between ticks.
    #[must_use]
    pub fn core(&self) -> &Core {
        &self.core
    }

    /// Handles a tick that ended `late_ns` after the next one was due and took `excess_ns` longer than a period.
    ///
    /// The overrun is attributed to the slowest command, unless the tick would have been too long without it. The
    /// overrun policy of that command may end it. Returns true if all commands must be aborted.
    pub fn handle_overrun(&mut self, (late_ns, excess_ns): (u64, u64)) -> bool {
        let Some((id, took_ns)) = self.overrun_cause(excess_ns) else {
            return false;
        };
        let Some(command) = self.core.command(id) else {
            return false;
        };
        let late = AttributedOverrun {
            command: id,
            took_ns,
            late_ns,
            fragment: command.instance().heaviest_active_fragment(),
        };
        self.plant.on_overrun(&late);
        self.attribute_overrun(&late)
    }

    /// Attributes an overrun to a command, as `late` says. The overrun was measured by [`Executive::handle_overrun`] or
    /// is replayed from a tick log. Returns true if the overrun policy of the command requires all commands to be
    /// aborted.
    pub fn attribute_overrun(&mut self, late: &AttributedOverrun) -> bool {
        let (id, times) = (late.command, (late.took_ns, late.late_ns));
        let stop = self.core.report_overrun(id, times, &mut self.plant);
        let snapshot = self.snapshots.get(id.slot()).and_then(Option::as_ref);
        if let (Some((_, snapshot)), Some(command)) =
            (snapshot.filter(|b| b.0 == id), self.core.command(id))
        {
            snapshot.write_overruns(command.overrun_stats());
        }
        self.send_notices();
        stop
    }

    /// Returns the id of the command to which an overrun is attributed, with the command's time in nanoseconds.
    /// `excess_ns` is the time by which the tick took longer than its period.
    ///
    /// The command is the slowest of the latest tick. The result is `None` if nothing was measured, or if the tick
    /// would have exceeded its period even without that command.
    #[must_use]
    pub fn overrun_cause(&self, excess_ns: u64) -> Option<(CommandId, u64)> {
        let longest = self.stopwatch.longest();
        longest.filter(|(_, took)| excess_ns > 0 && *took >= excess_ns)
    }

    /// Aborts all commands between two ticks for the reason `why`, and drops all rules.
    pub fn halt(&mut self, why: rpi_core::AbortReason) {
        self.core.abort_all(why, &mut self.plant);
        self.send_events();
    }

    fn take_requests(&mut self) {
        let mut effort = 0;
        for _ in 0..self.per_tick {
            if !self.queues.has_room() || effort >= MAX_EFFORT_PER_TICK {
                return;
            }
            let Ok((ticket, request)) = self.queues.requests.pop() else {
                return;
            };
            effort += request.effort(self.core.rules_cost());
            let tick = self.core.now();
            let refused = self.execute(request).err();
            // `has_room` was checked above.
            let _ = self.queues.events.push(Event::Answer {
                ticket,
                tick,
                refused,
            });
            self.send_notices();
            self.queues.send_released();
        }
    }

    fn execute(&mut self, request: Request<P::Device>) -> Result<(), CommandError> {
        let (core, plant) = (&mut self.core, &mut self.plant);
        match request {
            Request::Insert(id, command, snapshot) => self.insert(id, command, snapshot),
            Request::Start(id) => core.start(id, plant),
            Request::Unschedule(id) => core.unschedule(id),
            Request::Cancel(id) => core.cancel(id),
            Request::Abort(id, why) => core.abort(id, why, plant),
            Request::Unload(id) => self.unload(id),
            Request::Schedule(id, rule) => {
                core.schedule_with_id(id, rule, plant)
                    .map_err(|(rule, why)| {
                        self.queues.release(Released::Rule(rule));
                        why
                    })
            }
            Request::Withdraw(id) => core.withdraw_rule(id),
            Request::Set(settings) => self.set(settings),
            Request::Subscribe(subscription) => self.subscribe(subscription),
            Request::Device(place, part) => {
                let old = plant.swap(place, part);
                old.into_iter()
                    .for_each(|old| self.queues.release(Released::Device(old)));
                Ok(())
            }
            Request::SetControls(controls) => {
                core.set_controls(controls);
                Ok(())
            }
            Request::MakeSafe(resources) => {
                core.make_safe(&resources, plant);
                self.queues.release(Released::Resources(resources));
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
        snapshot: Option<Arc<ExportSnapshot>>,
    ) -> Result<(), CommandError> {
        let inserted = self.core.insert_with_id(id, command);
        let slot = self.snapshots.get_mut(id.slot());
        match (inserted, slot) {
            (Ok(()), Some(slot)) => *slot = snapshot.map(|snapshot| (id, snapshot)),
            (Ok(()), None) => {}
            (Err((command, why)), _) => {
                snapshot
                    .into_iter()
                    .for_each(|b| self.queues.release(Released::Snapshot(b)));
                self.queues.release(Released::Command(id, command));
                return Err(why);
            }
        }
        Ok(())
    }

    fn unload(&mut self, id: CommandId) -> Result<(), CommandError> {
        let command = self.core.remove(id)?;
        self.release_command(id, command);
        Ok(())
    }

    fn release_command(&mut self, id: CommandId, command: Box<Command>) {
        let subscription = self.subscriptions.get_mut(id.slot());
        if let Some(old) = subscription.and_then(|s| s.take_if(|s| s.command == id)) {
            self.queues.release(Released::Subscription(old));
        }
        let snapshot = self.snapshots.get_mut(id.slot());
        if let Some((_, old)) = snapshot.and_then(|b| b.take_if(|b| b.0 == id)) {
            self.queues.release(Released::Snapshot(old));
        }
        self.queues.release(Released::Command(id, command));
    }

    /// Sets all given inputs of commands, or none of them if one of the commands is unknown.
    fn set(&mut self, settings: Box<[super::InputValue]>) -> Result<(), CommandError> {
        let known = settings
            .iter()
            .all(|s| self.core.command(s.command).is_some());
        for setting in settings.iter().filter(|_| known) {
            if let Some(command) = self.core.command_mut(setting.command) {
                command.set_input(setting.input, &setting.value);
            }
        }
        self.queues.release(Released::Settings(settings));
        match known {
            true => Ok(()),
            false => Err(CommandError::Unknown),
        }
    }

    fn subscribe(&mut self, new: Box<Subscription>) -> Result<(), CommandError> {
        let known = self.core.command(new.command).is_some();
        let slot = self.subscriptions.get_mut(new.command.slot());
        let old = match slot.filter(|_| known) {
            Some(slot) => slot.replace(new),
            None => {
                self.queues.release(Released::Subscription(new));
                return Err(CommandError::Unknown);
            }
        };
        old.into_iter()
            .for_each(|old| self.queues.release(Released::Subscription(old)));
        Ok(())
    }

    fn send_events(&mut self) {
        self.send_notices();
        while let Some((id, gone)) = self.core.take_orphan() {
            self.release_command(id, gone);
        }
        while let Some((_, rule)) = self.core.take_finished_rule() {
            self.queues.release(Released::Rule(rule));
        }
        self.queues.send_released();
        let tick = self.core.now().saturating_sub(1);
        let (reported, events) = (&mut self.reported, &mut self.queues.events);
        self.plant.device_states(&mut |device, code, moving| {
            let Some(last) = reported.get_mut(device) else {
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

    /// Sends the notices of the core (events of commands and rules) to the host. Notices for which the queue has no
    /// room stay in the core and are sent later.
    fn send_notices(&mut self) {
        while !self.queues.events.is_full() {
            let Some(notice) = self.core.next_notice() else {
                return;
            };
            let _ = self.queues.events.push(Event::Notice(notice));
        }
    }
}

/// Observer of cycles that updates subscriptions and snapshots at the end of each cycle and forwards the notification
/// to another observer.
struct CycleObservers<'a> {
    tick: u64,
    subscriptions: &'a mut [Option<Box<Subscription>>],
    snapshots: &'a [Option<(CommandId, Arc<ExportSnapshot>)>],
    samples: &'a mut rtrb::Producer<u64>,
    stopwatch: &'a mut CommandTimer,
    further: &'a mut dyn CycleObserver,
}

impl CycleObserver for CycleObservers<'_> {
    fn cycle_finished(&mut self, id: CommandId, command: &Command) {
        let subscription = self.subscriptions.get_mut(id.slot());
        let subscription = subscription.and_then(Option::as_mut);
        if let Some(own) = subscription.filter(|s| s.command == id) {
            own.send_changes(command, self.tick, self.samples);
        }
        let snapshot = self.snapshots.get(id.slot()).and_then(Option::as_ref);
        if let Some((_, snapshot)) = snapshot.filter(|b| b.0 == id) {
            snapshot.write(command);
        }
        self.further.cycle_finished(id, command);
    }

    fn evaluation_starts(&mut self, next: Option<CommandId>) {
        self.stopwatch.switch_to(next);
        self.further.evaluation_starts(next);
    }

    fn evaluated(&mut self, id: CommandId, command: &Command) {
        self.further.evaluated(id, command);
    }
}
