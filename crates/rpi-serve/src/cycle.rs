//! The cycle's thread: one tick after the other, on the beat, until the server closes.
//!
//! Nothing here allocates, frees, locks, waits for anybody or formats text, once the system was asked for what it grants.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};

use rpi_core::{Watch, Why};
use rpi_host::control::Executive;
use rpi_host::realtime::{self, Beat, Grant, RealTime};
use rpi_host::recording::{Camera, Taped};
use rpi_sim::SimBank;

/// The core with its devices, its beat, and who looks at every command after each of its cycles.
pub(crate) struct Cycle {
    pub(crate) executive: Executive<Taped<SimBank>>,
    pub(crate) beat: Beat,
    pub(crate) watch: Box<dyn Watch + Send>,
    /// How a tick is run.
    pub(crate) around_tick: fn(&mut dyn FnMut()),
    /// There is to be no other tick.
    pub(crate) over: Arc<AtomicBool>,
    /// Somebody wants an emergency stop: everything is stopped at the end of each tick until this is taken back.
    pub(crate) alarm: Arc<AtomicBool>,
    /// Takes in what is recorded, if it is.
    pub(crate) camera: Option<Camera>,
    /// How many ticks the recording has lost, once there will be no more.
    pub(crate) lost: Arc<OnceLock<u64>>,
}

impl Cycle {
    /// Asks the system for what is wanted, tells what it grants, and ticks. Behind a fence it never comes back.
    pub(crate) fn run(mut self, real_time: Option<RealTime>, granted: &OnceLock<Vec<Grant>>) {
        let grants = real_time.map(realtime::begin).unwrap_or_default();
        let fenced = grants.iter().any(realtime::is_fence_up);
        self.beat.restart();
        // Whoever opens the server looks for this again and again: to tell it takes no system call.
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
            let too_often = too_often | late.is_some_and(|late| executive.too_late(late));
            if let Some(why) = reason_to_stop(&self.alarm, too_often) {
                executive.halt(why);
            }
            return;
        };
        camera.tick(executive, wall_ns, watch);
        let too_often = self.beat.over(now);
        let late = self.beat.overrun();
        let too_often = too_often | late.is_some_and(|late| camera.too_late(executive, late));
        if let Some(why) = reason_to_stop(&self.alarm, too_often) {
            camera.halt(executive, why);
        }
        camera.take(executive, (now, wall_ns));
    }
}

/// Why everything is to be stopped, if it is.
fn reason_to_stop(alarm: &AtomicBool, too_often: bool) -> Option<Why> {
    match (alarm.load(Ordering::Relaxed), too_often) {
        (true, _) => Some(Why::EmergencyStop),
        (false, true) => Some(Why::Overrun),
        (false, false) => None,
    }
}
