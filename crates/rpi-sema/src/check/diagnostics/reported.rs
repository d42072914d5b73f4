//! Errors of a body that have been reported, so that each is reported once: undefined names, flows that are not clocks.

use std::collections::BTreeMap;

/// Reported errors by key, each with the index of its diagnostic.
pub(crate) struct Told<K> {
    places: BTreeMap<K, usize>,
    /// Keys in the order of the diagnostics. The keys of a discarded trial check are removed again.
    order: Vec<K>,
}

impl<K> Default for Told<K> {
    fn default() -> Self {
        Told {
            places: BTreeMap::new(),
            order: Vec::new(),
        }
    }
}

impl<K: Ord + Clone> Told<K> {
    /// Returns the index of the diagnostic for a key.
    pub(crate) fn place(&self, what: &K) -> Option<usize> {
        self.places.get(what).copied()
    }

    /// Records the index of the diagnostic for a key; returns whether the key is new.
    pub(crate) fn tell(&mut self, what: &K, place: usize) -> bool {
        if self.places.contains_key(what) {
            return false;
        }
        self.places.insert(what.clone(), place);
        self.order.push(what.clone());
        true
    }

    /// Removes all keys whose diagnostics have this index or a higher one.
    pub(crate) fn forget_from(&mut self, place: usize) {
        while let Some(last) = self.order.last() {
            if self.place(last).is_some_and(|told| told < place) {
                break;
            }
            self.places.remove(last);
            self.order.pop();
        }
    }
}
