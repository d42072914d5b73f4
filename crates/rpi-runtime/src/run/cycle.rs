//! Cycle side of a run: executes tick after tick.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rpi_core::{Command, CommandId, Overruns, Watch, Why};
use rpi_device::PortId;
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_sim::SimBank;

use super::devices;
use super::samples::Tap;
use super::sights::Sights;
use crate::control::Executive;
use crate::realtime::Beat;
use crate::tape::{TapeIn, Taped};

/// Maximum time in seconds for the devices to come to rest after the last command.
const SETTLE: f64 = 10.0;

/// Maximum number of commands whose overruns are recorded.
const BLAMED: usize = 64;

/// Stop conditions of a run, and its tick length.
#[derive(Clone, Debug)]
pub(super) struct Bounds {
    /// Tick at which the running commands are stopped.
    pub(super) last: u64,
    /// Set to true to stop the run now.
    pub(super) interrupted: Arc<AtomicBool>,
    /// Set to true for an emergency stop.
    pub(super) emergency: Arc<AtomicBool>,
    /// Tick length in nanoseconds.
    pub(super) tick_ns: u64,
}

impl Bounds {
    /// Returns the reason to end all commands now, if a stop condition is met.
    fn reached(&self, now: u64) -> Option<Why> {
        let asked = || now >= self.last || self.interrupted.load(Ordering::Relaxed);
        match self.emergency.load(Ordering::Relaxed) {
            true => Some(Why::EmergencyStop),
            false => asked().then_some(Why::Request),
        }
    }
}

/// The cycle and all data that it owns.
pub(super) struct Cycle {
    executive: Executive<Taped<SimBank>>,
    pub(super) beat: Beat,
    pub(super) watcher: Watcher,
    devices: Box<[DeviceTap]>,
    /// Number of the next tick, read by the host.
    now: Arc<AtomicU64>,
    bounds: Bounds,
    /// Tick at which the run ends even if the devices still move; set once all commands have ended.
    settling: Option<u64>,
    /// Reason for which all commands were ended early. [`Why::Request`] if the run was cut off.
    pub(super) halted: Option<Why>,
    /// Tape of the recording, if any.
    tape: Option<TapeIn>,
    /// Overrun statistics of the first commands with overruns.
    pub(super) overran: Vec<(CommandId, Overruns)>,
}

/// A device port that is sampled in every tick.
pub(super) struct DeviceTap {
    pub(super) port: PortId,
    pub(super) channel: usize,
    /// Buffer for the value.
    pub(super) value: Box<[u64]>,
}

impl Cycle {
    pub(super) fn new(
        executive: Executive<Taped<SimBank>>,
        beat: Beat,
        watcher: Watcher,
        devices: Box<[DeviceTap]>,
        now: Arc<AtomicU64>,
        bounds: Bounds,
        tape: Option<TapeIn>,
    ) -> Cycle {
        Cycle {
            executive,
            beat,
            watcher,
            devices,
            now,
            bounds,
            settling: None,
            halted: None,
            tape,
            overran: Vec::with_capacity(BLAMED),
        }
    }

    /// Executes one tick.
    pub(super) fn tick(&mut self) {
        let now = self.executive.now();
        let wall_ns = self.beat.wait(now);
        self.watcher.begin(now);
        match self.halted {
            Some(_) => self.executive.tick_alone(wall_ns, &mut self.watcher),
            None => self.executive.tick(wall_ns, &mut self.watcher),
        }
        if self.settling.is_none() {
            let too_often = self.beat.over(now);
            let late = self.beat.overrun();
            if too_often | late.is_some_and(|late| self.too_late(late)) {
                self.halt(Why::Overrun);
            }
        }
        self.sample(now);
        self.record((now, wall_ns), true);
        self.now.store(self.executive.now(), Ordering::Release);
    }

