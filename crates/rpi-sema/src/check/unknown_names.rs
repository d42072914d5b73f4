//! Names of flows that nothing declares: one message for each is enough.

use rpi_syntax::Name;
use std::collections::BTreeMap;

/// What has been told, each name with its place among the findings.
#[derive(Default)]
pub(super) struct UnknownNames {
    places: BTreeMap<Name, usize>,
    /// In the order of telling: what was told of a guess is forgotten with it.
    order: Vec<Name>,
}

impl UnknownNames {
    /// Where among the findings it has been told.
    pub(super) fn place(&self, name: &str) -> Option<usize> {
        self.places.get(name).copied()
    }

    /// Notes that it is told as the finding of this place; whether it is the first.
    pub(super) fn tell(&mut self, name: &Name, place: usize) -> bool {
        if self.places.contains_key(name) {
            return false;
        }
        self.places.insert(name.clone(), place);
        self.order.push(name.clone());
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
