//! What one leaf of a value is connected to.

use crate::typed::Leaf;
use rpi_net::{NodeId, PortRef};
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

/// The leaves of a value.
pub(super) type Wire = Rc<[Signal]>;

/// A wire of one leaf.
pub(super) fn single(signal: Signal) -> Wire {
    Rc::from([signal])
}

/// A wire without leaves.
pub(super) fn nothing() -> Wire {
    Rc::from([])
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
