//! The cycle's side of a run: one tick after the other.

use std::sync::Arc;
use std::time::Instant;

use rpi_core::{Command, CommandId, Core, Rule, State, Watch, Why};
use rpi_device::{DeviceBank, PortId};
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_sim::SimBank;

use super::clock::Clock;
use super::figures::Meter;
use super::links::{CycleEnds, Event, Ready};
use super::samples::Tap;

/// After the last command the devices get this long to come to rest, seconds.
const SETTLE: f64 = 10.0;

/// When a run is cut off, and how it is slowed down; in ticks, and how long these are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    /// Ticks after which the running command is stopped.
    pub(super) last: u64,
    /// Ticks that pass after a command's start before its successor is scheduled.
    pub(super) planning: u64,
    /// Length of a tick, nanoseconds.
    pub(super) tick_ns: u64,
}

/// The cycle and everything that it owns.
pub(super) struct Cycle {
    core: Core,
    pub(super) bank: SimBank,
    clock: Clock,
    pub(super) meter: Meter,
    ends: CycleEnds,
    pub(super) watcher: Watcher,
    devices: Box<[DeviceTap]>,
    bounds: Bounds,
    /// Ticks that the devices get to come to rest.
    settling: u64,
    running: Option<Slot>,
    next: Option<Slot>,
    /// Tick of the running command's first cycle.
    since: u64,
    phase: Phase,
    /// True once the run was cut off.
    pub(super) cut_off: bool,
}

#[derive(Clone, Copy)]
struct Slot {
    id: CommandId,
    serial: u64,
}

#[derive(Clone, Copy, PartialEq)]
enum Phase {
    Running,
    /// Nothing runs any more; devices come to rest, until this tick at most.
    Settling(u64),
    Over,
}

/// A device port that is sampled in every tick.
pub(super) struct DeviceTap {
    pub(super) port: PortId,
    pub(super) channel: usize,
    /// Room for its value.
    pub(super) value: Box<[u64]>,
}

impl Cycle {
    pub(super) fn new(
        bank: SimBank,
        (clock, meter): (Clock, Meter),
        ends: CycleEnds,
        watcher: Watcher,
        devices: Box<[DeviceTap]>,
        bounds: Bounds,
    ) -> Cycle {
        Cycle {
            // One runs, one is scheduled, and a gone one may not have been taken out yet.
            core: Core::with_capacity(4, bounds.tick_ns),
            bank,
            clock,
            meter,
            ends,
            watcher,
            devices,
            bounds,
            settling: (SETTLE * 1e9 / bounds.tick_ns as f64) as u64,
            running: None,
            next: None,
            since: 0,
            phase: Phase::Running,
            cut_off: false,
        }
    }

    /// One tick. False once the run is over.
    pub(super) fn tick(&mut self) -> bool {
        self.accept();
        let now = self.core.now();
        let late = self.clock.wait(now);
        let begin = Instant::now();
        self.watcher.tick = now;
        let wall_ns = self.clock.wall_ns(now);
        self.core.tick(&mut self.bank, wall_ns, &mut self.watcher);
        let took = u64::try_from(begin.elapsed().as_nanos()).unwrap_or(u64::MAX);
        if self.phase == Phase::Running {
            self.meter.record(took, late);
        }
        self.bank.step();
        self.sample(now);
        self.follow(now);
        self.phase = self.next_phase();
        self.phase != Phase::Over
    }

    /// Takes a loaded command in as soon as there is a use for it.
    fn accept(&mut self) {
        let planned = self.core.now() >= self.since + self.bounds.planning;
        let wanted = match (self.running, self.next) {
            (None, _) => true,
            (Some(_), None) => planned,
            (Some(_), Some(_)) => false,
        };
        if !wanted || self.phase != Phase::Running {
            return;
        }
        if let Ok(ready) = self.ends.ready.pop() {
            self.take_in(ready);
        }
    }

