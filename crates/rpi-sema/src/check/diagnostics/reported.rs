//! Errors of a body that have been reported, so that each is reported once: undefined names, flows that are not clocks.

use std::collections::BTreeMap;

/// Errors of one kind that have been reported, by key, each with the index of its diagnostic. The key is, for example,
/// an undefined name.
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
    /// Returns the index of the diagnostic for a key; `None` if no error has been reported for the key.
    pub(crate) fn index(&self, what: &K) -> Option<usize> {
        self.indices.get(what).copied()
    }

    /// Records `place` as the index of the diagnostic for the key `what`, unless the key is already recorded. Returns
    /// whether the key is new.
    pub(crate) fn record(&mut self, what: &K, place: usize) -> bool {
        if self.indices.contains_key(what) {
            return false;
        }
        self.indices.insert(what.clone(), place);
        self.keys.push(what.clone());
        true
    }

    /// Removes all keys whose diagnostics have the index `place` or a higher one, because these diagnostics have been
    /// discarded.
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