    /// Handles an overrun; see [`Executive::too_late`]. Returns true if all commands must be ended.
    fn too_late(&mut self, (late_ns, excess_ns): (u64, u64)) -> bool {
        if let Some(sights) = &mut self.watcher.sights {
            sights.overrun(late_ns);
        }
        let stop = self.executive.too_late((late_ns, excess_ns));
        let blamed = self.executive.blamed(excess_ns);
        let command = blamed.and_then(|(id, _)| Some((id, self.executive.core().command(id)?)));
        let Some((id, command)) = command else {
            return stop;
        };
        let overruns = *command.overruns();
        let has_room = self.overran.len() < BLAMED;
        match self.overran.iter_mut().find(|(known, _)| *known == id) {
            Some((_, known)) => *known = overruns,
            None if has_room => self.overran.push((id, overruns)),
            None => {}
        }
        stop
    }

    /// Returns true if another tick is needed: commands run, or devices have not yet come to rest. `over` states that
    /// no further command will start.
    pub(super) fn goes_on(&mut self, over: bool) -> bool {
        let now = self.executive.now();
        if self.settling.is_none()
            && self.halted.is_none()
            && let Some(why) = self.bounds.reached(now)
        {
            self.halt(why);
        }
        if self.settling.is_none() && (over || self.halted.is_some()) {
            let ticks = (SETTLE * 1e9 / self.bounds.tick_ns as f64) as u64;
            self.settling = Some(now + ticks);
        }
        self.settling
            .is_none_or(|until| now < until && self.moves())
    }

    /// Ends all commands between two ticks.
    fn halt(&mut self, why: Why) {
        self.halted = Some(why);
        self.executive.plant().halt(why);
        self.executive.halt(why);
    }

    /// Records everything since the last recorded tick.
    fn record(&mut self, moment: (u64, i64), ticked: bool) {
        let (Some(tape), Some(sights)) = (&mut self.tape, &self.watcher.sights) else {
            return;
        };
        if let Some(exchange) = self.executive.plant().stage() {
            tape.put(moment, ticked, exchange, sights.stage());
            exchange.clear();
        }
    }

    /// Records everything after the last tick. Returns the number of lost ticks.
    pub(super) fn finish_tape(&mut self) -> u64 {
        let now = self.executive.now();
        let stage = self.executive.plant().stage();
        if stage.is_some_and(|stage| !stage.is_empty()) {
            self.watcher.begin(now);
            self.record((now, 0), false);
        }
        self.tape.as_ref().map_or(0, TapeIn::lost)
    }

    /// Returns true while the tape has enough room for the next ticks.
    pub(super) fn has_room(&self) -> bool {
        self.tape.as_ref().is_none_or(TapeIn::has_room)
    }

    /// Returns the devices.
    pub(super) fn bank(&mut self) -> &mut SimBank {
        self.executive.plant().plant()
    }

    /// Samples the devices after their step.
    fn sample(&mut self, tick: u64) {
        let (bank, watcher) = (self.executive.plant().plant(), &mut self.watcher);
        for tap in &mut self.devices {
            devices::sample(tap, bank, |channel, value| {
                watcher.tap.put(channel, tick, value);
                if let Some(sights) = &mut watcher.sights {
                    sights.sample(channel, value);
                }
            });
        }
    }

    fn moves(&mut self) -> bool {
        self.bank().status().any(|device| device.moving)
    }
}

/// Samples the flows of commands at the end of their cycles.
pub(super) struct Watcher {
    pub(super) tap: Tap,
    pub(super) tick: u64,
    pub(super) flows: Box<[Flows]>,
    /// Observations for the recording, if any.
    pub(super) sights: Option<Sights>,
}

impl Watcher {
    fn begin(&mut self, tick: u64) {
        self.tick = tick;
        self.sights.iter_mut().for_each(Sights::begin);
    }
}

/// Sampled flows of an image.
pub(super) struct Flows {
    pub(super) image: Arc<Image>,
    /// Channel, signal, and the index of the signal's fragment.
    pub(super) flows: Box<[(usize, Signal, u32)]>,
}

impl Watch for Watcher {
    fn cycle(&mut self, id: CommandId, command: &Command) {
        if let Some(sights) = &mut self.sights {
            sights.cycle(id, command);
        }
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
