//! Absence of a value, leaf by leaf.

use std::rc::Rc;

/// For each leaf of a value, whether it can be absent. Most values are uniform.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Absence {
    /// The same for all leaves.
    All(bool),
    /// One flag for each leaf; not all are equal.
    Each(Rc<[bool]>),
}

impl Absence {
    /// Present in all cycles.
    pub const NEVER: Absence = Absence::All(false);
    /// Possibly absent in all leaves.
    pub const MAYBE: Absence = Absence::All(true);

    /// Returns whether any leaf can be absent.
    #[must_use]
    pub fn any(&self) -> bool {
        match self {
            Absence::All(all) => *all,
            Absence::Each(leaves) => leaves.iter().any(|leaf| *leaf),
        }
    }

    /// Returns whether leaf `k` can be absent.
    #[must_use]
    pub fn leaf(&self, k: usize) -> bool {
        match self {
            Absence::All(all) => *all,
            Absence::Each(leaves) => leaves.get(k).copied().unwrap_or(false),
        }
    }

    /// Returns the absence of `count` leaves starting at leaf `at`.
    #[must_use]
    pub fn part(&self, at: usize, count: usize) -> Absence {
        match self {
            Absence::All(all) => Absence::All(*all),
            Absence::Each(_) => Absence::of((at..at + count).map(|k| self.leaf(k))),
        }
    }

    /// Creates the absence of a value from the flags of successive leaves.
    #[must_use]
    pub fn of(leaves: impl Iterator<Item = bool>) -> Absence {
        let leaves: Vec<bool> = leaves.collect();
        match leaves.split_first() {
            None => Absence::NEVER,
            Some((first, rest)) if rest.iter().all(|leaf| leaf == first) => Absence::All(*first),
            Some(_) => Absence::Each(leaves.into()),
        }
    }

    /// Combines two absences of `count` leaves each, leaf by leaf.
    #[must_use]
    pub fn with(
        &self,
        other: &Absence,
        count: usize,
        combine: impl Fn(bool, bool) -> bool,
    ) -> Absence {
        match (self, other) {
            (Absence::All(a), Absence::All(b)) => Absence::All(combine(*a, *b)),
            _ => Absence::of((0..count).map(|k| combine(self.leaf(k), other.leaf(k)))),
        }
    }

    /// Returns this absence, with the leaves for which `absent` holds also possibly absent.
    #[must_use]
    pub fn or(&self, count: usize, absent: impl Fn(usize) -> bool) -> Absence {
        match self {
            Absence::All(true) => Absence::MAYBE,
            known => Absence::of((0..count.max(1)).map(|k| known.leaf(k) || absent(k))),
        }
    }

    /// Returns this absence with `of_part` leaves from `at` on replaced by those of `part`.
    #[must_use]
    pub fn replaced(&self, count: usize, at: usize, part: &Absence, of_part: usize) -> Absence {
        match (self, part) {
            (Absence::All(a), Absence::All(b)) if a == b => Absence::All(*a),
            _ => Absence::of((0..count).map(
                |k| match k.checked_sub(at).filter(|k| *k < of_part) {
                    Some(k) => part.leaf(k),
                    None => self.leaf(k),
                },
            )),
        }
    }
}
