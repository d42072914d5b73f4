//! Constants that are written in place, where they are used.

use std::collections::BTreeSet;

use rpi_net::{Activation, FragmentId, Net, NodeId};

use super::links;

/// Primitives that only produce a short constant.
const PLAIN: &[&str] = &["Core::BooleanValue", "Core::IntValue", "Core::DoubleValue"];

/// Returns the constant nodes that are present in every cycle in which they are read. A constant in a conditional
/// fragment is absent for outside readers while the fragment is inactive, so it keeps its name.
pub(super) fn used_in_place(net: &Net) -> BTreeSet<NodeId> {
    let is_plain = |id: &NodeId| PLAIN.contains(&net.node(*id).desc().name);
    let mut found: BTreeSet<NodeId> = net.node_ids().filter(is_plain).collect();
    let mut copy = net.clone();
    links::each(&mut copy, &mut |port, reader| {
        if is_gated(net, net.node(port.node).fragment, reader) {
            found.remove(&port.node);
        }
    });
    found
}

/// Returns whether `from` may be inactive while `reader` is active.
fn is_gated(net: &Net, from: FragmentId, reader: FragmentId) -> bool {
    let left = net.enclosing(from);
    let mut left = left.take_while(|f| net.enclosing(reader).all(|around| around != *f));
    left.any(|f| matches!(net.fragment(f).activation, Activation::When { .. }))
}
