//! Clocks of a value, leaf by leaf. Most values have the same clock in all leaves.

use std::rc::Rc;

/// Clocks of the leaves (scalar parts) of a value: one clock for all leaves, or one for each.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum LeafClocks<C> {
    /// All leaves have this clock.
    Uniform(C),
    /// One clock for each leaf (scalar part); at least two of them differ.
    PerLeaf(Rc<[C]>),
}

impl<C: Copy + PartialEq> LeafClocks<C> {
    /// Returns the clock of the leaf with index `k`.
    #[must_use]
    pub fn leaf(&self, k: usize) -> C {
        match self {
            LeafClocks::Uniform(clock) => *clock,
            LeafClocks::PerLeaf(leaves) => leaves[k.min(leaves.len() - 1)],
        }
    }

    /// Returns the clock that all leaves share; `None` if the leaves have different clocks.
    #[must_use]
    pub fn uniform(&self) -> Option<C> {
        match self {
            LeafClocks::Uniform(clock) => Some(*clock),
            LeafClocks::PerLeaf(_) => None,
        }
    }

    /// Iterates over the clocks of the leaves in order. A clock that all leaves share is returned once.
    pub fn iter(&self) -> impl Iterator<Item = C> + '_ {
        match self {
            LeafClocks::Uniform(clock) => std::slice::from_ref(clock).iter().copied(),
            LeafClocks::PerLeaf(leaves) => leaves.iter().copied(),
        }
    }

    /// Creates the clocks of a value from the clocks of its leaves in order. A value without leaves gets the clock
    /// `otherwise`.
    pub(super) fn from_leaves(leaves: impl Iterator<Item = C>, otherwise: C) -> LeafClocks<C> {
        let leaves: Vec<C> = leaves.collect();
        match leaves.split_first() {
            None => LeafClocks::Uniform(otherwise),
            Some((first, rest)) if rest.iter().all(|leaf| leaf == first) => {
                LeafClocks::Uniform(*first)
            }
            Some(_) => LeafClocks::PerLeaf(leaves.into()),
        }
    }

    /// Returns the clocks of `count` leaves from the leaf with index `at` on.
    pub(super) fn part(&self, at: usize, count: usize) -> LeafClocks<C> {
        match self {
            LeafClocks::Uniform(clock) => LeafClocks::Uniform(*clock),
            LeafClocks::PerLeaf(leaves) => {
                let part = leaves.iter().copied().skip(at).take(count);
                LeafClocks::from_leaves(part, leaves[0])
            }
        }
    }

    /// Returns the clocks with each clock replaced by `of(clock)`.
    pub(super) fn map_arrays<D: Copy + PartialEq>(&self, of: impl Fn(C) -> D) -> LeafClocks<D> {
        match self {
            LeafClocks::Uniform(clock) => LeafClocks::Uniform(of(*clock)),
            LeafClocks::PerLeaf(leaves) => {
                let mapped: Rc<[D]> = leaves.iter().map(|clock| of(*clock)).collect();
                LeafClocks::from_leaves(mapped.iter().copied(), mapped[0])
            }
        }
    }
}
