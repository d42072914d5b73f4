//! Truth tables of Boolean gates in three-valued logic with absence.
//!
//! The registry has the code of every primitive but not its logic. Proofs need the logic of the few gates from which
//! activations are built. A test compares this table with the code.

use crate::net::Node;
use rpi_image::{Presence, Role, Scalar, Type, Value};

/// Set of possible values of a flow in a cycle: true, false, absent. For other types than Booleans only the presence is
/// stored.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ValueSet(u8);

impl ValueSet {
    /// Set with the value true only. For a flow that is not a Boolean, it stands for any present value.
    pub(crate) const TRUE: ValueSet = ValueSet(1);
    /// Set with the value false only.
    pub(crate) const FALSE: ValueSet = ValueSet(2);
    /// Set with the absence only: the flow has no value in the cycle.
    pub(crate) const ABSENT: ValueSet = ValueSet(4);
    /// Empty set: contradictory conditions leave no value.
    pub(crate) const EMPTY: ValueSet = ValueSet(0);
    /// Set of the values true and false, without the absence.
    pub(crate) const PRESENT: ValueSet = ValueSet(3);

    pub(crate) const fn intersection(self, other: ValueSet) -> ValueSet {
        ValueSet(self.0 & other.0)
    }

    pub(crate) const fn union(self, other: ValueSet) -> ValueSet {
        ValueSet(self.0 | other.0)
    }

    pub(crate) const fn intersects(self, other: ValueSet) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns whether `other` contains every value of this set.
    pub(crate) const fn is_subset(self, other: ValueSet) -> bool {
        self.0 & !other.0 == 0
    }

    pub(crate) fn from_bool(value: bool) -> ValueSet {
        if value {
            ValueSet::TRUE
        } else {
            ValueSet::FALSE
        }
    }

    /// Returns the members of the set, each as a set with one member.
    pub(crate) fn members(self) -> impl Iterator<Item = ValueSet> {
        [ValueSet::TRUE, ValueSet::FALSE, ValueSet::ABSENT]
            .into_iter()
            .filter(move |m| self.intersects(*m))
    }
}

/// Truth table of a logic gate: a function from a single value of each input to the possible outputs.
type Gate = fn(&Node, &[ValueSet]) -> ValueSet;

/// Truth tables of logic gates, by the name of the primitive.
const GATES: &[(&str, Gate)] = &[
    ("Core::BooleanAnd", |_, i| and(i[0], i[1])),
    ("Core::BooleanOr", |_, i| not(and(not(i[0]), not(i[1])))),
    ("Core::BooleanNot", |_, i| not(i[0])),
    ("Core::BooleanConditional", |_, i| choose(i[0], i[1], i[2])),
    ("Core::BooleanSetNull", |_, i| {
        if i[1] == ValueSet::FALSE {
            i[0]
        } else {
            ValueSet::ABSENT
        }
    }),
    ("Core::EdgeDetection", |node, i| edge(node, i[0])),
    ("Core::Trigger", |_, i| {
        if i[1] == ValueSet::TRUE {
            ValueSet::FALSE
        } else {
            ValueSet::PRESENT
        }
    }),
    ("Rpi::BooleanXor", |_, i| strict(i, i[0] != i[1])),
    ("Rpi::BooleanEquals", |_, i| strict(i, i[0] == i[1])),
    ("Rpi::BooleanImplies", |_, i| not(and(i[0], not(i[1])))),
    ("Rpi::BooleanCoalesce", |_, i| {
        if i[0] == ValueSet::ABSENT { i[1] } else { i[0] }
    }),
];

/// Returns the truth table of a node's primitive; `None` if it has none.
pub(crate) fn gate(node: &Node) -> Option<Gate> {
    let desc = node.desc();
    if desc.role == Role::IsAbsent {
        return Some(|_, i| ValueSet::from_bool(i[0] == ValueSet::ABSENT));
    }
    GATES
        .iter()
        .find(|(name, _)| *name == desc.name)
        .map(|(_, gate)| *gate)
}

/// Returns the possible values of an output that follow from its presence rule alone. `inputs` are the possible values
/// of the connected inputs.
pub(crate) fn by_rule(rule: Presence, inputs: &[ValueSet], ty: Type) -> ValueSet {
    let present = if is_boolean(ty) {
        ValueSet::PRESENT
    } else {
        ValueSet::TRUE
    };
    match rule {
        Presence::Strict if inputs.contains(&ValueSet::ABSENT) => ValueSet::ABSENT,
        Presence::Strict if inputs.iter().any(|i| i.intersects(ValueSet::ABSENT)) => {
            present.union(ValueSet::ABSENT)
        }
        Presence::Strict | Presence::Always => present,
        Presence::IfAll | Presence::IfAny | Presence::Maybe => present.union(ValueSet::ABSENT),
    }
}

pub(crate) fn is_boolean(ty: Type) -> bool {
    ty == Type::Scalar(Scalar::Bool)
}

/// Returns the set that contains only the value of a constant.
pub(crate) fn constant(value: &Value) -> ValueSet {
    value.as_bool().map_or(ValueSet::TRUE, ValueSet::from_bool)
}

fn not(a: ValueSet) -> ValueSet {
    match a {
        ValueSet::TRUE => ValueSet::FALSE,
        ValueSet::FALSE => ValueSet::TRUE,
        other => other,
    }
}

/// Returns the conjunction of two single values in strong Kleene logic (1952).
fn and(a: ValueSet, b: ValueSet) -> ValueSet {
    match (a, b) {
        (ValueSet::FALSE, _) | (_, ValueSet::FALSE) => ValueSet::FALSE,
        (ValueSet::TRUE, ValueSet::TRUE) => ValueSet::TRUE,
        _ => ValueSet::ABSENT,
    }
}

fn choose(condition: ValueSet, yes: ValueSet, no: ValueSet) -> ValueSet {
    match condition {
        ValueSet::TRUE => yes,
        ValueSet::FALSE => no,
        _ => ValueSet::ABSENT,
    }
}

fn strict(inputs: &[ValueSet], value: bool) -> ValueSet {
    if inputs.contains(&ValueSet::ABSENT) {
        ValueSet::ABSENT
    } else {
        ValueSet::from_bool(value)
    }
}

/// Returns the possible outputs of an edge detector for a value of its input. True is possible only for the value that
/// it detects.
fn edge(node: &Node, value: ValueSet) -> ValueSet {
    let expected = node.params.first().and_then(Value::as_bool).unwrap_or(true);
    match value {
        ValueSet::ABSENT => ValueSet::ABSENT,
        value if value == ValueSet::from_bool(expected) => ValueSet::PRESENT,
        _ => ValueSet::FALSE,
    }
}

#[cfg(test)]
pub(crate) mod bench;
#[cfg(test)]
mod tests;
