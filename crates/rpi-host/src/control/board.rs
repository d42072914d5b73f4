//! What a command exports, as its latest cycle left it: written by the cycle, read by anybody.
//!
//! A sequence lock over atomic cells (Lamport 1977; H.-J. Boehm, "Can seqlocks get along with programming language memory
//! models?", MSPC 2012): the writer never waits, a reader that meets a write tries again.

use std::sync::atomic::{AtomicU64, Ordering, fence};

use rpi_core::Command;
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
}

impl Board {
    /// A board for these exports; nothing is present.
    pub(super) fn new(exports: &[Export]) -> Board {
        let cells: usize = exports.iter().map(size).sum();
        Board {
            version: AtomicU64::new(0),
            cells: (0..cells).map(|_| AtomicU64::new(0)).collect(),
        }
    }

    /// Copies what a command exports after a cycle. Only the cycle's thread writes; allocates nothing.
    pub(super) fn write(&self, command: &Command) {
        let machine = command.machine();
        let version = self.version.load(Ordering::Relaxed);
        self.version.store(version + 1, Ordering::Relaxed);
        fence(Ordering::Release);
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

    /// How many cycles have been written.
    #[must_use]
    pub fn cycles(&self) -> u64 {
        self.version.load(Ordering::Acquire) / 2
    }

    /// All cells of one cycle; none before the first.
    #[must_use]
    pub fn read(&self) -> Option<Vec<u64>> {
        for _ in 0..TRIES {
            let before = self.version.load(Ordering::Acquire);
            if before == 0 {
                return None;
            }
            let load = |cell: &AtomicU64| cell.load(Ordering::Relaxed);
            let cells: Vec<u64> = self.cells.iter().map(load).collect();
            fence(Ordering::Acquire);
            if before.is_multiple_of(2) && self.version.load(Ordering::Relaxed) == before {
                return Some(cells);
            }
            std::hint::spin_loop();
        }
        None
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

fn size(export: &Export) -> usize {
    1 + export.value.ty.cells() as usize
}
