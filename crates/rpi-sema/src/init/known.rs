//! What is known of a flow in one phase.

use rpi_image::Value;
use rpi_net::{NodeId, PortRef};
use std::rc::Rc;

/// A condition of the same cycle: a Boolean flow, and which value of it is meant.
pub(super) type Condition = (PortRef, bool);

/// What is known of a flow: each case allows more than the one before.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Known {
    /// There is no such cycle.
    Never,
    /// This value.
    Value(Rc<Value>),
    /// Some value.
    Defined,
    /// It may have none.
    Undefined {
        /// The delay that has no value yet.
        root: NodeId,
        /// It has one in the cycles in which this holds.
        unless: Option<Condition>,
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
            _ => Defined,
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

    /// In cycles in which the conditions hold.
    pub(super) fn given(self, holds: impl FnOnce() -> Vec<Condition>) -> Known {
        match self {
            Known::Undefined {
                unless: Some(unless),
                ..
            } if holds().contains(&unless) => Known::Defined,
            known => known,
        }
    }

    /// Defined at least where the condition holds.
    pub(super) fn defined_where(self, condition: Option<Condition>) -> Known {
        match self {
            Known::Undefined { root, unless: None } => Known::Undefined {
                root,
                unless: condition,
            },
            known => known,
        }
    }
}
