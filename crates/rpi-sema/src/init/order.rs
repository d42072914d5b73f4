//! In which order nodes are looked at, and who has to be looked at again.

use rpi_image::Role;
use rpi_net::{Activation, FragmentId, Net, NodeId};

/// For each node its place in an order in which sources come first, as far as there is one.
pub(super) fn order(net: &Net) -> Vec<u32> {
    let mut place = vec![u32::MAX; net.nodes.len()];
    let mut next = 0;
    for start in net.node_ids() {
        let mut open = vec![(start, false)];
        while let Some((id, done)) = open.pop() {
            if done {
                place[id.index()] = next;
                next += 1;
                continue;
            }
            if place[id.index()] != u32::MAX {
                continue;
            }
            // Any value keeps it from being met again while it is open.
            place[id.index()] = 0;
            open.push((id, true));
            let node = net.node(id);
            if node.desc().role == Role::Delay {
                continue;
            }
            let sources = node.inputs.iter().filter_map(|input| input.port());
            let fresh = sources.filter(|port| place[port.node.index()] == u32::MAX);
            open.extend(fresh.map(|port| (port.node, false)));
        }
    }
    place
}

/// Who reads a flow.
pub(super) struct Readers {
    of: Vec<Vec<NodeId>>,
    activated_by: Vec<Vec<FragmentId>>,
    /// For each fragment the nodes that read across its border.
    across: Vec<Vec<NodeId>>,
}

impl Readers {
    pub(super) fn new(net: &Net) -> Self {
        let mut readers = Readers {
            of: vec![Vec::new(); net.nodes.len()],
            activated_by: vec![Vec::new(); net.nodes.len()],
            across: vec![Vec::new(); net.fragments.len()],
        };
        for id in net.node_ids() {
            readers.add(net, id);
        }
        for fragment in net.fragment_ids() {
            if let Activation::When { condition, .. } = net.fragment(fragment).activation {
                readers.activated_by[condition.node.index()].push(fragment);
            }
        }
        readers
    }

    fn add(&mut self, net: &Net, id: NodeId) {
        let node = net.node(id);
        for port in node.inputs.iter().filter_map(|input| input.port()) {
            self.of[port.node.index()].push(id);
            let source = net.node(port.node).fragment;
            if source == node.fragment {
                continue;
            }
            for fragment in net.enclosing(source).chain(net.enclosing(node.fragment)) {
                self.across[fragment.index()].push(id);
            }
        }
    }

    pub(super) fn of(&self, id: NodeId) -> &[NodeId] {
        &self.of[id.index()]
    }

    pub(super) fn activated_by(&self, id: NodeId) -> &[FragmentId] {
        &self.activated_by[id.index()]
    }

    pub(super) fn across(&self, fragment: FragmentId) -> &[NodeId] {
        &self.across[fragment.index()]
    }
}
