//! Values by index, stored in a full table or sparsely.

use crate::hash::FastMap;

/// Map from indices to values, such as the signals of each expression. A value that was never set is `T::default()`.
pub(super) enum IndexMap<T> {
    /// Table with an entry for each index, for maps in which most indices are used.
    Dense(Vec<T>),
    /// Hash map, for the evaluation of a constant, which uses few indices. A full table for each constant would take
    /// quadratic time in the length of the program text.
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
