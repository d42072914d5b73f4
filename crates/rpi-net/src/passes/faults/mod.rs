//! Which operations of a net can still fault while it runs: overflow, division by zero, index, conversion, subrange,
//! contract. What ranges of integers prove never to fault is left out.
//!
//! | file | idea |
//! |---|---|
//! | `range.rs` | ranges of integers, and arithmetic on them |
//! | `known.rs` | the range of every flow: the least solution |
//! | `transfer.rs`, `truth.rs` | the range of what a node gives |
//! | `refine.rs` | what a condition says of the flows that it compares |
//! | `growth.rs` | counters, which do not overflow in the time of a run |

mod growth;
mod known;
mod range;
mod refine;
mod transfer;
mod truth;

use crate::net::{Input, Net, Node, NodeId};
use crate::passes::Schedule;
use known::Known;
use rpi_diag::Span;
use rpi_image::Role;
use std::fmt;
use transfer::Op;

/// How an operation can fault.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum FaultKind {
    /// The result does not fit 64 bits.
    Overflow,
    /// A divisor is 0.
    Division,
    /// An index lies outside of its array.
    Index,
    /// A real has no integer value.
    Conversion,
    /// A value lies outside of its subrange.
    Subrange,
    /// An assertion or a clause of a contract does not hold.
    Contract,
    /// A primitive has a condition of its own.
    Primitive(&'static str),
}

impl fmt::Display for FaultKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FaultKind::Overflow => f.write_str("integer overflow"),
            FaultKind::Division => f.write_str("division by zero"),
            FaultKind::Index => f.write_str("index outside of the array"),
            FaultKind::Conversion => f.write_str("conversion of a real that has no integer value"),
            FaultKind::Subrange => f.write_str("value outside of its subrange"),
            FaultKind::Contract => f.write_str("contract that does not hold"),
            FaultKind::Primitive(name) => write!(f, "fault of `{name}`"),
        }
    }
}

/// An operation that is not proved safe.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CanFault {
    /// The node.
    pub node: NodeId,
    /// Its place in the text.
    pub span: Span,
    /// How it can fault.
    pub kind: FaultKind,
    /// Whether it counts only in the cycles in which its result is needed.
    pub guarded: bool,
}

/// The operations of a net that can fault, in the order of the net; each kind once for a node.
#[must_use]
pub fn can_fault(net: &Net, schedule: &Schedule) -> Vec<CanFault> {
    if !net.nodes.iter().any(|node| node.desc().may_fault) {
        return Vec::new();
    }
    let known = Known::new(net, schedule);
    let mut found = Vec::new();
    for (id, node) in net.node_ids().zip(&net.nodes) {
        for kind in kinds(&known, node) {
            found.push(CanFault {
                node: id,
                span: node.origin.span,
                kind,
                guarded: is_guarded(net, node),
            });
        }
    }
    found
}

/// How a node can fault, as far as nothing proves that it does not.
fn kinds(known: &Known<'_>, node: &Node) -> Vec<FaultKind> {
    let desc = node.desc();
    if !desc.may_fault || matches!(desc.role, Role::Actuator(_)) {
        return Vec::new();
    }
    if Op::of(desc.name).is_some() {
        return of_operation(known, node);
    }
    let kind = match desc.name {
        "Core::IntFromDouble" | "Rpi::GuardedIntFromDouble" => FaultKind::Conversion,
        "Rpi::IntWithin" => match is_within(known, node) {
            true => return Vec::new(),
            false => FaultKind::Subrange,
        },
        "Rpi::AssertIndex" => match truth::always_holds(known, node) {
            true => return Vec::new(),
            false => FaultKind::Index,
        },
        "Rpi::Assert" | "Rpi::Assume" => FaultKind::Contract,
        name if name.ends_with("ArrayGet") || name.ends_with("ArraySet") => FaultKind::Index,
        name => FaultKind::Primitive(name),
    };
    vec![kind]
}

fn of_operation(known: &Known<'_>, node: &Node) -> Vec<FaultKind> {
    let Some((op, a, b)) = transfer::operands(known, node) else {
        return Vec::new();
    };
    let mut kinds = Vec::new();
    if matches!(op, Op::Divide | Op::Modulo) && b.has_zero() {
        kinds.push(FaultKind::Division);
    }
    // The divisors that are left are not 0.
    if op.apply(a, b).is_none() {
        kinds.push(FaultKind::Overflow);
    }
    kinds
}

/// Whether a checked value lies in its range wherever the check counts.
fn is_within(known: &Known<'_>, node: &Node) -> bool {
    let mut limits = refine::Limits::new();
    if let Some(Input::Port(guard)) = node.inputs.first() {
        known.assume(*guard, true, &mut limits);
    }
    let of = |k: usize| known.input_where(node, k, &limits);
    let (Some(value), Some(from), Some(to)) = (of(1), of(2), of(3)) else {
        // Nothing comes there.
        return true;
    };
    from.hi <= value.lo && value.hi <= to.lo
}

/// Whether a node counts only while a condition holds.
fn is_guarded(net: &Net, node: &Node) -> bool {
    let first = node.inputs.first();
    let ports = &node.desc().inputs;
    match first {
        Some(Input::Port(_)) if ports.first().is_some_and(|port| port.name == "inActive") => true,
        Some(Input::Port(port)) if node.desc().name == "Rpi::AssertIndex" => {
            net.node(port.node).desc().name == "Rpi::BooleanImplies"
        }
        _ => false,
    }
}
