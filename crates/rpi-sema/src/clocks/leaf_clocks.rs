//! Clocks of a value, leaf by leaf. Most values have the same clock in all leaves.

use std::rc::Rc;

/// Clock of each leaf of a value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Row<C> {
    /// Clock shared by all leaves.
    All(C),
    /// One clock for each leaf; not all are equal.
    Each(Rc<[C]>),
}

impl<C: Copy + PartialEq> Row<C> {
    /// Returns the clock of leaf `k`.
    #[must_use]
    pub fn leaf(&self, k: usize) -> C {
        match self {
            Row::All(clock) => *clock,
            Row::Each(leaves) => leaves[k.min(leaves.len() - 1)],
        }
    }

    /// Returns the clock shared by all leaves, if there is one.
    #[must_use]
    pub fn one(&self) -> Option<C> {
        match self {
            Row::All(clock) => Some(*clock),
            Row::Each(_) => None,
        }
    }

    /// Iterates over the clocks of the leaves in order; over a shared clock once.
    pub fn iter(&self) -> impl Iterator<Item = C> + '_ {
        match self {
            Row::All(clock) => std::slice::from_ref(clock).iter().copied(),
            Row::Each(leaves) => leaves.iter().copied(),
        }
    }

    /// Creates a row from the clocks of successive leaves. A value without leaves gets the clock `otherwise`.
    pub(super) fn of(leaves: impl Iterator<Item = C>, otherwise: C) -> Row<C> {
        let leaves: Vec<C> = leaves.collect();
        match leaves.split_first() {
            None => Row::All(otherwise),
            Some((first, rest)) if rest.iter().all(|leaf| leaf == first) => Row::All(*first),
            Some(_) => Row::Each(leaves.into()),
        }
    }

    /// Returns the row of `count` leaves starting at leaf `at`.
    pub(super) fn part(&self, at: usize, count: usize) -> Row<C> {
        match self {
            Row::All(clock) => Row::All(*clock),
            Row::Each(leaves) => {
                let part = leaves.iter().copied().skip(at).take(count);
                Row::of(part, leaves[0])
            }
        }
    }

    /// Returns a row with each clock replaced by `of(clock)`.
    pub(super) fn map<D: Copy + PartialEq>(&self, of: impl Fn(C) -> D) -> Row<D> {
        match self {
            Row::All(clock) => Row::All(of(*clock)),
            Row::Each(leaves) => {
                let mapped: Rc<[D]> = leaves.iter().map(|clock| of(*clock)).collect();
                Row::of(mapped.iter().copied(), mapped[0])
            }
        }
    }
}
