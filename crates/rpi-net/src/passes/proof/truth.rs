//! Truth tables of Boolean gates in three-valued logic with absence.
//!
//! The registry has the code of every primitive but not its logic. Proofs need the logic of the few gates from which
//! activations are built. A test compares this table with the code.

use crate::net::Node;
use rpi_image::{Presence, Role, Scalar, Type, Value};

/// Set of possible values of a flow in a cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Set(u8);

impl Set {
    /// True; for a flow that is not a Boolean: present.
    pub(crate) const TRUE: Set = Set(1);
    pub(crate) const FALSE: Set = Set(2);
    pub(crate) const ABSENT: Set = Set(4);
    pub(crate) const NONE: Set = Set(0);
    /// Present with any value.
    pub(crate) const PRESENT: Set = Set(3);

    pub(crate) const fn and(self, other: Set) -> Set {
        Set(self.0 & other.0)
    }

    pub(crate) const fn or(self, other: Set) -> Set {
        Set(self.0 | other.0)
    }

    pub(crate) const fn has(self, other: Set) -> bool {
        self.0 & other.0 != 0
    }

    /// Whether the set is a subset of `other`.
    pub(crate) const fn within(self, other: Set) -> bool {
        self.0 & !other.0 == 0
    }

    pub(crate) fn of(value: bool) -> Set {
        if value { Set::TRUE } else { Set::FALSE }
    }

    /// Members of the set as singletons.
    pub(crate) fn members(self) -> impl Iterator<Item = Set> {
        [Set::TRUE, Set::FALSE, Set::ABSENT]
            .into_iter()
            .filter(move |m| self.has(*m))
    }
}

/// Possible outputs of a gate for single values of its inputs.
type Gate = fn(&Node, &[Set]) -> Set;

/// Gates with a truth table, by registered name.
const GATES: &[(&str, Gate)] = &[
    ("Core::BooleanAnd", |_, i| and(i[0], i[1])),
    ("Core::BooleanOr", |_, i| not(and(not(i[0]), not(i[1])))),
    ("Core::BooleanNot", |_, i| not(i[0])),
    ("Core::BooleanConditional", |_, i| choose(i[0], i[1], i[2])),
    ("Core::BooleanSetNull", |_, i| {
        if i[1] == Set::FALSE {
            i[0]
        } else {
            Set::ABSENT
        }
    }),
    ("Core::EdgeDetection", |node, i| edge(node, i[0])),
    ("Core::Trigger", |_, i| {
        if i[1] == Set::TRUE {
            Set::FALSE
        } else {
            Set::PRESENT
        }
    }),
    ("Rpi::BooleanXor", |_, i| strict(i, i[0] != i[1])),
    ("Rpi::BooleanEquals", |_, i| strict(i, i[0] == i[1])),
    ("Rpi::BooleanImplies", |_, i| not(and(i[0], not(i[1])))),
    ("Rpi::BooleanCoalesce", |_, i| {
        if i[0] == Set::ABSENT { i[1] } else { i[0] }
    }),
];

/// Truth table of a node's gate, if it has one.
pub(crate) fn gate(node: &Node) -> Option<Gate> {
    let desc = node.desc();
    if desc.role == Role::IsAbsent {
        return Some(|_, i| Set::of(i[0] == Set::ABSENT));
    }
    GATES
        .iter()
        .find(|(name, _)| *name == desc.name)
        .map(|(_, gate)| *gate)
}

/// Possible values of an output by its presence rule alone, for the sets of its connected inputs.
pub(crate) fn by_rule(rule: Presence, inputs: &[Set], ty: Type) -> Set {
    let present = if is_boolean(ty) {
        Set::PRESENT
    } else {
        Set::TRUE
    };
    match rule {
        Presence::Strict if inputs.contains(&Set::ABSENT) => Set::ABSENT,
        Presence::Strict if inputs.iter().any(|i| i.has(Set::ABSENT)) => present.or(Set::ABSENT),
        Presence::Strict | Presence::Always => present,
        Presence::IfAll | Presence::IfAny | Presence::Maybe => present.or(Set::ABSENT),
    }
}

pub(crate) fn is_boolean(ty: Type) -> bool {
    ty == Type::One(Scalar::Bool)
}

/// Value of a constant as a set.
pub(crate) fn constant(value: &Value) -> Set {
    value.as_bool().map_or(Set::TRUE, Set::of)
}

fn not(a: Set) -> Set {
    match a {
        Set::TRUE => Set::FALSE,
        Set::FALSE => Set::TRUE,
        other => other,
    }
}

/// Conjunction in strong Kleene logic (1952).
fn and(a: Set, b: Set) -> Set {
    match (a, b) {
        (Set::FALSE, _) | (_, Set::FALSE) => Set::FALSE,
        (Set::TRUE, Set::TRUE) => Set::TRUE,
        _ => Set::ABSENT,
    }
}

fn choose(condition: Set, yes: Set, no: Set) -> Set {
    match condition {
        Set::TRUE => yes,
        Set::FALSE => no,
        _ => Set::ABSENT,
    }
}

fn strict(inputs: &[Set], value: bool) -> Set {
    if inputs.contains(&Set::ABSENT) {
        Set::ABSENT
    } else {
        Set::of(value)
    }
}

/// Output of an edge detector: it may be true only if the input has the value that it detects.
fn edge(node: &Node, value: Set) -> Set {
    let wanted = node.params.first().and_then(Value::as_bool).unwrap_or(true);
    match value {
        Set::ABSENT => Set::ABSENT,
        value if value == Set::of(wanted) => Set::PRESENT,
        _ => Set::FALSE,
    }
}

#[cfg(test)]
pub(crate) mod bench;
#[cfg(test)]
mod tests;
