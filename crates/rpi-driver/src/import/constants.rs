//! Constants that stand where they are used.

use std::collections::BTreeSet;

use rpi_net::{Activation, FragmentId, Net, NodeId};

use super::links;

/// Primitives that are nothing but a short constant.
const PLAIN: &[&str] = &["Core::BooleanValue", "Core::IntValue", "Core::DoubleValue"];

/// The nodes that are nothing but a constant, and there in all cycles in which they are read. One in a fragment that may
/// be inactive is absent then to those outside: it keeps its name.
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

/// Whether a fragment may be inactive while one that reads it is active.
fn is_gated(net: &Net, from: FragmentId, reader: FragmentId) -> bool {
    let left = net.enclosing(from);
    let mut left = left.take_while(|f| net.enclosing(reader).all(|around| around != *f));
    left.any(|f| matches!(net.fragment(f).activation, Activation::When { .. }))
}
