//! Semantics of the primitives that handle absence themselves, and of those with a small state.
//!
//! A test compares all of them with the code of the primitives.

use super::domain::{Domain, Flow};
use crate::net::Node;
use rpi_image::{Role, Type, Value};

/// Primitive whose presence and value the model checker computes exactly: a logic gate, or a primitive with state such
/// as a latch.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Gate {
    And,
    Or,
    Implies,
    IfThenElse,
    SetNull,
    Coalesce,
    IsAbsent,
    // Primitives with state:
    Edge,
    Latch,
    Snapshot,
    Hold,
}

/// Types that occur as prefixes in the names of primitives, such as `IntHold`.
const TYPES: [&str; 9] = [
    "Boolean", "Int", "Double", "Time", "Vector", "Rotation", "Frame", "Twist", "Wrench",
];

impl Gate {
    pub(super) fn from_node(node: &Node) -> Option<Gate> {
        let desc = node.desc();
        if desc.role == Role::IsAbsent {
            return Some(Gate::IsAbsent);
        }
        if desc.role != Role::Compute {
            return None;
        }
        match desc.name {
            "Core::BooleanAnd" => return Some(Gate::And),
            "Core::BooleanOr" => return Some(Gate::Or),
            "Rpi::BooleanImplies" => return Some(Gate::Implies),
            "Core::EdgeDetection" => return Some(Gate::Edge),
            "Core::Trigger" => return Some(Gate::Latch),
            _ => {}
        }
        let (_, name) = desc.name.split_once("::")?;
        let operation = TYPES.iter().find_map(|ty| name.strip_prefix(ty))?;
        match operation {
            "Conditional" => Some(Gate::IfThenElse),
            "SetNull" => Some(Gate::SetNull),
            "Coalesce" => Some(Gate::Coalesce),
            "Snapshot" => Some(Gate::Snapshot),
            "Hold" => Some(Gate::Hold),
            _ => None,
        }
    }

    /// Returns the initial contents of the primitive's memory slots; empty for a stateless primitive.
    pub(super) fn initial_state(self, node: &Node) -> Vec<Value> {
        let no = Value::bool(false);
        let neutral = || {
            let ty = node.outputs.first().copied();
            Value::neutral(ty.unwrap_or(Type::Scalar(rpi_image::Scalar::Bool)))
        };
        match self {
            Gate::Edge => vec![no],
            Gate::Latch => vec![no.clone(), no],
            Gate::Hold => vec![no, neutral()],
            Gate::Snapshot => vec![node.params.first().cloned().unwrap_or_else(neutral)],
            _ => Vec::new(),
        }
    }

    /// Returns the output of a stateless primitive in a cycle in which its fragment is active; `None` for a primitive
    /// with state.
    pub(super) fn output<D: Domain>(self, domain: &mut D, inputs: &[Flow<D>]) -> Option<Flow<D>> {
        Some(match (self, inputs) {
            (Gate::And, [a, b]) => and(domain, a, b),
            (Gate::Or, [a, b]) => or(domain, a, b),
            (Gate::Implies, [a, b]) => {
                let a = not(domain, a);
                or(domain, &a, b)
            }
            (Gate::IfThenElse, [condition, yes, no]) => {
                let holds = domain.truth(&condition.value);
                let chosen = domain.choose_flow(holds, yes, no);
                Flow {
                    present: domain.and(condition.present, chosen.present),
                    value: chosen.value,
                }
            }
            (Gate::SetNull, [value, null]) => {
                let null_value = domain.truth(&null.value);
                let keeps = domain.not(null_value);
                Flow {
                    present: domain.all([value.present, null.present, keeps]),
                    value: value.value.clone(),
                }
            }
            (Gate::Coalesce, [first, second]) => domain
                .choose_flow(first.present, first, second)
                .with_presence(domain, first.present, second.present),
            (Gate::IsAbsent, [value, ..]) => {
                let absent = domain.not(value.present);
                always_present(domain, absent)
            }
            _ => return None,
        })
    }

