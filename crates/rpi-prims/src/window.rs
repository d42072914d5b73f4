//! The sum of a flow's last values, in a state sized at load, at a constant cost per cycle.
//!
//! A running sum that only adds and subtracts drifts, and keeps an infinity for ever. So a second sum is built from
//! nothing on each turn of the buffer and replaces the first when the turn is complete: errors live for one turn.

use crate::bulk::Region;
use crate::flow::{Flow, Vector};
use core::marker::PhantomData;
use core::ops::{Add, Sub};

/// The last values of a flow and their sum. All cells zero is the empty window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window<T> {
    at: usize,
    capacity: usize,
    of: PhantomData<T>,
}

/// What can be summed up: its zero is the all-zero bit pattern.
pub(crate) trait Summand: Flow + Add<Output = Self> + Sub<Output = Self> {}

impl Summand for i64 {}
impl Summand for f64 {}
impl Summand for Vector {}

impl<T: Summand> Window<T> {
    /// Place of the next entry, entries seen, running sum, sum of this turn.
    const HEAD: usize = 2 + 2 * T::CELLS;

    /// Cells for a window over `entries`, as a state's size.
    pub(crate) fn cells(entries: u32) -> u32 {
        let head = 2 + 2 * T::SCALAR.cells();
        entries
            .max(1)
            .saturating_mul(T::SCALAR.cells())
            .saturating_add(head)
    }

    /// The window that fills a state.
    pub(crate) fn of(region: Region) -> Self {
        Window {
            at: region.at,
            capacity: (region.len - Self::HEAD) / T::CELLS,
            of: PhantomData,
        }
    }

    /// How many values it spans.
    pub(crate) fn capacity(self) -> usize {
        self.capacity
    }

    /// How many values it holds.
    pub(crate) fn len(self, cells: &[u64]) -> usize {
        cells[self.at + 1] as usize
    }

    /// Forgets everything.
    pub(crate) fn clear(self, cells: &mut [u64]) {
        cells[self.at..self.at + Self::HEAD + self.capacity * T::CELLS].fill(0);
    }

    /// Adds the newest value, drops the oldest of a full window and returns the sum.
    pub(crate) fn push(self, cells: &mut [u64], value: T) -> T {
        let (sum_at, turn_at) = (self.at + 2, self.at + 2 + T::CELLS);
        let next = cells[self.at] as usize % self.capacity;
        let entry = self.at + Self::HEAD + next * T::CELLS;
        let leaving = T::load(cells, entry);
        value.store(cells, entry);
        let turn = T::load(cells, turn_at) + value;
        let complete = next + 1 == self.capacity;
        let sum = if complete {
            turn
        } else {
            T::load(cells, sum_at) + value - leaving
        };
        sum.store(cells, sum_at);
        let turn = if complete { T::neutral() } else { turn };
        turn.store(cells, turn_at);
        cells[self.at] = ((next + 1) % self.capacity) as u64;
        cells[self.at + 1] = (self.len(cells) + 1).min(self.capacity) as u64;
        sum
    }
}
