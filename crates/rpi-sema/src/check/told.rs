//! What has been told once, so that one message is enough: names that nothing declares, flows that are no clocks.

use std::collections::BTreeMap;

/// What has been told, each with its place among the findings.
pub(super) struct Told<K> {
    places: BTreeMap<K, usize>,
    /// In the order of telling: what was told of a guess is forgotten with it.
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
    /// Where among the findings it has been told.
    pub(super) fn place(&self, what: &K) -> Option<usize> {
        self.places.get(what).copied()
    }

    /// Notes that it is told as the finding of this place; whether it is the first.
    pub(super) fn tell(&mut self, what: &K, place: usize) -> bool {
        if self.places.contains_key(what) {
            return false;
        }
        self.places.insert(what.clone(), place);
        self.order.push(what.clone());
        true
    }

    /// Forgets what is told from this place of the findings on.
    pub(super) fn forget_from(&mut self, place: usize) {
        while let Some(last) = self.order.last() {
            if self.place(last).is_some_and(|told| told < place) {
                break;
            }
            self.places.remove(last);
            self.order.pop();
        }
    }
}
