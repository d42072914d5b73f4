//! The clocks of a value, leaf by leaf. Most values have one clock in all leaves.

use std::rc::Rc;

/// The clock of each leaf of a value.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Row<C> {
    /// All leaves have this clock.
    All(C),
    /// Leaf by leaf.
    Each(Rc<[C]>),
}

impl<C: Copy + PartialEq> Row<C> {
    /// The clock of one leaf.
    #[must_use]
    pub fn leaf(&self, k: usize) -> C {
        match self {
            Row::All(clock) => *clock,
            Row::Each(leaves) => leaves[k.min(leaves.len() - 1)],
        }
    }

    /// The one clock of all leaves, if they have one.
    #[must_use]
    pub fn one(&self) -> Option<C> {
        match self {
            Row::All(clock) => Some(*clock),
            Row::Each(_) => None,
        }
    }

    /// The distinct clocks of neighbouring leaves, in order.
    pub fn iter(&self) -> impl Iterator<Item = C> + '_ {
        match self {
            Row::All(clock) => std::slice::from_ref(clock).iter().copied(),
            Row::Each(leaves) => leaves.iter().copied(),
        }
    }

    /// Of leaves one after the other. A value without leaves has the given clock.
    pub(super) fn of(leaves: impl Iterator<Item = C>, otherwise: C) -> Row<C> {
        let leaves: Vec<C> = leaves.collect();
        match leaves.split_first() {
            None => Row::All(otherwise),
            Some((first, rest)) if rest.iter().all(|leaf| leaf == first) => Row::All(*first),
            Some(_) => Row::Each(leaves.into()),
        }
    }

    /// The leaves from `at` on, `count` of them.
    pub(super) fn part(&self, at: usize, count: usize) -> Row<C> {
        match self {
            Row::All(clock) => Row::All(*clock),
            Row::Each(leaves) => {
                let part = leaves.iter().copied().skip(at).take(count);
                Row::of(part, leaves[0])
            }
        }
    }

    /// Each clock replaced by what `of` makes of it.
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
