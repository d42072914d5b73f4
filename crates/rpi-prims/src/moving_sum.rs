//! Moving sum over the last values of a flow, in a state whose size is fixed when the command is loaded, at constant
//! cost per cycle.
//!
//! A running sum that only adds and subtracts accumulates rounding errors and keeps an infinity for ever. So a second
//! sum is built from zero during each turn of the buffer and replaces the running sum at the end of the turn. An error
//! lasts for one turn at most.

use crate::aggregates::StateRange;
use crate::value_types::{FlowType, Vector};
use core::marker::PhantomData;
use core::ops::{Add, Sub};
use nalgebra::Quaternion;

/// Type of value that can be summed in a [`Window`]. All-zero slots must represent zero.
pub(crate) trait Summand: Copy + Add<Output = Self> + Sub<Output = Self> {
    /// Number of 64-bit slots that a value takes in the state of a window.
    const CELLS: u32;
    /// Returns zero, the value of all-zero slots.
    fn zero() -> Self {
        Self::load(&[0; 4], 0)
    }
    /// Reads a value from the slots `cells[at..]`.
    fn load(cells: &[u64], at: usize) -> Self;
    /// Writes the value to the slots `cells[at..]`.
    fn store(self, cells: &mut [u64], at: usize);
}

macro_rules! flows_are_summands {
    ($($t:ty),*) => { $(
        impl Summand for $t {
            const CELLS: u32 = <$t as FlowType>::SCALAR.slots();
            fn load(cells: &[u64], at: usize) -> Self {
                <$t as FlowType>::load(cells, at)
            }
            fn store(self, cells: &mut [u64], at: usize) {
                <$t as FlowType>::store(self, cells, at);
            }
        }
    )* };
}

flows_are_summands!(i64, f64, Vector);

impl Summand for Quaternion<f64> {
    const CELLS: u32 = 4;
    fn load(cells: &[u64], at: usize) -> Self {
        let part = |k| <f64 as FlowType>::load(cells, at + k);
        Quaternion::new(part(3), part(0), part(1), part(2))
    }
    fn store(self, cells: &mut [u64], at: usize) {
        for (k, part) in self.coords.iter().enumerate() {
            <f64 as FlowType>::store(*part, cells, at + k);
        }
    }
}

/// Handle to a window over the last values of a flow, with their sum, in memory slots. All-zero slots are an empty
/// window.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Window<T> {
    at: usize,
    capacity: usize,
    element: PhantomData<T>,
}

impl<T: Summand> Window<T> {
    const ENTRY: usize = T::CELLS as usize;
    /// Number of slots of a window before its values: position, number of values and two sums.
    const HEAD: usize = 2 + 2 * Self::ENTRY;

    /// Returns the number of slots of a window over at most `entries` values.
    pub(crate) fn cells(entries: u32) -> u32 {
        let head = 2 + 2 * T::CELLS;
        entries.max(1).saturating_mul(T::CELLS).saturating_add(head)
    }

    /// Creates the handle to the window that occupies all slots of a state.
    pub(crate) fn from_region(region: StateRange) -> Self {
        Window {
            at: region.start,
            capacity: (region.len - Self::HEAD) / Self::ENTRY,
            element: PhantomData,
        }
    }

    /// Returns the maximum number of values in the window.
    pub(crate) fn capacity(self) -> usize {
        self.capacity
    }

    /// Returns the number of values in the window so far; at most its capacity.
    pub(crate) fn len(self, cells: &[u64]) -> usize {
        cells[self.at + 1] as usize
    }

    /// Removes all values from the window.
    pub(crate) fn clear(self, cells: &mut [u64]) {
        cells[self.at..self.entry(self.capacity)].fill(0);
    }

    /// Returns the newest value in the window; zero if it is empty.
    pub(crate) fn newest(self, cells: &[u64]) -> T {
        T::load(
            cells,
            self.entry((self.next(cells) + self.capacity - 1) % self.capacity),
        )
    }

    /// Adds the newest value to the window, removes the oldest one from a full window and returns the sum.
    pub(crate) fn push(self, cells: &mut [u64], value: T) -> T {
        let (sum_at, turn_at) = (self.at + 2, self.at + 2 + Self::ENTRY);
        let next = self.next(cells);
        let leaving = T::load(cells, self.entry(next));
        value.store(cells, self.entry(next));
        let turn = T::load(cells, turn_at) + value;
        let running = T::load(cells, sum_at) + value - leaving;
        let complete = next + 1 == self.capacity;
        let sum = if complete { turn } else { running };
        let turn = if complete { T::zero() } else { turn };
        sum.store(cells, sum_at);
        turn.store(cells, turn_at);
        cells[self.at] = ((next + 1) % self.capacity) as u64;
        cells[self.at + 1] = (self.len(cells) + 1).min(self.capacity) as u64;
        sum
    }

    fn next(self, cells: &[u64]) -> usize {
        cells[self.at] as usize % self.capacity
    }

    fn entry(self, k: usize) -> usize {
        self.at + Self::HEAD + k * Self::ENTRY
    }
}
