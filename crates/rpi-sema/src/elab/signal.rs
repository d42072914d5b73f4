//! Signals: sources of the leaves of values.

use crate::typed::Leaf;
use rpi_image::Type;
use rpi_net::{NodeId, PortRef};
use smallvec::SmallVec;
use std::ops::Deref;
use std::rc::Rc;

/// Source of the value of one leaf (scalar part) of a flow or expression in the net.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Signal {
    /// Constant value, the same in every cycle.
    Const(Leaf),
    /// Out-port of a net node, or a placeholder port that stands for a signal not known yet.
    Port(PortRef),
    /// Element of an array out-port, with its index. The element has not been extracted by a net node.
    Element(PortRef, u32),
    /// Value that is absent in every cycle.
    Absent,
}

/// Signals of all leaves (scalar parts) of a value. A single signal, the most frequent case, is stored inline; several
/// signals are shared.
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

/// For each input of a primitive, its type and the signals of its value; `None` for an input that is not connected.
pub(super) type PrimInputs = SmallVec<[Option<(Type, Wire)>; 2]>;

/// Returns the signals of a value with one leaf (scalar part).
pub(super) fn single_wire(signal: Signal) -> Wire {
    Wire::One(signal)
}

/// Returns the signals of a value without leaves (scalar parts), also used in place of a value after an error.
pub(super) fn empty_wire() -> Wire {
    Wire::Many(Rc::from([]))
}

/// Bit in the number of a net node that marks a placeholder port, which belongs to no node.
const ALIAS: u32 = 1 << 31;

/// Returns the placeholder port with this index, which stands for a signal until the signal is known.
pub(super) fn resolve_alias(index: usize) -> PortRef {
    PortRef {
        node: NodeId(ALIAS | u32::try_from(index).unwrap_or(u32::MAX)),
        port: 0,
    }
}

/// Returns the index of a placeholder port; `None` for a port of a net node.
pub(super) fn alias_of(port: PortRef) -> Option<usize> {
    (port.node.0 & ALIAS != 0).then_some((port.node.0 & !ALIAS) as usize)
}