    /// Returns the output of a primitive with state and its next state; `None` for a stateless primitive. `memory` is
    /// its state at the start of the cycle.
    pub(super) fn step<D: Domain>(
        self,
        domain: &mut D,
        node: &Node,
        inputs: &[Flow<D>],
        memory: &[D::Value],
    ) -> Option<(Flow<D>, Vec<D::Value>)> {
        match (self, inputs, memory) {
            (Gate::Edge, [value], [there]) => Some(edge(domain, node, value, there)),
            (Gate::Latch, [on, off, reset], [active, done]) => {
                Some(latch(domain, [on, off, reset], [active, done]))
            }
            (Gate::Snapshot, [take, value], [held]) => {
                let takes = domain.is_true(take);
                let takes = domain.and(takes, value.present);
                let held = domain.choose(takes, &value.value, held);
                let present = domain.bit(true);
                let output = Flow {
                    present,
                    value: held.clone(),
                };
                Some((output, vec![held]))
            }
            (Gate::Hold, [value, initial], [seen, last]) => {
                let before = domain.truth(seen);
                let seen = domain.or(before, value.present);
                let last = domain.choose(value.present, &value.value, last);
                let output = Flow {
                    present: domain.or(seen, initial.present),
                    value: domain.choose(seen, &last, &initial.value),
                };
                let seen = domain.boolean(seen);
                Some((output, vec![seen, last]))
            }
            _ => None,
        }
    }
}

impl<D: Domain> Flow<D> {
    /// Returns a flow with the same value that is present if `first` or `second` holds.
    fn with_presence(self, domain: &mut D, first: D::Bool, second: D::Bool) -> Flow<D> {
        Flow {
            present: domain.or(first, second),
            value: self.value,
        }
    }
}

/// Returns a Boolean flow that is present in the cycle and has the value `bit`.
pub(super) fn always_present<D: Domain>(domain: &mut D, bit: D::Bool) -> Flow<D> {
    Flow {
        present: domain.bit(true),
        value: domain.boolean(bit),
    }
}

fn not<D: Domain>(domain: &mut D, a: &Flow<D>) -> Flow<D> {
    let value = domain.truth(&a.value);
    let value = domain.not(value);
    Flow {
        present: a.present,
        value: domain.boolean(value),
    }
}

/// Returns the conjunction in strong Kleene logic (1952): false if one operand is false, even if the other is absent.
fn and<D: Domain>(domain: &mut D, a: &Flow<D>, b: &Flow<D>) -> Flow<D> {
    let values = [a, b].map(|x| domain.truth(&x.value));
    let refuted = [0, 1].map(|k| {
        let wrong = domain.not(values[k]);
        domain.and([a, b][k].present, wrong)
    });
    let one_is_false = domain.or(refuted[0], refuted[1]);
    let both_present = domain.and(a.present, b.present);
    let value = domain.not(one_is_false);
    Flow {
        present: domain.or(one_is_false, both_present),
        value: domain.boolean(value),
    }
}

fn or<D: Domain>(domain: &mut D, a: &Flow<D>, b: &Flow<D>) -> Flow<D> {
    let (a, b) = (not(domain, a), not(domain, b));
    let neither = and(domain, &a, &b);
    not(domain, &neither)
}

fn edge<D: Domain>(
    domain: &mut D,
    node: &Node,
    value: &Flow<D>,
    there: &D::Value,
) -> (Flow<D>, Vec<D::Value>) {
    let rising = node.params.first().and_then(Value::as_bool).unwrap_or(true);
    let truth = domain.truth(&value.value);
    let is_there = if rising { truth } else { domain.not(truth) };
    let was_there = domain.truth(there);
    let was_not = domain.not(was_there);
    let changed = domain.and(is_there, was_not);
    let kept = domain.choose_bit(value.present, is_there, was_there);
    let output = Flow {
        present: value.present,
        value: domain.boolean(changed),
    };
    (output, vec![domain.boolean(kept)])
}

fn latch<D: Domain>(
    domain: &mut D,
    inputs: [&Flow<D>; 3],
    memory: [&D::Value; 2],
) -> (Flow<D>, Vec<D::Value>) {
    let [on, off, reset] = inputs.map(|input| domain.is_true(input));
    let armed = domain.not(reset);
    let [active, done] = memory.map(|cell| domain.truth(cell));
    let (active, done) = (domain.and(active, armed), domain.and(done, armed));
    let requested = domain.or(active, on);
    let (not_done, not_off) = (domain.not(done), domain.not(off));
    let active = domain.all([requested, not_done, not_off]);
    let done = domain.or(done, off);
    let output = always_present(domain, active);
    (output, vec![domain.boolean(active), domain.boolean(done)])
}

#[cfg(test)]
mod tests;
