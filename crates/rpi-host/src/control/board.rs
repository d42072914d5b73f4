//! What a command exports, as its latest cycle left it: written by the cycle, read by anybody.
//!
//! A sequence lock over atomic cells (Lamport 1977; H.-J. Boehm, "Can seqlocks get along with programming language memory
//! models?", MSPC 2012): the writer never waits, a reader that meets a write tries again.

use std::sync::atomic::{AtomicU64, Ordering, fence};

use rpi_core::{Command, Overrun, Overruns};
use rpi_image::image::Export;

/// How often a reader tries before it gives up: a write takes less than a microsecond, and there is one per cycle.
const TRIES: usize = 1000;

/// The exports of one command, as its latest cycle left them. A reader never holds the cycle up; one that is slow sees fewer
/// cycles, not older ones.
#[derive(Debug)]
pub struct Board {
    /// Odd while it is being written.
    version: AtomicU64,
    /// For each export its presence, then its value.
    cells: Box<[AtomicU64]>,
    /// Cycles that took too long.
    late: Worst,
}

/// How many cycles took too long, and the worst of them; written far less often, under a lock of its own.
#[derive(Debug, Default)]
struct Worst {
    version: AtomicU64,
    /// How many; then tick, time that it took, time by which it was late, and fragment of the worst.
    words: [AtomicU64; 5],
}

impl Board {
    /// A board for these exports; nothing is present.
    pub(super) fn new(exports: &[Export]) -> Board {
        let cells: usize = exports.iter().map(size).sum();
        Board {
            version: AtomicU64::new(0),
            cells: (0..cells).map(|_| AtomicU64::new(0)).collect(),
            late: Worst::default(),
        }
    }

    /// Copies what a command exports after a cycle. Only the cycle's thread writes; allocates nothing.
    pub(super) fn write(&self, command: &Command) {
        let machine = command.machine();
        let version = begin(&self.version);
        let mut cells = self.cells.iter();
        for export in &machine.image().exports {
            let value = machine.value(export.value);
            let mut put = |bits: u64| {
                if let Some(cell) = cells.next() {
                    cell.store(bits, Ordering::Relaxed);
                }
            };
            put(u64::from(value.is_some()));
            let width = export.value.ty.cells() as usize;
            (0..width).for_each(|k| put(value.map_or(0, |v| v[k])));
        }
        self.version.store(version + 2, Ordering::Release);
    }

    /// Notes that a cycle took too long.
    pub(super) fn note(&self, overruns: &Overruns) {
        let Some(worst) = overruns.worst else {
            return;
        };
        let version = begin(&self.late.version);
        let fragment = u64::from(worst.fragment);
        let words = [worst.tick, worst.took_ns, worst.late_ns, fragment];
        let words = std::iter::once(overruns.count).chain(words);
        for (cell, word) in self.late.words.iter().zip(words) {
            cell.store(word, Ordering::Relaxed);
        }
        self.late.version.store(version + 2, Ordering::Release);
    }

    /// How many cycles took too long, and the worst of them; nothing if none did.
    #[must_use]
    pub fn overruns(&self) -> Option<(u64, Overrun)> {
        let words = read(&self.late.version, &self.late.words)?;
        let [count, tick, took_ns, late_ns, fragment] = words[..] else {
            return None;
        };
        let fragment = u32::try_from(fragment).unwrap_or(u32::MAX);
        let worst = Overrun {
            tick,
            took_ns,
            late_ns,
            fragment,
        };
        Some((count, worst))
    }

    /// How many cycles have been written.
    #[must_use]
    pub fn cycles(&self) -> u64 {
        self.version.load(Ordering::Acquire) / 2
    }

    /// All cells of one cycle; none before the first.
    #[must_use]
    pub fn read(&self) -> Option<Vec<u64>> {
        read(&self.version, &self.cells)
    }

    /// The exports one by one with what was read of them; `None` for an absent value.
    pub fn values<'a>(
        exports: &'a [Export],
        mut cells: &'a [u64],
    ) -> impl Iterator<Item = (&'a Export, Option<&'a [u64]>)> {
        exports.iter().map_while(move |export| {
            let (own, rest) = cells.split_at_checked(size(export))?;
            cells = rest;
            let (present, value) = own.split_first()?;
            Some((export, Some(value).filter(|_| *present != 0)))
        })
    }
}

/// A write begins: the version before it.
fn begin(version: &AtomicU64) -> u64 {
    let before = version.load(Ordering::Relaxed);
    version.store(before + 1, Ordering::Relaxed);
    fence(Ordering::Release);
    before
}

/// All cells of one write; none before the first.
fn read(version: &AtomicU64, cells: &[AtomicU64]) -> Option<Vec<u64>> {
    for _ in 0..TRIES {
        let before = version.load(Ordering::Acquire);
        if before == 0 {
            return None;
        }
        let load = |cell: &AtomicU64| cell.load(Ordering::Relaxed);
        let read: Vec<u64> = cells.iter().map(load).collect();
        fence(Ordering::Acquire);
        if before.is_multiple_of(2) && version.load(Ordering::Relaxed) == before {
            return Some(read);
        }
        std::hint::spin_loop();
    }
    None
}

fn size(export: &Export) -> usize {
    1 + export.value.ty.cells() as usize
}
