//! Run-time faults: the operations of a net that may overflow, divide by zero, use an invalid index, convert an
//! unrepresentable real, or violate a subrange or contract. Operations that an interval analysis proves safe are left
//! out.
//!
//! | file | content |
//! |---|---|
//! | `range.rs` | intervals of integers, and arithmetic on them |
//! | `intervals.rs` | interval of every flow: least fixed point |
//! | `components.rs` | loops of the net, in the order of their dependencies |
//! | `transfer.rs`, `truth.rs` | interval of a node's output |
//! | `refine.rs` | limits that a condition implies for the flows that it compares |
//! | `growth.rs` | counters, which do not overflow within a run |

mod components;
mod growth;
mod intervals;
mod range;
mod refine;
mod transfer;
mod truth;

use crate::net::{Input, Net, Node, NodeId};
use crate::passes::Schedule;
use intervals::IntervalAnalysis;
use rpi_diag::Span;
use rpi_image::{PrimDesc, Role};
use std::fmt;
use transfer::IntOperation;

/// Kind of a fault that an operation may raise at run time.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum FaultKind {
    /// The result of an integer operation does not fit in 64 bits.
    Overflow,
    /// The divisor of a division may be 0.
    Division,
    /// An index may be outside the array.
    Index,
    /// A real without an integer value, such as NaN, is converted to an integer.
    Conversion,
    /// A value may be outside its subrange.
    Subrange,
    /// An assertion or a clause of a contract is false.
    Contract,
    /// A primitive has its own kind of fault; the field is its name.
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
            FaultKind::Contract => f.write_str("violated contract"),
            FaultKind::Primitive(name) => write!(f, "fault of `{name}`"),
        }
    }
}

/// Operation of a net that is not proved free of a kind of fault.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct PossibleFault {
    /// Node of the net that may fault.
    pub node: NodeId,
    /// Location of the operation in the source text.
    pub span: Span,
    /// Kind of the fault that may occur.
    pub kind: FaultKind,
    /// Whether the operation is evaluated only in cycles in which the program needs its result.
    pub is_guarded: bool,
}

/// Returns the operations of a net that may raise a fault, in the order of the nodes. Each kind of fault occurs at most
/// once per node.
#[must_use]
pub fn possible_faults(net: &Net, schedule: &Schedule) -> Vec<PossibleFault> {
    if !net.nodes.iter().any(|node| node.desc().may_fault) {
        return Vec::new();
    }
    let known = IntervalAnalysis::new(net, schedule);
    let mut found = Vec::new();
    for (id, node) in net.node_ids().zip(&net.nodes) {
        for kind in kinds(&known, node) {
            found.push(PossibleFault {
                node: id,
                span: node.origin.span,
                kind,
                is_guarded: is_guarded(net, node),
            });
        }
    }
    found
}

/// Returns the nodes among which [`possible_faults`] finds its operations that are not guarded, in the order of the nodes. This
/// costs much less, because it looks at the kinds of the operations only, not at their values.
#[must_use]
pub fn unguarded_operations(net: &Net) -> Vec<NodeId> {
    let nodes = net.node_ids().zip(&net.nodes);
    let unguarded = nodes.filter(|(_, node)| can_fault(node.desc()) && !is_guarded(net, node));
    unguarded.map(|(id, _)| id).collect()
}

/// Returns whether a primitive can fault by itself. The faults of actuators are those of their devices.
fn can_fault(desc: &PrimDesc) -> bool {
    desc.may_fault && !matches!(desc.role, Role::Actuator(_))
}

/// Returns the kinds of faults of a node that are not proved impossible.
fn kinds(known: &IntervalAnalysis<'_>, node: &Node) -> Vec<FaultKind> {
    let desc = node.desc();
    if !can_fault(desc) {
        return Vec::new();
    }
    if IntOperation::from_primitive(desc.name).is_some() {
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

fn of_operation(known: &IntervalAnalysis<'_>, node: &Node) -> Vec<FaultKind> {
    let Some((op, a, b)) = transfer::operands(known, node) else {
        return Vec::new();
    };
    let mut kinds = Vec::new();
    if matches!(op, IntOperation::Divide | IntOperation::Modulo) && b.has_zero() {
        kinds.push(FaultKind::Division);
    }
    // `apply` ignores the divisor 0, which was reported above.
    if op.apply(a, b).is_none() {
        kinds.push(FaultKind::Overflow);
    }
    kinds
}

/// Returns whether the value of a subrange check is always within the range while the check is evaluated.
fn is_within(known: &IntervalAnalysis<'_>, node: &Node) -> bool {
    let mut limits = refine::Limits::new();
    if let Some(Input::Port(guard)) = node.inputs.first() {
        known.assume(*guard, true, &mut limits);
    }
    let of = |k: usize| known.input_where(node, k, &limits);
    let (Some(value), Some(from), Some(to)) = (of(1), of(2), of(3)) else {
        // The check is never reached.
        return true;
    };
    from.hi <= value.lo && value.hi <= to.lo
}

/// Returns whether a node is evaluated only while a condition of the program is true.
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
