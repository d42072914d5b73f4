//! Abstract value of a flow in one phase.

use rpi_image::Value;
use rpi_net::{FragmentId, NodeId, PortRef};
use std::rc::Rc;

/// Condition on a cycle: a Boolean flow and the value that it must have.
pub(super) type Condition = (PortRef, bool);

/// Condition under which a flow that may be uninitialised has a value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum DefinedWhen {
    /// The flow has a value in the cycles in which the condition holds.
    Now(Condition),
    /// The flow has a value from the first cycle of this fragment on in which the condition holds. This is the held
    /// value of a sampled flow.
    Since(Condition, FragmentId),
}

/// Abstract value of a flow in the analysis of initialisation, an element of a lattice. Later variants allow more.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum AbstractValue {
    /// The flow is not computed in any cycle (bottom).
    Unreachable,
    /// The flow has this value.
    Value(Rc<Value>),
    /// The flow has one of these integers, in ascending order: possible states of an automaton.
    OneOf(Rc<[i64]>),
    /// The flow has a value, which is unknown.
    Defined,
    /// The flow may have no value, because a delay is not initialised.
    Undefined {
        /// Delay that is not initialised yet.
        root: NodeId,
        /// Cycles in which the flow has a value nevertheless.
        defined_when: Option<DefinedWhen>,
    },
}

impl AbstractValue {
    /// Creates the abstract value of a constant.
    pub(super) fn from_value(value: Value) -> AbstractValue {
        AbstractValue::Value(Rc::new(value))
    }

    /// Returns the least upper bound of two abstract values.
    pub(super) fn join(&self, other: &AbstractValue) -> AbstractValue {
        use AbstractValue::{Defined, Undefined, Unreachable};
        match (self, other) {
            (Unreachable, known) | (known, Unreachable) => known.clone(),
            (a, b) if a == b => a.clone(),
            (
                Undefined {
                    root,
                    defined_when: unless,
                },
                Undefined {
                    root: other,
                    defined_when: otherwise,
                },
            ) => Undefined {
                root: *root.min(other),
                defined_when: unless.filter(|unless| Some(*unless) == *otherwise),
            },
            (undefined @ Undefined { .. }, _) | (_, undefined @ Undefined { .. }) => {
                undefined.clone()
            }
            (a, b) => match (a.integers(), b.integers()) {
                (Some(a), Some(b)) => with_output_fixes(&a, &b),
                _ => Defined,
            },
        }
    }

    /// Returns the possible integers, if they are known.
    fn integers(&self) -> Option<Rc<[i64]>> {
        match self {
            AbstractValue::Value(value) => value.as_int().map(|value| [value].into()),
            AbstractValue::OneOf(values) => Some(values.clone()),
            _ => None,
        }
    }

    /// Returns whether the two values are certainly different integers.
    pub(super) fn differs(&self, other: &AbstractValue) -> bool {
        match (self.integers(), other.integers()) {
            (Some(a), Some(b)) => a.iter().all(|value| b.binary_search(value).is_err()),
            _ => false,
        }
    }

    /// Returns the Boolean value, if it is known.
    pub(super) fn truth(&self) -> Option<bool> {
        match self {
            AbstractValue::Value(value) => value.as_bool(),
            _ => None,
        }
    }

    /// Returns the abstract value in a later cycle, where conditions of this cycle no longer apply.
    pub(super) fn later(self) -> AbstractValue {
        match self {
            AbstractValue::Undefined { root, .. } => AbstractValue::Undefined {
                root,
                defined_when: None,
            },
            known => known,
        }
    }

    /// Returns the abstract value under an assumption: `Defined` if `holds` is true for the condition under which this
    /// flow has a value, else the same value.
    pub(super) fn assuming(self, holds: impl FnOnce(DefinedWhen) -> bool) -> AbstractValue {
        match self {
            AbstractValue::Undefined {
                defined_when: Some(unless),
                ..
            } if holds(unless) => AbstractValue::Defined,
            known => known,
        }
    }

    /// Marks an uninitialised value as defined where the condition holds.
    pub(super) fn defined_where(self, condition: Option<Condition>) -> AbstractValue {
        match self {
            AbstractValue::Undefined {
                root,
                defined_when: None,
            } => AbstractValue::Undefined {
                root,
                defined_when: condition.map(DefinedWhen::Now),
            },
            known => known,
        }
    }

    /// Marks a value that is defined where a condition holds as defined from then on, because the fragment holds it.
    pub(super) fn held(self, fragment: FragmentId) -> AbstractValue {
        match self {
            AbstractValue::Undefined {
                root,
                defined_when: Some(DefinedWhen::Now(condition)),
            } => AbstractValue::Undefined {
                root,
                defined_when: Some(DefinedWhen::Since(condition, fragment)),
            },
            known => known,
        }
    }
}

/// Greatest number of integers that are distinguished: states of an automaton. A larger set becomes `Defined`.
const MAX_INTEGERS: usize = 16;

fn with_output_fixes(a: &[i64], b: &[i64]) -> AbstractValue {
    let mut values = [a, b].concat();
    values.sort_unstable();
    values.dedup();
    match values.len() {
        0..=MAX_INTEGERS => AbstractValue::OneOf(values.into()),
        _ => AbstractValue::Defined,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integers_are_told_apart_up_to_a_number() {
        let [one, two, three] = [1, 2, 3].map(|k| AbstractValue::from_value(Value::int(k)));
        let either = one.join(&two);
        assert!(either.differs(&three) && !either.differs(&two));
        assert!(!either.join(&three).differs(&three));
        assert!(!AbstractValue::Defined.differs(&three));
        let all = (0..=MAX_INTEGERS as i64).map(|k| AbstractValue::from_value(Value::int(k)));
        assert_eq!(all.reduce(|a, b| a.join(&b)), Some(AbstractValue::Defined));
    }
}
