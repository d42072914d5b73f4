//! Digest of the set-points of the undisturbed commands, one per second.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use rpi_core::{Command, CommandId, CycleObserver};
use rpi_image::hash::Fnv1a;
use rpi_image::image::{Signal, TRUE};
use rpi_image::{Scalar, Type};

use crate::client::PATIENCE;

/// Cycles per second.
const SECOND: u64 = 1000;

/// Hashes every set-point of the commands whose names begin with `MoveTo`.
#[derive(Clone)]
pub(crate) struct Digest {
    hash: Fnv1a,
    cycles: u64,
    /// Digest after each second.
    marks: Arc<[AtomicU64]>,
    passed: Arc<AtomicU64>,
}

impl Digest {
    /// Creates a digest with capacity for this many seconds.
    pub(crate) fn new(seconds: u64) -> Digest {
        Digest {
            hash: Fnv1a::new(),
            cycles: 0,
            marks: (0..seconds).map(|_| AtomicU64::new(0)).collect(),
            passed: Arc::default(),
        }
    }

    /// Returns the number of complete seconds.
    pub(crate) fn passed(&self) -> u64 {
        self.passed.load(Ordering::Acquire)
    }

    /// Waits until this many seconds are complete.
    pub(crate) fn wait(&self, seconds: u64) {
        let begin = Instant::now();
        while self.passed() < seconds {
            let most = PATIENCE + Duration::from_secs(2 * seconds);
            assert!(begin.elapsed() < most, "the commands do not get on");
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Returns the digests of all complete seconds.
    pub(crate) fn marks(&self) -> Vec<u64> {
        let marks = self.marks.iter().take(self.passed() as usize);
        marks.map(|mark| mark.load(Ordering::Relaxed)).collect()
    }

    fn take_in(&mut self, command: &Command) {
        let machine = command.instance();
        let image = machine.image();
        self.hash = self.hash.with_bytes(image.name.as_bytes());
        let cells = image.actuators.iter().flat_map(|a| &a.inputs);
        for at in cells.flat_map(|cells| cells.start..cells.end()) {
            let ty = Type::Scalar(Scalar::Real);
            let cell = machine.value(Signal {
                start: at,
                present: TRUE,
                ty,
            });
            self.hash = self
                .hash
                .with_bytes(&cell.map_or(0, |c| c[0]).to_le_bytes());
        }
    }
}

impl CycleObserver for Digest {
    fn cycle_finished(&mut self, _: CommandId, command: &Command) {
        if !command.instance().image().name.starts_with("MoveTo") {
            return;
        }
        self.take_in(command);
        self.cycles += 1;
        let second = self.cycles / SECOND;
        let mark = self.marks.get((second.max(1) - 1) as usize);
        if let Some(mark) = mark.filter(|_| self.cycles.is_multiple_of(SECOND)) {
            mark.store(self.hash.finish(), Ordering::Relaxed);
            self.passed.store(second, Ordering::Release);
        }
    }
}
