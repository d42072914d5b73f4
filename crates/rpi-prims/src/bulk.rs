//! Values too large to pass by copy: arrays and matrices as places in the cells, and ring buffers in a state.

use crate::flow::Flow;
use crate::operand::Memory;
use core::marker::PhantomData;

/// An array of values side by side.
#[derive(Debug)]
pub struct Array<T> {
    at: usize,
    len: usize,
    of: PhantomData<T>,
}

impl<T> Clone for Array<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Array<T> {}

impl<T: Flow> Array<T> {
    /// The array of `len` values that starts at cell `at`.
    #[must_use]
    pub const fn at(at: usize, len: usize) -> Self {
        Array {
            at,
            len,
            of: PhantomData,
        }
    }

    /// Number of values.
    #[must_use]
    pub const fn len(self) -> usize {
        self.len
    }

    /// True if there is no value in it.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.len == 0
    }

    /// The value at `index`; `None` outside.
    #[must_use]
    pub fn get(self, cells: &[u64], index: i64) -> Option<T> {
        let index = usize::try_from(index).ok().filter(|&k| k < self.len)?;
        Some(T::load(cells, self.at + index * T::CELLS))
    }

    /// Overwrites the value at `index`; false outside.
    pub fn set(self, cells: &mut [u64], index: i64, value: T) -> bool {
        let index = usize::try_from(index).ok().filter(|&k| k < self.len);
        if let Some(k) = index {
            value.store(cells, self.at + k * T::CELLS);
        }
        index.is_some()
    }

    /// Copies `from[start..]` over all of this array; false if it is too short. Both may be the same place.
    pub fn copy(self, cells: &mut [u64], from: Self, start: i64) -> bool {
        let start = usize::try_from(start).ok();
        let fits = start.filter(|&s| s.checked_add(self.len).is_some_and(|end| end <= from.len));
        if let Some(s) = fits {
            let first = from.at + s * T::CELLS;
            cells.copy_within(first..first + self.len * T::CELLS, self.at);
        }
        fits.is_some()
    }

    /// Sets every value.
    pub fn fill(self, cells: &mut [u64], value: T) {
        for k in 0..self.len {
            value.store(cells, self.at + k * T::CELLS);
        }
    }
}

/// A dense matrix of reals, row by row.
#[derive(Clone, Copy, Debug)]
pub struct Matrix {
    at: usize,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub cols: usize,
}

impl Matrix {
    /// The matrix that starts at cell `at`.
    #[must_use]
    pub const fn at(at: usize, rows: usize, cols: usize) -> Self {
        Matrix { at, rows, cols }
    }

    /// Its elements row by row.
    #[must_use]
    pub const fn elements(self) -> Array<f64> {
        Array::at(self.at, self.rows * self.cols)
    }

    /// The element; `None` outside.
    #[must_use]
    pub fn get(self, cells: &[u64], row: usize, col: usize) -> Option<f64> {
        self.place(row, col).map(|at| f64::load(cells, at))
    }

    /// The element; 0 outside.
    #[must_use]
    pub fn at_or_zero(self, cells: &[u64], row: usize, col: usize) -> f64 {
        self.get(cells, row, col).unwrap_or(0.0)
    }

    /// All rows and columns, row by row.
    pub fn places(self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.rows).flat_map(move |row| (0..self.cols).map(move |col| (row, col)))
    }

    /// Computes every element from its row and column.
    pub fn fill_with(self, cells: &mut [u64], element: impl Fn(&[u64], usize, usize) -> f64) {
        for (row, col) in self.places() {
            let value = element(cells, row, col);
            self.set(cells, row, col, value);
        }
    }

    /// Overwrites an element; false outside.
    pub fn set(self, cells: &mut [u64], row: usize, col: usize, value: f64) -> bool {
        let place = self.place(row, col);
        if let Some(at) = place {
            value.store(cells, at);
        }
        place.is_some()
    }

    fn place(self, row: usize, col: usize) -> Option<usize> {
        (row < self.rows && col < self.cols).then(|| self.at + row * self.cols + col)
    }
}

/// A state whose size depends on parameters: a run of cells.
#[derive(Clone, Copy, Debug)]
pub struct Region {
    /// First cell.
    pub at: usize,
    /// Number of cells.
    pub len: usize,
}

impl Memory for Region {
    const WORDS: usize = 2;
    const CELLS: u32 = 0;
    #[inline(always)]
    fn load(_: &[u64], words: &[u32]) -> Self {
        Region {
            at: words[0] as usize,
            len: words[1] as usize,
        }
    }
    #[inline(always)]
    fn store(self, _: &mut [u64], _: &[u32]) {}
}
