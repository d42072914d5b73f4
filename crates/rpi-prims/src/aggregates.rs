//! Handles to values that are too large to pass by copy: arrays, matrices and ring buffers in memory slots.

use crate::operand::PrimState;
use crate::value_types::FlowType;
use core::marker::PhantomData;

/// Handle to an array of values in the memory slots of a command, stored contiguously. The handle does not own the
/// slots.
#[derive(Debug)]
pub struct Array<T> {
    at: usize,
    len: usize,
    element: PhantomData<T>,
}

impl<T> Clone for Array<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Array<T> {}

impl<T: FlowType> Array<T> {
    /// Creates a handle to the array of `len` values that starts at slot `at`.
    #[must_use]
    pub const fn new(at: usize, len: usize) -> Self {
        Array {
            at,
            len,
            element: PhantomData,
        }
    }

    /// Returns the number of elements of the array, from its type.
    #[must_use]
    pub const fn len(self) -> usize {
        self.len
    }

    /// Returns true if the array has no elements.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.len == 0
    }

    /// Returns handles to the first `at` elements, or to all if there are fewer, and to the others.
    #[must_use]
    pub fn split_at(self, at: usize) -> (Self, Self) {
        let at = at.min(self.len);
        (
            Array::new(self.at, at),
            Array::new(self.at + at * T::SLOTS, self.len - at),
        )
    }

    /// Returns the value at `index`, counted from 0, in the memory `cells`; `None` if the index is out of range.
    #[must_use]
    pub fn get(self, cells: &[u64], index: i64) -> Option<T> {
        let index = usize::try_from(index).ok().filter(|&k| k < self.len)?;
        Some(T::load(cells, self.at + index * T::SLOTS))
    }

    /// Overwrites the value at `index`, counted from 0, in the memory `cells`. Returns false if the index is out of
    /// range.
    pub fn set(self, cells: &mut [u64], index: i64, value: T) -> bool {
        let index = usize::try_from(index).ok().filter(|&k| k < self.len);
        if let Some(k) = index {
            value.store(cells, self.at + k * T::SLOTS);
        }
        index.is_some()
    }

    /// Copies the elements of `from` from index `start` on to all elements of this array. Returns false if `from` has
    /// too few elements. The arrays may overlap.
    pub fn copy(self, cells: &mut [u64], from: Self, start: i64) -> bool {
        let start = usize::try_from(start).ok();
        let start_in_range =
            start.filter(|&s| s.checked_add(self.len).is_some_and(|end| end <= from.len));
        if let Some(s) = start_in_range {
            let first = from.at + s * T::SLOTS;
            cells.copy_within(first..first + self.len * T::SLOTS, self.at);
        }
        start_in_range.is_some()
    }

    /// Sets all elements of the array to `value`.
    pub fn fill(self, cells: &mut [u64], value: T) {
        for k in 0..self.len {
            value.store(cells, self.at + k * T::SLOTS);
        }
    }
}

/// Handle to a dense matrix of reals in the memory slots of a command, stored row by row.
#[derive(Clone, Copy, Debug)]
pub struct Matrix {
    at: usize,
    /// Number of rows of the matrix.
    pub rows: usize,
    /// Number of columns of the matrix.
    pub cols: usize,
}

impl Matrix {
    /// Creates a handle to the matrix of `rows` by `cols` reals that starts at slot `at`.
    #[must_use]
    pub const fn new(at: usize, rows: usize, cols: usize) -> Self {
        Matrix { at, rows, cols }
    }

    /// Returns a handle to the elements of the matrix, row by row.
    #[must_use]
    pub const fn elements(self) -> Array<f64> {
        Array::new(self.at, self.rows * self.cols)
    }

    /// Returns an element of the matrix; `None` if an index, counted from 0, is out of range.
    #[must_use]
    pub fn get(self, cells: &[u64], row: usize, col: usize) -> Option<f64> {
        self.slot_of(row, col).map(|at| f64::load(cells, at))
    }

    /// Returns an element of the matrix; 0 if an index, counted from 0, is out of range.
    #[must_use]
    pub fn get_or_zero(self, cells: &[u64], row: usize, col: usize) -> f64 {
        self.get(cells, row, col).unwrap_or(0.0)
    }

    /// Returns all index pairs (row, column) of the matrix, row by row.
    pub fn indices(self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.rows).flat_map(move |row| (0..self.cols).map(move |col| (row, col)))
    }

    /// Sets each element of the matrix to the result of `element` for the memory, its row and its column.
    pub fn fill_with(self, cells: &mut [u64], element: impl Fn(&[u64], usize, usize) -> f64) {
        for (row, col) in self.indices() {
            let value = element(cells, row, col);
            self.set(cells, row, col, value);
        }
    }

    /// Overwrites an element of the matrix. Returns false if an index, counted from 0, is out of range.
    pub fn set(self, cells: &mut [u64], row: usize, col: usize, value: f64) -> bool {
        let place = self.slot_of(row, col);
        if let Some(at) = place {
            value.store(cells, at);
        }
        place.is_some()
    }

    fn slot_of(self, row: usize, col: usize) -> Option<usize> {
        (row < self.rows && col < self.cols).then(|| self.at + row * self.cols + col)
    }
}

/// State of a primitive whose size depends on parameters: a range of memory slots.
#[derive(Clone, Copy, Debug)]
pub struct StateRange {
    /// Index of the first memory slot of the state.
    pub start: usize,
    /// Number of memory slots of the state.
    pub len: usize,
}

impl PrimState for StateRange {
    const WORDS: usize = 2;
    const SLOTS: u32 = 0;
    #[inline(always)]
    fn load(_: &[u64], words: &[u32]) -> Self {
        StateRange {
            start: words[0] as usize,
            len: words[1] as usize,
        }
    }
    #[inline(always)]
    fn store(self, _: &mut [u64], _: &[u32]) {}
}
