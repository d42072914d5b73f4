//! Cycle side of a run: executes tick after tick.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rpi_core::{AbortReason, Command, CommandId, CycleObserver, OverrunStats};
use rpi_device::{DeviceBank, PortId};
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_sim::SimBank;

use super::devices;
use super::probe::FlowProbe;
use super::samples::SampleSender;
use crate::control::Executive;
use crate::realtime::TickTimer;
use crate::tick_log::{LoggingBank, TickLogWriter};

/// Maximum time in seconds that a run waits for the devices to come to rest after its last command.
const SETTLE_SECONDS: f64 = 10.0;

/// Maximum number of commands whose overruns are recorded.
const MAX_OVERRUN_COMMANDS: usize = 64;

/// Conditions under which the commands of a run are aborted, and the tick length.
#[derive(Clone, Debug)]
pub(super) struct StopConditions {
    /// Number of the tick in which the commands that still run are aborted.
    pub(super) last_tick: u64,
    /// Flag that stops the run as soon as it is set to true.
    pub(super) interrupted: Arc<AtomicBool>,
    /// Flag that causes an emergency stop as soon as it is set to true.
    pub(super) emergency: Arc<AtomicBool>,
    /// Tick length in nanoseconds.
    pub(super) tick_ns: u64,
}

impl StopConditions {
    /// Returns the reason for which all commands must be aborted in the tick `now`; `None` if no condition is met.
    fn stop_reason(&self, now: u64) -> Option<AbortReason> {
        let is_cut_off = || now >= self.last_tick || self.interrupted.load(Ordering::Relaxed);
        // The emergency stop comes first: it is the reason to report if the run was interrupted at the same time.
        match self.emergency.load(Ordering::Relaxed) {
            true => Some(AbortReason::EmergencyStop),
            false => is_cut_off().then_some(AbortReason::Request),
        }
    }
}

/// Loop of the control cycle in a run, with all data that it owns: the core, the devices, the clock and the tick log.
pub(super) struct CycleLoop {
    executive: Executive<LoggingBank<SimBank>>,
    pub(super) timer: TickTimer,
    pub(super) watcher: FlowSampler,
    devices: Box<[DeviceTap]>,
    /// Number of the next tick, shared with the thread outside the cycle.
    now: Arc<AtomicU64>,
    bounds: StopConditions,
    /// Number of the tick in which the run ends even if the devices still move; `None` until all commands have ended.
    settling: Option<u64>,
    /// Reason for which all commands were aborted; `None` if they were not. [`AbortReason::Request`] means that the run
    /// reached its limit or was interrupted by the user.
    pub(super) halted: Option<AbortReason>,
    /// End of the tick log to which each tick is written; `None` if the run is not recorded.
    tick_log: Option<TickLogWriter>,
    /// Overrun statistics of the commands with overruns, at most [`MAX_OVERRUN_COMMANDS`] of them.
    pub(super) overruns: Vec<(CommandId, OverrunStats)>,
}

/// A device port whose value is sampled in every tick.
pub(super) struct DeviceTap {
    pub(super) port: PortId,
    pub(super) channel: usize,
    /// Buffer for the memory words of the latest value of the port.
    pub(super) value: Box<[u64]>,
}

impl CycleLoop {
    pub(super) fn new(
        executive: Executive<LoggingBank<SimBank>>,
        timer: TickTimer,
        watcher: FlowSampler,
        devices: Box<[DeviceTap]>,
        now: Arc<AtomicU64>,
        bounds: StopConditions,
        tick_log: Option<TickLogWriter>,
    ) -> CycleLoop {
        CycleLoop {
            executive,
            timer,
            watcher,
            devices,
            now,
            bounds,
            settling: None,
            halted: None,
            tick_log,
            overruns: Vec::with_capacity(MAX_OVERRUN_COMMANDS),
        }
    }

    /// Waits for the next tick, executes it, and records it.
    pub(super) fn tick(&mut self) {
        let now = self.executive.now();
        let wall_ns = self.timer.wait(now);
        self.watcher.begin(now);
        match self.halted {
            Some(_) => self
                .executive
                .tick_without_requests(wall_ns, &mut self.watcher),
            None => self.executive.tick(wall_ns, &mut self.watcher),
        }
        if self.settling.is_none() {
            let too_often = self.timer.finish_tick(now);
            let late = self.timer.overrun();
            // `|` instead of `||`: the overrun must be attributed to its command in any case.
            if too_often | late.is_some_and(|late| self.handle_overrun(late)) {
                self.halt(AbortReason::Overrun);
            }
        }
        self.sample(now);
        self.record((now, wall_ns), true);
        self.now.store(self.executive.now(), Ordering::Release);
    }

