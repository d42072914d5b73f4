//! Which leaves of a value can be absent.

use std::rc::Rc;

/// For each leaf of a value whether it can be absent. Most values are alike in all leaves.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Absence {
    /// All leaves alike.
    All(bool),
    /// Leaf by leaf.
    Each(Rc<[bool]>),
}

impl Absence {
    /// Present in all cycles.
    pub const NEVER: Absence = Absence::All(false);
    /// Maybe absent as a whole.
    pub const MAYBE: Absence = Absence::All(true);

    /// Whether some leaf can be absent.
    #[must_use]
    pub fn any(&self) -> bool {
        match self {
            Absence::All(all) => *all,
            Absence::Each(leaves) => leaves.iter().any(|leaf| *leaf),
        }
    }

    /// Of one leaf.
    #[must_use]
    pub fn leaf(&self, k: usize) -> bool {
        match self {
            Absence::All(all) => *all,
            Absence::Each(leaves) => leaves.get(k).copied().unwrap_or(false),
        }
    }

    /// Of the leaves from `at` on.
    #[must_use]
    pub fn part(&self, at: usize, count: usize) -> Absence {
        match self {
            Absence::All(all) => Absence::All(*all),
            Absence::Each(_) => Absence::of((at..at + count).map(|k| self.leaf(k))),
        }
    }

    /// Of leaves one after the other.
    #[must_use]
    pub fn of(leaves: impl Iterator<Item = bool>) -> Absence {
        let leaves: Vec<bool> = leaves.collect();
        match leaves.split_first() {
            None => Absence::NEVER,
            Some((first, rest)) if rest.iter().all(|leaf| leaf == first) => Absence::All(*first),
            Some(_) => Absence::Each(leaves.into()),
        }
    }

    /// Leaf by leaf combined with another of so many leaves.
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

    /// Absent in leaves for which this holds, too.
    #[must_use]
    pub fn or(&self, count: usize, absent: impl Fn(usize) -> bool) -> Absence {
        match self {
            Absence::All(true) => Absence::MAYBE,
            known => Absence::of((0..count.max(1)).map(|k| known.leaf(k) || absent(k))),
        }
    }

    /// With the leaves from `at` on replaced by so many of another.
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
