//! What is known of a flow in one phase.

use rpi_image::Value;
use rpi_net::{FragmentId, NodeId, PortRef};
use std::rc::Rc;

/// A condition of the same cycle: a Boolean flow, and which value of it is meant.
pub(super) type Condition = (PortRef, bool);

/// When a flow that may have no value has one.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Unless {
    /// In the cycles in which this holds.
    Now(Condition),
    /// From the first cycle of this fragment on in which this holds: what is kept there of a sampled flow.
    Since(Condition, FragmentId),
}

/// What is known of a flow: each case allows more than the one before.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Known {
    /// There is no such cycle.
    Never,
    /// This value.
    Value(Rc<Value>),
    /// One of these integers, ascending: the states that an automaton can be in.
    OneOf(Rc<[i64]>),
    /// Some value.
    Defined,
    /// It may have none.
    Undefined {
        /// The delay that has no value yet.
        root: NodeId,
        /// When it has one.
        unless: Option<Unless>,
    },
}

impl Known {
    /// A value that is known.
    pub(super) fn value(value: Value) -> Known {
        Known::Value(Rc::new(value))
    }

    /// What holds if either may be the case.
    pub(super) fn join(&self, other: &Known) -> Known {
        use Known::{Defined, Never, Undefined};
        match (self, other) {
            (Never, known) | (known, Never) => known.clone(),
            (a, b) if a == b => a.clone(),
            (
                Undefined { root, unless },
                Undefined {
                    root: other,
                    unless: otherwise,
                },
            ) => Undefined {
                root: *root.min(other),
                unless: unless.filter(|unless| Some(*unless) == *otherwise),
            },
            (undefined @ Undefined { .. }, _) | (_, undefined @ Undefined { .. }) => {
                undefined.clone()
            }
            (a, b) => match (a.integers(), b.integers()) {
                (Some(a), Some(b)) => one_of(&a, &b),
                _ => Defined,
            },
        }
    }

    /// The integers of which it is one, if they are known.
    fn integers(&self) -> Option<Rc<[i64]>> {
        match self {
            Known::Value(value) => value.as_int().map(|value| [value].into()),
            Known::OneOf(values) => Some(values.clone()),
            _ => None,
        }
    }

    /// Whether it is certainly another integer.
    pub(super) fn differs(&self, other: &Known) -> bool {
        match (self.integers(), other.integers()) {
            (Some(a), Some(b)) => a.iter().all(|value| b.binary_search(value).is_err()),
            _ => false,
        }
    }

    /// The truth value, if it is known.
    pub(super) fn truth(&self) -> Option<bool> {
        match self {
            Known::Value(value) => value.as_bool(),
            _ => None,
        }
    }

    /// In a later cycle: what holds in this one says nothing about that one.
    pub(super) fn later(self) -> Known {
        match self {
            Known::Undefined { root, .. } => Known::Undefined { root, unless: None },
            known => known,
        }
    }

    /// In cycles of which it is known whether such a thing holds.
    pub(super) fn given(self, holds: impl FnOnce(Unless) -> bool) -> Known {
        match self {
            Known::Undefined {
                unless: Some(unless),
                ..
            } if holds(unless) => Known::Defined,
            known => known,
        }
    }

    /// Defined at least where the condition holds.
    pub(super) fn defined_where(self, condition: Option<Condition>) -> Known {
        match self {
            Known::Undefined { root, unless: None } => Known::Undefined {
                root,
                unless: condition.map(Unless::Now),
            },
            known => known,
        }
    }

    /// Defined from then on where it is defined now, as what keeps its value in a fragment is.
    pub(super) fn kept(self, fragment: FragmentId) -> Known {
        match self {
            Known::Undefined {
                root,
                unless: Some(Unless::Now(condition)),
            } => Known::Undefined {
                root,
                unless: Some(Unless::Since(condition, fragment)),
            },
            known => known,
        }
    }
}

/// Integers that are told apart, at most: states of an automaton. Of more it is only known that there is a value.
const MOST: usize = 16;

fn one_of(a: &[i64], b: &[i64]) -> Known {
    let mut values = [a, b].concat();
    values.sort_unstable();
    values.dedup();
    match values.len() {
        0..=MOST => Known::OneOf(values.into()),
        _ => Known::Defined,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_are_told_apart_up_to_a_number() {
        let [one, two, three] = [1, 2, 3].map(|k| Known::value(Value::int(k)));
        let either = one.join(&two);
        assert!(either.differs(&three) && !either.differs(&two));
        assert!(!either.join(&three).differs(&three));
        assert!(!Known::Defined.differs(&three));
        let all = (0..=MOST as i64).map(|k| Known::value(Value::int(k)));
        assert_eq!(all.reduce(|a, b| a.join(&b)), Some(Known::Defined));
    }
}
