//! Exports of a command after its latest cycle, written by the cycle and readable from any thread.
//!
//! A sequence lock over atomic cells (Lamport 1977; H.-J. Boehm, "Can seqlocks get along with programming language
//! memory models?", MSPC 2012). The writer never waits. A reader that observes a concurrent write retries.

use std::sync::atomic::{AtomicU64, Ordering, fence};

use rpi_core::{Command, Overrun, OverrunStats};
use rpi_image::image::Export;

/// Maximum number of attempts to read a snapshot that no concurrent write changes. A write takes less than a
/// microsecond and happens once per cycle.
const MAX_READ_ATTEMPTS: usize = 1000;

/// Exports of one command after its latest cycle. Readers never delay the cycle. A slow reader skips cycles but always
/// sees the latest one.
#[derive(Debug)]
pub struct ExportSnapshot {
    /// Version counter of the sequence lock; odd during a write.
    version: AtomicU64,
    /// For each export, one 64-bit word for its presence (0 if absent), followed by the words of its value.
    cells: Box<[AtomicU64]>,
    /// Number of overruns of the command and the worst one.
    overruns: OverrunSnapshot,
}

/// Number of overruns of a command and the worst of them. It has its own sequence lock because it is rarely written.
#[derive(Debug, Default)]
struct OverrunSnapshot {
    version: AtomicU64,
    /// Number of overruns, followed by the tick number, duration (ns), lateness (ns) and fragment index of the worst
    /// one.
    words: [AtomicU64; 5],
}

impl ExportSnapshot {
    /// Creates a snapshot for commands with these exports. All exports are absent at first.
    pub(super) fn new(exports: &[Export]) -> ExportSnapshot {
        let cells: usize = exports.iter().map(export_words).sum();
        ExportSnapshot {
            version: AtomicU64::new(0),
            cells: (0..cells).map(|_| AtomicU64::new(0)).collect(),
            overruns: OverrunSnapshot::default(),
        }
    }

    /// Writes the exports of a command after a cycle. Only the cycle thread calls this; it does not allocate.
    pub(super) fn write(&self, command: &Command) {
        let machine = command.instance();
        let version = begin_write(&self.version);
        let mut cells = self.cells.iter();
        for export in &machine.image().exports {
            let value = machine.value(export.value);
            let mut put = |bits: u64| {
                if let Some(cell) = cells.next() {
                    cell.store(bits, Ordering::Relaxed);
                }
            };
            put(u64::from(value.is_some()));
            let width = export.value.ty.slots() as usize;
            (0..width).for_each(|k| put(value.map_or(0, |v| v[k])));
        }
        self.version.store(version + 2, Ordering::Release);
    }

    /// Writes the number of overruns of the command and the worst one. Only the cycle thread calls this.
    pub(super) fn write_overruns(&self, overruns: &OverrunStats) {
        let Some(worst) = overruns.worst else {
            return;
        };
        let version = begin_write(&self.overruns.version);
        let fragment = u64::from(worst.fragment);
        let words = [worst.tick, worst.took_ns, worst.late_ns, fragment];
        let words = std::iter::once(overruns.count).chain(words);
        for (cell, word) in self.overruns.words.iter().zip(words) {
            cell.store(word, Ordering::Relaxed);
        }
        self.overruns.version.store(version + 2, Ordering::Release);
    }

    /// Returns the number of overruns of the command and the worst one; `None` if there was none.
    #[must_use]
    pub fn overruns(&self) -> Option<(u64, Overrun)> {
        let words = read(&self.overruns.version, &self.overruns.words)?;
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

    /// Returns the number of cycles of the command whose exports were written so far.
    #[must_use]
    pub fn cycles(&self) -> u64 {
        self.version.load(Ordering::Acquire) / 2
    }

    /// Returns all words of the snapshot, read so that they belong to the same cycle. Returns `None` before the first
    /// cycle, or if every attempt met a concurrent write.
    #[must_use]
    pub fn read_consistent(&self) -> Option<Vec<u64>> {
        read(&self.version, &self.cells)
    }

    /// Splits the words returned by [`ExportSnapshot::read_consistent`] into exports and their values; the value of an absent export is
    /// `None`.
    pub fn values<'a>(
        exports: &'a [Export],
        mut cells: &'a [u64],
    ) -> impl Iterator<Item = (&'a Export, Option<&'a [u64]>)> {
        exports.iter().map_while(move |export| {
            let (own, rest) = cells.split_at_checked(export_words(export))?;
            cells = rest;
            let (present, value) = own.split_first()?;
            Some((export, Some(value).filter(|_| *present != 0)))
        })
    }
}

/// Begins a write under the sequence lock: makes the version odd. Returns the version before the write.
fn begin_write(version: &AtomicU64) -> u64 {
    // A sequence lock: the version is odd during a write. See H. Boehm, "Can seqlocks get along with programming
    // language memory models?", MSPC 2012. The fence keeps the writes of the words behind that of the odd version.
    let before = version.load(Ordering::Relaxed);
    version.store(before + 1, Ordering::Relaxed);
    fence(Ordering::Release);
    before
}

/// Reads all words so that they belong to the same write; `None` before the first write, or if every attempt met a
/// concurrent write.
fn read(version: &AtomicU64, cells: &[AtomicU64]) -> Option<Vec<u64>> {
    for _ in 0..MAX_READ_ATTEMPTS {
        let before = version.load(Ordering::Acquire);
        if before == 0 {
            return None;
        }
        let load = |cell: &AtomicU64| cell.load(Ordering::Relaxed);
        let read: Vec<u64> = cells.iter().map(load).collect();
        // The fence keeps the loads of the words before the second load of the version. An acquire load of the version
        // would order only what follows it.
        fence(Ordering::Acquire);
        if before.is_multiple_of(2) && version.load(Ordering::Relaxed) == before {
            return Some(read);
        }
        std::hint::spin_loop();
    }
    None
}

fn export_words(export: &Export) -> usize {
    1 + export.value.ty.slots() as usize
}
