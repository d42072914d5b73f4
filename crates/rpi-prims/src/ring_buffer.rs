//! Ring buffer of the last values of a flow, in a state whose size is fixed when the command is loaded.
//!
//! Slots: position of the next entry, number of entries (up to the capacity), then the entries. Each entry is a
//! presence slot and the slots of the value. All zero is the empty buffer.

use crate::aggregates::StateRange;
use crate::value_types::FlowType;
use core::marker::PhantomData;

/// Handle to a ring buffer of the last values of a flow, including absences, in memory slots.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RingBuffer<T> {
    at: usize,
    capacity: usize,
    element: PhantomData<T>,
}

impl<T: FlowType> RingBuffer<T> {
    const ENTRY: usize = 1 + T::SLOTS;
    const HEAD: usize = 2;

    /// Returns the number of memory slots of a buffer for `entries` entries.
    pub(crate) fn cells(entries: u32) -> u32 {
        let entry = u32::try_from(Self::ENTRY).unwrap_or(u32::MAX);
        // At least one entry, because `push` computes modulo the capacity.
        entries.max(1).saturating_mul(entry).saturating_add(2)
    }

    /// Creates the handle to the buffer that occupies all slots of a state.
    pub(crate) fn from_region(region: StateRange) -> Self {
        RingBuffer {
            at: region.start,
            capacity: (region.len - Self::HEAD) / Self::ENTRY,
            element: PhantomData,
        }
    }

    /// Returns the maximum number of entries of the buffer.
    pub(crate) fn capacity(self) -> usize {
        self.capacity
    }

    /// Returns the number of stored entries; at most the capacity.
    pub(crate) fn len(self, cells: &[u64]) -> usize {
        usize::try_from(cells[self.at + 1])
            .unwrap_or(usize::MAX)
            .min(self.capacity)
    }

    /// Adds the newest entry. If the buffer is full, this removes the oldest entry.
    pub(crate) fn push(self, cells: &mut [u64], value: Option<T>) {
        let next = usize::try_from(cells[self.at]).unwrap_or(0) % self.capacity;
        let entry = self.entry(next);
        cells[entry] = u64::from(value.is_some());
        if let Some(value) = value {
            value.store(cells, entry + 1);
        }
        cells[self.at] = ((next + 1) % self.capacity) as u64;
        cells[self.at + 1] = (self.len(cells) + 1).min(self.capacity) as u64;
    }

    /// Returns the entry `back` pushes before the newest one; `None` if it does not exist or is an absence.
    pub(crate) fn nth_back(self, cells: &[u64], back: usize) -> Option<T> {
        if back >= self.len(cells) {
            return None;
        }
        let next = usize::try_from(cells[self.at]).unwrap_or(0) % self.capacity;
        let entry = self.entry((next + self.capacity - 1 - back) % self.capacity);
        (cells[entry] != 0).then(|| T::load(cells, entry + 1))
    }

    fn entry(self, k: usize) -> usize {
        self.at + Self::HEAD + k * Self::ENTRY
    }
}
