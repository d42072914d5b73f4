//! Constants that are written in place, where they are used.

use std::collections::BTreeSet;

use rpi_net::{Activation, FragmentId, Net, NodeId};

use super::links;

/// Primitives that only produce a short constant, which an imported program writes as a literal.
const CONSTANT_PRIMITIVES: &[&str] = &["Core::BooleanValue", "Core::IntValue", "Core::DoubleValue"];

/// Returns the constant nodes that become literals where they are read: those that are present in every cycle in which
/// they are read. A constant in a conditional fragment is absent for outside readers while the fragment is inactive, so
/// it remains a named flow.
pub(super) fn inlined_constants(net: &Net) -> BTreeSet<NodeId> {
    let is_plain = |id: &NodeId| CONSTANT_PRIMITIVES.contains(&net.node(*id).desc().name);
    let mut found: BTreeSet<NodeId> = net.node_ids().filter(is_plain).collect();
    let mut copy = net.clone();
    links::for_each_link(&mut copy, &mut |port, reader| {
        if may_be_inactive(net, net.node(port.node).fragment, reader) {
            found.remove(&port.node);
        }
    });
    found
}

/// Returns whether the fragment `from` may be inactive in a cycle in which the fragment `reader` is active.
fn may_be_inactive(net: &Net, from: FragmentId, reader: FragmentId) -> bool {
    let left = net.ancestors(from);
    let mut left = left.take_while(|f| net.ancestors(reader).all(|around| around != *f));
    left.any(|f| matches!(net.fragment(f).activation, Activation::When { .. }))
}
