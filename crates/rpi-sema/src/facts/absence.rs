//! Absence of a value, leaf by leaf.

use std::rc::Rc;

/// For each leaf (scalar part) of a value, whether it can be absent. For most values, one answer holds for all leaves.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Absence {
    /// Either all leaves can be absent (`true`), or none can (`false`).
    Uniform(bool),
    /// For each leaf, whether it can be absent. The entries are not all equal.
    PerLeaf(Rc<[bool]>),
}

impl Absence {
    /// Absence of a value whose leaves are present in all cycles.
    pub const NEVER: Absence = Absence::Uniform(false);
    /// Absence of a value whose leaves can all be absent.
    pub const MAYBE: Absence = Absence::Uniform(true);

    /// Returns whether at least one leaf (scalar part) can be absent.
    #[must_use]
    pub fn any(&self) -> bool {
        match self {
            Absence::Uniform(all) => *all,
            Absence::PerLeaf(leaves) => leaves.iter().any(|leaf| *leaf),
        }
    }

    /// Returns whether the leaf with index `k` can be absent.
    #[must_use]
    pub fn leaf(&self, k: usize) -> bool {
        match self {
            Absence::Uniform(all) => *all,
            Absence::PerLeaf(leaves) => leaves.get(k).copied().unwrap_or(false),
        }
    }

    /// Returns which of the `count` leaves from the leaf with index `at` on can be absent.
    #[must_use]
    pub fn part(&self, at: usize, count: usize) -> Absence {
        match self {
            Absence::Uniform(all) => Absence::Uniform(*all),
            Absence::PerLeaf(_) => Absence::from_leaves((at..at + count).map(|k| self.leaf(k))),
        }
    }

    /// Creates the absence of a value from one answer for each of its leaves, in order.
    #[must_use]
    pub fn from_leaves(leaves: impl Iterator<Item = bool>) -> Absence {
        let leaves: Vec<bool> = leaves.collect();
        match leaves.split_first() {
            None => Absence::NEVER,
            Some((first, rest)) if rest.iter().all(|leaf| leaf == first) => {
                Absence::Uniform(*first)
            }
            Some(_) => Absence::PerLeaf(leaves.into()),
        }
    }

    /// Returns the absence that the function `combine` gives for the two answers for each leaf. `count` is the number
    /// of leaves.
    #[must_use]
    pub fn combine(
        &self,
        other: &Absence,
        count: usize,
        combine: impl Fn(bool, bool) -> bool,
    ) -> Absence {
        match (self, other) {
            (Absence::Uniform(a), Absence::Uniform(b)) => Absence::Uniform(combine(*a, *b)),
            _ => Absence::from_leaves((0..count).map(|k| combine(self.leaf(k), other.leaf(k)))),
        }
    }

    /// Returns the absence of a value of `count` leaves in which further leaves can be absent: those for which `absent`
    /// returns `true`.
    #[must_use]
    pub fn or(&self, count: usize, absent: impl Fn(usize) -> bool) -> Absence {
        match self {
            Absence::Uniform(true) => Absence::MAYBE,
            known => Absence::from_leaves((0..count.max(1)).map(|k| known.leaf(k) || absent(k))),
        }
    }

    /// Returns the absence of a value of `count` leaves in which the `of_part` leaves from `at` on have the absence
    /// `part`.
    #[must_use]
    pub fn replaced(&self, count: usize, at: usize, part: &Absence, of_part: usize) -> Absence {
        match (self, part) {
            (Absence::Uniform(a), Absence::Uniform(b)) if a == b => Absence::Uniform(*a),
            _ => Absence::from_leaves((0..count).map(|k| {
                match k.checked_sub(at).filter(|k| *k < of_part) {
                    Some(k) => part.leaf(k),
                    None => self.leaf(k),
                }
            })),
        }
    }
}
