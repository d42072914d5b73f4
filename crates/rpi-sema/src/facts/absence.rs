//! Absence of a value, leaf by leaf.

use std::rc::Rc;

/// For each leaf of a value, whether it can be absent. Most values are uniform.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Absence {
    /// All leaves can be absent, or none can.
    Uniform(bool),
    /// One flag for each leaf; not all are equal.
    PerLeaf(Rc<[bool]>),
}

impl Absence {
    /// Present in all cycles.
    pub const NEVER: Absence = Absence::Uniform(false);
    /// Possibly absent in all leaves.
    pub const MAYBE: Absence = Absence::Uniform(true);

    /// Returns whether any leaf can be absent.
    #[must_use]
    pub fn any(&self) -> bool {
        match self {
            Absence::Uniform(all) => *all,
            Absence::PerLeaf(leaves) => leaves.iter().any(|leaf| *leaf),
        }
    }

    /// Returns whether leaf `k` can be absent.
    #[must_use]
    pub fn leaf(&self, k: usize) -> bool {
        match self {
            Absence::Uniform(all) => *all,
            Absence::PerLeaf(leaves) => leaves.get(k).copied().unwrap_or(false),
        }
    }

    /// Returns the absence of `count` leaves starting at leaf `at`.
    #[must_use]
    pub fn part(&self, at: usize, count: usize) -> Absence {
        match self {
            Absence::Uniform(all) => Absence::Uniform(*all),
            Absence::PerLeaf(_) => Absence::from_leaves((at..at + count).map(|k| self.leaf(k))),
        }
    }

    /// Creates the absence of a value from the flags of successive leaves.
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

    /// Combines two absences of `count` leaves each, leaf by leaf.
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

    /// Returns this absence, with the leaves for which `absent` holds also possibly absent.
    #[must_use]
    pub fn or(&self, count: usize, absent: impl Fn(usize) -> bool) -> Absence {
        match self {
            Absence::Uniform(true) => Absence::MAYBE,
            known => Absence::from_leaves((0..count.max(1)).map(|k| known.leaf(k) || absent(k))),
        }
    }

    /// Returns this absence with `of_part` leaves from `at` on replaced by those of `part`.
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
