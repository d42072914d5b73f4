//! Errors of a body that have been reported, so that each is reported once: undefined names, flows that are not clocks.

use std::collections::BTreeMap;

/// Errors that have been reported, by key, each with the index of its diagnostic.
pub(crate) struct ReportedErrors<K> {
    indices: BTreeMap<K, usize>,
    /// Keys in the order of the diagnostics. The keys of a discarded trial check are removed again.
    keys: Vec<K>,
}

impl<K> Default for ReportedErrors<K> {
    fn default() -> Self {
        ReportedErrors {
            indices: BTreeMap::new(),
            keys: Vec::new(),
        }
    }
}

impl<K: Ord + Clone> ReportedErrors<K> {
    /// Returns the index of the diagnostic for a key.
    pub(crate) fn index(&self, what: &K) -> Option<usize> {
        self.indices.get(what).copied()
    }

    /// Records the index of the diagnostic for a key; returns whether the key is new.
    pub(crate) fn record(&mut self, what: &K, place: usize) -> bool {
        if self.indices.contains_key(what) {
            return false;
        }
        self.indices.insert(what.clone(), place);
        self.keys.push(what.clone());
        true
    }

    /// Removes all keys whose diagnostics have this index or a higher one.
    pub(crate) fn truncate(&mut self, place: usize) {
        while let Some(last) = self.keys.last() {
            if self.index(last).is_some_and(|index| index < place) {
                break;
            }
            self.indices.remove(last);
            self.keys.pop();
        }
    }
}
