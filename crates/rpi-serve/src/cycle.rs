//! The cycle's thread: one tick after the other, on the beat, until the server closes.
//!
//! Nothing here allocates, frees, locks, waits for anybody or formats text, once the system was asked for what it grants.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;

use rpi_core::{Watch, Why};
use rpi_host::control::Executive;
use rpi_host::realtime::{self, Beat, Grant, Wanted};
use rpi_sim::SimBank;

/// The core with its devices, its beat, and who looks at every command after each of its cycles.
pub(crate) struct Cycle {
    pub(crate) executive: Executive<SimBank>,
    pub(crate) beat: Beat,
    pub(crate) watch: Box<dyn Watch + Send>,
    /// How a tick is run.
    pub(crate) around_tick: fn(&mut dyn FnMut()),
    pub(crate) closing: Arc<AtomicBool>,
}

impl Cycle {
    /// Asks the system for what is wanted, tells what it grants, and ticks.
    pub(crate) fn run(mut self, wanted: Option<Wanted>, granted: &Sender<Vec<Grant>>) {
        let grants = wanted.map(realtime::ask).unwrap_or_default();
        // Whoever opens the server waits for this.
        let _ = granted.send(grants);
        self.beat.restart();
        let around_tick = self.around_tick;
        while !self.closing.load(Ordering::Relaxed) {
            around_tick(&mut || self.tick());
        }
    }

    fn tick(&mut self) {
        let now = self.executive.now();
        let wall_ns = self.beat.wait(now);
        self.executive.tick(wall_ns, &mut *self.watch);
        if self.beat.over(now) {
            self.executive.halt(Why::Overrun);
        }
    }
}
