//! Values by index, stored in a full table or sparsely.

use crate::hash::Map;

/// A value for each index. Values that were never set are `T::default()`.
pub(super) enum Slots<T> {
    /// Full table, for a scope that visits most indices.
    All(Vec<T>),
    /// Sparse map for a constant, which visits few indices. A full table for each constant would take quadratic time in
    /// the length of the text.
    Few(Map<u32, T>),
}

impl<T: Default + Clone> Slots<T> {
    pub(super) fn all(count: usize) -> Slots<T> {
        Slots::All(vec![T::default(); count])
    }

    pub(super) fn few() -> Slots<T> {
        Slots::Few(Map::default())
    }

    pub(super) fn get(&self, number: u32) -> Option<&T> {
        match self {
            Slots::All(all) => all.get(number as usize),
            Slots::Few(few) => few.get(&number),
        }
    }

    pub(super) fn slot(&mut self, number: u32) -> &mut T {
        match self {
            Slots::All(all) => &mut all[number as usize],
            Slots::Few(few) => few.entry(number).or_default(),
        }
    }
}