    /// Handles a tick that ended `late_ns` after the next one was due and took `excess_ns` longer than a period, as
    /// [`Executive::handle_overrun`] does, and stores the statistics of the responsible command. Returns true if all
    /// commands must be aborted.
    fn handle_overrun(&mut self, (late_ns, excess_ns): (u64, u64)) -> bool {
        if let Some(probe) = &mut self.watcher.probe {
            probe.overrun(late_ns);
        }
        let stop = self.executive.handle_overrun((late_ns, excess_ns));
        let blamed = self.executive.overrun_cause(excess_ns);
        let command = blamed.and_then(|(id, _)| Some((id, self.executive.core().command(id)?)));
        let Some((id, command)) = command else {
            return stop;
        };
        let overruns = *command.overrun_stats();
        let has_room = self.overruns.len() < MAX_OVERRUN_COMMANDS;
        match self.overruns.iter_mut().find(|(known, _)| *known == id) {
            Some((_, known)) => *known = overruns,
            None if has_room => self.overruns.push((id, overruns)),
            None => {}
        }
        stop
    }

    /// Returns true if another tick is needed: commands run, or devices have not yet come to rest. `over` is true if no
    /// further command will start.
    pub(super) fn should_continue(&mut self, over: bool) -> bool {
        let now = self.executive.now();
        if self.settling.is_none()
            && self.halted.is_none()
            && let Some(why) = self.bounds.stop_reason(now)
        {
            self.halt(why);
        }
        if self.settling.is_none() && (over || self.halted.is_some()) {
            let ticks = (SETTLE_SECONDS * 1e9 / self.bounds.tick_ns as f64) as u64;
            self.settling = Some(now + ticks);
            if self.bank().make_all_safe() {
                return true;
            }
        }
        self.settling
            .is_none_or(|until| now < until && self.is_moving())
    }

    /// Aborts all commands between two ticks for the reason `why`.
    fn halt(&mut self, why: AbortReason) {
        self.halted = Some(why);
        self.executive.plant().log_halt(why);
        self.executive.halt(why);
    }

    /// Writes everything since the last recorded tick to the tick log. `context` is the number of the tick and its wall
    /// clock in nanoseconds since the Unix epoch; `ticked` is false for data after the last tick.
    fn record(&mut self, context: (u64, i64), ticked: bool) {
        let (Some(tick_log), Some(probe)) = (&mut self.tick_log, &self.watcher.probe) else {
            return;
        };
        if let Some(exchange) = self.executive.plant().buffer() {
            tick_log.put(context, ticked, exchange, probe.stage());
            exchange.clear();
        }
    }

    /// Writes everything since the last tick to the tick log, at the end of the run. Returns the number of ticks that
    /// are missing from the log.
    pub(super) fn finish_tick_log(&mut self) -> u64 {
        let now = self.executive.now();
        let stage = self.executive.plant().buffer();
        if stage.is_some_and(|stage| !stage.is_empty()) {
            self.watcher.begin(now);
            self.record((now, 0), false);
        }
        self.tick_log.as_ref().map_or(0, TickLogWriter::lost)
    }

    /// Returns true while the tick log has enough room for the next ticks, or if the run is not recorded.
    pub(super) fn has_room(&self) -> bool {
        self.tick_log.as_ref().is_none_or(TickLogWriter::has_room)
    }

    /// Returns the device bank of the run, for access between ticks.
    pub(super) fn bank(&mut self) -> &mut SimBank {
        self.executive.plant().plant()
    }

    /// Samples the ports of the devices after the devices have advanced by the tick with this number.
    fn sample(&mut self, tick: u64) {
        let (bank, watcher) = (self.executive.plant().plant(), &mut self.watcher);
        for tap in &mut self.devices {
            devices::sample(tap, bank, |channel, value| {
                watcher.tap.put(channel, tick, value);
                if let Some(probe) = &mut watcher.probe {
                    probe.sample(channel, value);
                }
            });
        }
    }

    fn is_moving(&mut self) -> bool {
        self.bank().status().any(|device| device.moving)
    }
}

/// Sampler that reads the flows of commands at the end of their cycles and sends them to the host.
pub(super) struct FlowSampler {
    pub(super) tap: SampleSender,
    pub(super) tick: u64,
    pub(super) flows: Box<[SampledFlows]>,
    /// Probe that also writes the flows to the tick log; `None` if the run is not recorded.
    pub(super) probe: Option<FlowProbe>,
}

impl FlowSampler {
    fn begin(&mut self, tick: u64) {
        self.tick = tick;
        self.probe.iter_mut().for_each(FlowProbe::begin);
    }
}

/// Flows of an image that are sampled in every cycle.
pub(super) struct SampledFlows {
    pub(super) image: Arc<Image>,
    /// For each sampled flow: index of its channel, its place and type in memory, and the index of its fragment.
    pub(super) flows: Box<[(usize, Signal, u32)]>,
}

impl CycleObserver for FlowSampler {
    fn cycle_finished(&mut self, id: CommandId, command: &Command) {
        if let Some(probe) = &mut self.probe {
            probe.cycle_finished(id, command);
        }
        let machine = command.instance();
        let mine = |f: &&SampledFlows| Arc::ptr_eq(&f.image, machine.image());
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
