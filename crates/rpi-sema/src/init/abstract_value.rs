//! Abstract value of a flow in one phase.

use rpi_image::Value;
use rpi_net::{FragmentId, NodeId, PortRef};
use std::rc::Rc;

/// Condition on a cycle: a Boolean port of the net, and the value that it must have.
pub(super) type Condition = (PortRef, bool);

/// Condition under which a flow that may be uninitialised has a value nevertheless.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum DefinedWhen {
    /// The flow has a value in each cycle in which the condition holds.
    Now(Condition),
    /// The flow has a value from the first cycle of this fragment on in which the condition holds. An example is the
    /// held value of a sampled flow.
    Since(Condition, FragmentId),
}

/// Abstract value of a flow in the analysis of initialisation. The values form a lattice, in which later variants
/// include more concrete values.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum AbstractValue {
    /// The flow is not computed in any cycle of the phase (bottom of the lattice).
    Unreachable,
    /// The flow has exactly this value.
    Value(Rc<Value>),
    /// The flow has one of these integers, which are in ascending order. An example is the state of an automaton.
    OneOf(Rc<[i64]>),
    /// The flow has a value, but the value is unknown.
    Defined,
    /// The flow may have no value, because it depends on a delay that is not initialised.
    Undefined {
        /// Delay that is not initialised, as a node of the net.
        root: NodeId,
        /// Condition under which the flow has a value nevertheless; `None` if there is no such cycle.
        defined_when: Option<DefinedWhen>,
    },
}

impl AbstractValue {
    /// Creates the abstract value of a constant.
    pub(super) fn from_value(value: Value) -> AbstractValue {
        AbstractValue::Value(Rc::new(value))
    }

    /// Returns the least upper bound of two abstract values: the smallest one that includes both.
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

    /// Returns the possible integers in ascending order; `None` if they are not known.
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

    /// Returns the Boolean value; `None` if it is not known.
    pub(super) fn truth(&self) -> Option<bool> {
        match self {
            AbstractValue::Value(value) => value.as_bool(),
            _ => None,
        }
    }

    /// Returns the abstract value as seen in a later cycle. A condition under which the flow has a value in this cycle
    /// no longer applies.
    pub(super) fn later(self) -> AbstractValue {
        match self {
            AbstractValue::Undefined { root, .. } => AbstractValue::Undefined {
                root,
                defined_when: None,
            },
            known => known,
        }
    }

    /// Returns `Defined` if the flow has a value under a condition for which `holds` returns true; otherwise the
    /// abstract value itself.
    pub(super) fn assuming(self, holds: impl FnOnce(DefinedWhen) -> bool) -> AbstractValue {
        match self {
            AbstractValue::Undefined {
                defined_when: Some(unless),
                ..
            } if holds(unless) => AbstractValue::Defined,
            known => known,
        }
    }

    /// Returns the abstract value with the addition that the flow has a value in cycles in which the condition holds.
    /// Only a value that may be uninitialised, and has no such condition yet, changes.
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

    /// Returns the abstract value of a flow that holds its value in this fragment: if it has a value in cycles in which
    /// a condition holds, it has one from the first such cycle on.
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

/// Maximum number of integers that are distinguished, such as states of an automaton. A larger set becomes `Defined`.
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
