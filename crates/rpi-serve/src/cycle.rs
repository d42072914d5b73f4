//! The cycle thread: runs one tick per period until the server closes.
//!
//! After the set-up of the thread, nothing here allocates, frees, locks, blocks or formats text.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use rpi_core::{Watch, Why};
use rpi_runtime::control::Executive;
use rpi_runtime::realtime::{self, Beat, Grant, RealTime};
use rpi_runtime::run::Camera;
use rpi_runtime::tape::Taped;
use rpi_sim::SimBank;

/// The core with its devices, its timer and the observer that is called for every command after each of its cycles.
pub(crate) struct Cycle {
    pub(crate) executive: Executive<Taped<SimBank>>,
    pub(crate) beat: Beat,
    pub(crate) watch: Box<dyn Watch + Send>,
    /// Wrapper around each tick; it must call its argument once.
    pub(crate) around_tick: fn(&mut dyn FnMut()),
    /// Set when the thread must stop; no further tick starts.
    pub(crate) over: Arc<AtomicBool>,
    /// Emergency stop request: while it is set, everything is stopped at the end of each tick.
    pub(crate) alarm: Arc<AtomicBool>,
    /// Recorder of each tick, if the run is recorded.
    pub(crate) camera: Option<Camera>,
    /// Number of ticks missing from the recording. Set after the last tick.
    pub(crate) lost: Arc<OnceLock<u64>>,
}

impl Cycle {
    /// Requests the real-time settings from the system, publishes the results in `granted` and runs the ticks. With the
    /// system-call fence up, this function never returns.
    pub(crate) fn run(mut self, real_time: Option<RealTime>, granted: &OnceLock<Vec<Grant>>) {
        let grants = real_time.map(realtime::begin).unwrap_or_default();
        let fenced = grants.iter().any(realtime::is_fence_up);
        self.beat.restart();
        // `Server::run` polls this cell. Setting it takes no system call, which the fence would forbid.
        let _ = granted.set(grants);
        let around_tick = self.around_tick;
        while !self.over.load(Ordering::Relaxed) {
            around_tick(&mut || self.tick());
        }
        let _ = self.lost.set(self.camera.as_ref().map_or(0, Camera::lost));
        if fenced {
            realtime::rest();
        }
    }

    fn tick(&mut self) {
        let now = self.executive.now();
        let wall_ns = self.beat.wait(now);
        let (executive, watch) = (&mut self.executive, &mut *self.watch);
        let Some(camera) = &mut self.camera else {
            executive.tick(wall_ns, watch);
            let too_often = self.beat.over(now);
            let late = self.beat.overrun();
            // `|` instead of `||`: the overrun must be attributed to its command in any case.
            let too_often = too_often | late.is_some_and(|late| executive.too_late(late));
            if let Some(why) = reason_to_stop(&self.alarm, too_often) {
                executive.halt(why);
            }
            return;
        };
        camera.tick(executive, wall_ns, watch);
        let too_often = self.beat.over(now);
        let late = self.beat.overrun();
        // `|` for the same reason as above.
        let too_often = too_often | late.is_some_and(|late| camera.too_late(executive, late));
        if let Some(why) = reason_to_stop(&self.alarm, too_often) {
            camera.halt(executive, why);
        }
        camera.take(executive, (now, wall_ns));
    }
}

/// Returns the reason to stop everything, if there is one.
fn reason_to_stop(alarm: &AtomicBool, too_often: bool) -> Option<Why> {
    match (alarm.load(Ordering::Relaxed), too_often) {
        (true, _) => Some(Why::EmergencyStop),
        (false, true) => Some(Why::Overrun),
        (false, false) => None,
    }
}
