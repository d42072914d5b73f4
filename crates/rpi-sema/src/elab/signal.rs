//! Signals: sources of the leaves of values.

use crate::typed::Leaf;
use rpi_image::Type;
use rpi_net::{NodeId, PortRef};
use smallvec::SmallVec;
use std::ops::Deref;
use std::rc::Rc;

/// Source of the value of one leaf (scalar part) of a flow in the net.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Signal {
    /// Constant or text, the same in every cycle.
    Const(Leaf),
    /// Out-port of a node, or an alias that stands for a signal not known yet.
    Port(PortRef),
    /// Element of an array out-port that has not been extracted yet.
    Element(PortRef, u32),
    /// Value that is absent in every cycle.
    Absent,
}

/// Signals of all leaves (scalar parts) of a value. A single one, the most frequent case, is stored inline; several are
/// shared.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Wire {
    One(Signal),
    Many(Rc<[Signal]>),
}

impl Deref for Wire {
    type Target = [Signal];

    fn deref(&self) -> &[Signal] {
        match self {
            Wire::One(signal) => std::slice::from_ref(signal),
            Wire::Many(signals) => signals,
        }
    }
}

impl FromIterator<Signal> for Wire {
    fn from_iter<I: IntoIterator<Item = Signal>>(signals: I) -> Wire {
        let mut rest = signals.into_iter();
        match (rest.next(), rest.next()) {
            (Some(one), None) => Wire::One(one),
            (first, second) => Wire::Many(first.into_iter().chain(second).chain(rest).collect()),
        }
    }
}

impl From<Vec<Signal>> for Wire {
    fn from(signals: Vec<Signal>) -> Wire {
        match signals.len() {
            1 => signals.into_iter().collect(),
            _ => Wire::Many(signals.into()),
        }
    }
}

impl From<&[Signal]> for Wire {
    fn from(signals: &[Signal]) -> Wire {
        signals.iter().cloned().collect()
    }
}

/// Type and signals of each input of a primitive; `None` for an unconnected one.
pub(super) type PrimInputs = SmallVec<[Option<(Type, Wire)>; 2]>;

/// Returns the signals of a value with one leaf.
pub(super) fn single_wire(signal: Signal) -> Wire {
    Wire::One(signal)
}

/// Returns the signals of a value without leaves.
pub(super) fn empty_wire() -> Wire {
    Wire::Many(Rc::from([]))
}

/// Bit in a node number that marks an alias.
const ALIAS: u32 = 1 << 31;

/// Returns the port that represents an alias until it is resolved.
pub(super) fn resolve_alias(index: usize) -> PortRef {
    PortRef {
        node: NodeId(ALIAS | u32::try_from(index).unwrap_or(u32::MAX)),
        port: 0,
    }
}

/// Returns the index of the alias that a port represents; none for a port of a node.
pub(super) fn alias_of(port: PortRef) -> Option<usize> {
    (port.node.0 & ALIAS != 0).then_some((port.node.0 & !ALIAS) as usize)
}
