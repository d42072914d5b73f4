//! Recording of a core whose commands are not known in advance: the part that runs in the cycle.

use rpi_core::{AbortReason, Command, CommandId, CycleObserver};
use rpi_sim::{Cell, SimBank};

use super::cycle::DeviceTap;
use super::devices::{sample, taps};
use super::probe::FlowProbe;
use super::samples::Channel;
use crate::control::Executive;
use crate::tick_log::{LoggingBank, TickLogReader, TickLogWriter, tick_log};

/// Collector that writes a record of each tick to the tick log, from within the cycle. It never allocates or blocks. A
/// tick that does not fit into the log is dropped and counted.
pub struct TickCollector {
    tick_log: TickLogWriter,
    probe: FlowProbe,
    taps: Box<[DeviceTap]>,
}

impl TickCollector {
    /// Starts logging the devices of an executive. Returns the collector, the end of the tick log from which the
    /// recorder reads, and the device ports that are sampled after each tick.
    pub fn begin(
        cell: &Cell,
        executive: &mut Executive<LoggingBank<SimBank>>,
    ) -> (TickCollector, TickLogReader, Vec<Channel>) {
        let (writer, reader) = tick_log();
        let (taps, channels) = taps(cell, executive.plant().plant());
        executive.plant().start_logging();
        let collector = TickCollector {
            tick_log: writer,
            probe: FlowProbe::new(&[]),
            taps,
        };
        (collector, reader, channels)
    }

    /// Executes one tick of the executive and stores the flows of its commands for the record of the tick. `watch`
    /// observes the tick as well.
    pub fn tick(
        &mut self,
        executive: &mut Executive<LoggingBank<SimBank>>,
        wall_ns: i64,
        watch: &mut dyn CycleObserver,
    ) {
        self.probe.begin();
        let mut both = ObserverPair(&mut self.probe, watch);
        executive.tick(wall_ns, &mut both);
    }

    /// Aborts all commands after a tick for the reason `why`, and records the reason.
    pub fn halt(&mut self, executive: &mut Executive<LoggingBank<SimBank>>, why: AbortReason) {
        executive.plant().log_halt(why);
        executive.halt(why);
    }

    /// Records that the tick ended after the next one was due, then calls [`Executive::handle_overrun`] with the times
    /// `late`. Returns true if all commands must be aborted.
    pub fn handle_overrun(
        &mut self,
        executive: &mut Executive<LoggingBank<SimBank>>,
        late: (u64, u64),
    ) -> bool {
        self.probe.overrun(late.0);
        executive.handle_overrun(late)
    }

    /// Writes the record of the tick with this number to the tick log, once the tick has ended. `wall_ns` is its wall
    /// clock in nanoseconds since the Unix epoch.
    pub fn record_tick(
        &mut self,
        executive: &mut Executive<LoggingBank<SimBank>>,
        (number, wall_ns): (u64, i64),
    ) {
        for tap in &mut self.taps {
            sample(tap, executive.plant().plant(), |channel, value| {
                self.probe.sample(channel, value);
            });
        }
        if let Some(exchange) = executive.plant().buffer() {
            self.tick_log
                .put((number, wall_ns), true, exchange, self.probe.stage());
            exchange.clear();
        }
    }

    /// Returns the number of ticks that are missing from the tick log, because it had no room for them.
    #[must_use]
    pub fn lost_ticks(&self) -> u64 {
        self.tick_log.lost()
    }
}

/// Observer of cycles that forwards each notification to a flow probe and to another observer.
struct ObserverPair<'a>(&'a mut FlowProbe, &'a mut dyn CycleObserver);

impl CycleObserver for ObserverPair<'_> {
    fn cycle_finished(&mut self, id: CommandId, command: &Command) {
        self.0.cycle_finished(id, command);
        self.1.cycle_finished(id, command);
    }

    fn evaluation_starts(&mut self, next: Option<CommandId>) {
        self.1.evaluation_starts(next);
    }

    fn evaluated(&mut self, id: CommandId, command: &Command) {
        self.1.evaluated(id, command);
    }
}
