//! The cycle thread: runs one tick per period until the server closes.
//!
//! After the set-up of the thread, nothing here allocates, frees, locks, blocks or formats text.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use rpi_core::{AbortReason, CycleObserver};
use rpi_runtime::control::Executive;
use rpi_runtime::realtime::{self, RealTime, ResourceGrant, TickTimer};
use rpi_runtime::run::TickCollector;
use rpi_runtime::tick_log::LoggingBank;
use rpi_sim::SimBank;

/// Data of the cycle thread: the core with its devices, the timer of its ticks, and the observer that is called for
/// every command after each of its cycles.
pub(crate) struct CycleThread {
    pub(crate) executive: Executive<LoggingBank<SimBank>>,
    pub(crate) timer: TickTimer,
    pub(crate) watch: Box<dyn CycleObserver + Send>,
    /// Function called for each tick with the tick as its argument, which the function must call once. Tests use the
    /// function to trap allocations.
    pub(crate) tick_wrapper: fn(&mut dyn FnMut()),
    /// Set when the cycle thread must end; no further tick starts.
    pub(crate) stop: Arc<AtomicBool>,
    /// Emergency stop request: while the flag is set, all commands are aborted at the end of each tick.
    pub(crate) emergency_stop: Arc<AtomicBool>,
    /// Recorder of each tick; `None` if the run is not recorded.
    pub(crate) recorder: Option<TickCollector>,
    /// Number of ticks that are missing from the recording, because the recorder could not keep up. Set after the last
    /// tick.
    pub(crate) lost_ticks: Arc<OnceLock<u64>>,
}

impl CycleThread {
    /// Requests the real-time settings from the operating system, publishes in `granted` which of them were granted,
    /// and runs ticks until the thread must stop. With the system call filter installed, this function never returns.
    pub(crate) fn run(
        mut self,
        real_time: Option<RealTime>,
        granted: &OnceLock<Vec<ResourceGrant>>,
    ) {
        let grants = real_time
            .map(realtime::acquire_resources)
            .unwrap_or_default();
        let fenced = grants.iter().any(realtime::is_syscall_filter_installed);
        self.timer.restart();
        // `Server::run` polls this cell. Setting it takes no system call, which the fence would forbid.
        let _ = granted.set(grants);
        let around_tick = self.tick_wrapper;
        while !self.stop.load(Ordering::Relaxed) {
            around_tick(&mut || self.tick());
        }
        let _ = self
            .lost_ticks
            .set(self.recorder.as_ref().map_or(0, TickCollector::lost_ticks));
        if fenced {
            realtime::sleep_forever();
        }
    }

    fn tick(&mut self) {
        let now = self.executive.now();
        let wall_ns = self.timer.wait(now);
        let (executive, watch) = (&mut self.executive, &mut *self.watch);
        let Some(collector) = &mut self.recorder else {
            executive.tick(wall_ns, watch);
            let too_often = self.timer.finish_tick(now);
            let late = self.timer.overrun();
            // `|` instead of `||`: the overrun must be attributed to its command in any case.
            let too_often = too_often | late.is_some_and(|late| executive.handle_overrun(late));
            if let Some(why) = reason_to_stop(&self.emergency_stop, too_often) {
                executive.halt(why);
            }
            return;
        };
        collector.tick(executive, wall_ns, watch);
        let too_often = self.timer.finish_tick(now);
        let late = self.timer.overrun();
        // `|` for the same reason as above.
        let too_often =
            too_often | late.is_some_and(|late| collector.handle_overrun(executive, late));
        if let Some(why) = reason_to_stop(&self.emergency_stop, too_often) {
            collector.halt(executive, why);
        }
        collector.record_tick(executive, (now, wall_ns));
        self.timer
            .metrics()
            .set_unrecorded_ticks(collector.lost_ticks());
    }
}

/// Returns the reason for which all commands must be aborted: the emergency stop flag `alarm`, or overruns that are
/// `too_often`. Returns `None` if the commands may continue.
fn reason_to_stop(alarm: &AtomicBool, too_often: bool) -> Option<AbortReason> {
    match (alarm.load(Ordering::Relaxed), too_often) {
        (true, _) => Some(AbortReason::EmergencyStop),
        (false, true) => Some(AbortReason::Overrun),
        (false, false) => None,
    }
}
