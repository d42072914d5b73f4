//! What one leaf of a value is connected to.

use crate::typed::Leaf;
use rpi_image::Type;
use rpi_net::{NodeId, PortRef};
use smallvec::SmallVec;
use std::ops::Deref;
use std::rc::Rc;

/// The source of one leaf.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum Signal {
    /// A constant or text.
    Const(Leaf),
    /// An out-port, or an alias for one.
    Port(PortRef),
    /// An element of an array out-port, not taken out yet.
    Element(PortRef, u32),
    /// Nothing in any cycle.
    Absent,
}

/// The leaves of a value: one, as most have, lies in place; many are shared.
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

/// What in-ports of a primitive are given, and as what they take it; `None` where they are open.
pub(super) type Given = SmallVec<[Option<(Type, Wire)>; 2]>;

/// A wire of one leaf.
pub(super) fn single(signal: Signal) -> Wire {
    Wire::One(signal)
}

/// A wire without leaves.
pub(super) fn nothing() -> Wire {
    Wire::Many(Rc::from([]))
}

/// Aliases are numbered above all nodes.
const ALIAS: u32 = 1 << 31;

/// The port that stands for an alias until it is settled.
pub(super) fn alias(index: usize) -> PortRef {
    PortRef {
        node: NodeId(ALIAS | u32::try_from(index).unwrap_or(u32::MAX)),
        port: 0,
    }
}

/// The alias that a port stands for.
pub(super) fn alias_of(port: PortRef) -> Option<usize> {
    (port.node.0 & ALIAS != 0).then_some((port.node.0 & !ALIAS) as usize)
}