    fn take_in(&mut self, Ready { serial, command }: Ready) {
        let id = match self.core.insert(command) {
            Ok(id) => id,
            Err((command, why)) => {
                self.ends.bury(command);
                self.ends.tell(Event::Refused { serial, why });
                return;
            }
        };
        let slot = Slot { id, serial };
        let done = match self.running {
            None => self.core.start(id, &mut self.bank),
            Some(before) => {
                let rule = Box::new(Rule::follow(before.id).start(id));
                let made = self.core.schedule(rule, &mut self.bank);
                made.map(|_| ()).map_err(|refused| refused.1)
            }
        };
        match (done, self.running) {
            (Ok(()), None) => self.begin(slot),
            (Ok(()), Some(_)) => self.next = Some(slot),
            (Err(why), _) => {
                self.bury(id);
                self.ends.tell(Event::Refused { serial, why });
            }
        }
    }

    fn begin(&mut self, slot: Slot) {
        let tick = self.core.now();
        (self.running, self.since) = (Some(slot), tick);
        let serial = slot.serial;
        self.ends.tell(Event::Started { serial, tick });
    }

    /// Samples the devices after they have moved.
    fn sample(&mut self, tick: u64) {
        for tap in &mut self.devices {
            let there = self.bank.read(tap.port, &mut tap.value);
            let value = there.then_some(&*tap.value);
            self.watcher.tap.put(tap.channel, tick, value);
        }
    }

    /// Notes that a command has ended and which one follows.
    fn follow(&mut self, tick: u64) {
        let Some(slot) = self.running else {
            return;
        };
        let command = self.core.command(slot.id);
        let Some(ending) = command.and_then(Command::ending).copied() else {
            return;
        };
        let serial = slot.serial;
        self.ends.tell(Event::Ended {
            serial,
            tick,
            ending,
        });
        self.bury(slot.id);
        self.running = None;
        if let Some(next) = self.next.take().filter(|n| self.runs(n.id)) {
            self.begin(next);
        }
        while self.core.take_spent().is_some() {}
        while self.core.next_notice().is_some() {}
        while let Some((_, gone)) = self.core.take_gone() {
            self.ends.bury(gone);
        }
        if !ending.is_regular() {
            self.settle();
        }
    }

    fn next_phase(&mut self) -> Phase {
        let now = self.core.now();
        if self.phase == Phase::Running && now >= self.bounds.last {
            self.cut_off();
        }
        match self.phase {
            Phase::Running if self.running.is_none() && self.ends.is_exhausted() => {
                self.settle();
                self.next_phase()
            }
            Phase::Settling(until) if now >= until || !self.moves() => Phase::Over,
            phase => phase,
        }
    }

    fn cut_off(&mut self) {
        self.cut_off = true;
        for slot in [self.next.take(), self.running].into_iter().flatten() {
            if self
                .core
                .abort(slot.id, Why::Request, &mut self.bank)
                .is_ok()
            {
                self.follow(self.core.now().saturating_sub(1));
            } else {
                self.bury(slot.id);
            }
        }
        self.settle();
    }

    fn settle(&mut self) {
        self.phase = Phase::Settling(self.core.now() + self.settling);
    }

    fn moves(&self) -> bool {
        self.bank.status().any(|device| device.moving)
    }

    fn runs(&self, id: CommandId) -> bool {
        let state = self.core.command(id).map(Command::state);
        state.is_some_and(State::runs)
    }

    fn bury(&mut self, id: CommandId) {
        if let Ok(command) = self.core.remove(id) {
            self.ends.bury(command);
        }
    }
}

/// Samples the flows of commands at the end of their cycles.
pub(super) struct Watcher {
    pub(super) tap: Tap,
    pub(super) tick: u64,
    pub(super) flows: Box<[Flows]>,
}

/// The flows of an image that are sampled.
pub(super) struct Flows {
    pub(super) image: Arc<Image>,
    /// Channel, flow, and the fragment it stands in.
    pub(super) flows: Box<[(usize, Signal, u32)]>,
}

impl Watch for Watcher {
    fn cycle(&mut self, _: CommandId, command: &Command) {
        let machine = command.machine();
        let mine = |f: &&Flows| Arc::ptr_eq(&f.image, machine.image());
        let Some(flows) = self.flows.iter().find(mine) else {
            return;
        };
        for &(channel, signal, fragment) in &flows.flows {
            let value = machine.value(signal);
            let value = value.filter(|_| machine.is_active(fragment));
            self.tap.put(channel, self.tick, value);
        }
    }
}
