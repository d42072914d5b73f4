//! What is known of each of many things: of all of them in a table, or only of those that are met.

use crate::hash::Map;

/// A value for each number; those that were never set are `T::default()`.
pub(super) enum Slots<T> {
    /// For what looks at nearly all.
    All(Vec<T>),
    /// For a constant, which looks at few: to make a table for each would take time by the square of the text.
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
