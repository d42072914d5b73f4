//! Values by index, stored in a full table or sparsely.

use crate::hash::FastMap;

/// Map from indices to values. Values that were never set are `T::default()`.
pub(super) enum IndexMap<T> {
    /// Table with an entry for each index, for a scope that visits most indices.
    Dense(Vec<T>),
    /// Hash map, for a constant, which visits few indices. A full table for each constant would take quadratic time in
    /// the length of the text.
    Sparse(FastMap<u32, T>),
}

impl<T: Default + Clone> IndexMap<T> {
    pub(super) fn dense(count: usize) -> IndexMap<T> {
        IndexMap::Dense(vec![T::default(); count])
    }

    pub(super) fn sparse() -> IndexMap<T> {
        IndexMap::Sparse(FastMap::default())
    }

    pub(super) fn get(&self, number: u32) -> Option<&T> {
        match self {
            IndexMap::Dense(all) => all.get(number as usize),
            IndexMap::Sparse(few) => few.get(&number),
        }
    }

    pub(super) fn get_mut(&mut self, number: u32) -> &mut T {
        match self {
            IndexMap::Dense(all) => &mut all[number as usize],
            IndexMap::Sparse(few) => few.entry(number).or_default(),
        }
    }
}
