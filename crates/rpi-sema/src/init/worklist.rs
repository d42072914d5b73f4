//! Order of evaluation of the nodes in the fixpoint iteration, and the nodes to re-evaluate after a change.

use crate::hash::Map;
use rpi_image::Role;
use rpi_net::passes::Users;
use rpi_net::{Activation, FragmentId, Net, NodeId};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Returns for each node its position in a topological order, sources first. Dependency cycles are cut at an arbitrary
/// node.
fn order(net: &Net) -> Vec<u32> {
    let mut place = vec![u32::MAX; net.nodes.len()];
    let mut next = 0;
    let mut open = Vec::new();
    for start in net.node_ids() {
        open.push((start, false));
        while let Some((id, done)) = open.pop() {
            if done {
                place[id.index()] = next;
                next += 1;
                continue;
            }
            if place[id.index()] != u32::MAX {
                continue;
            }
            // Any other value marks the node as visited while it is still open.
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

/// Worklist of nodes, sources first: all of them once, then those that were added again.
pub(super) struct Agenda {
    order: Vec<u32>,
    sorted: Vec<NodeId>,
    /// Number of nodes of the first round that have been returned.
    done: u32,
    /// For each position, whether its node is queued again.
    waits: Vec<bool>,
    again: BinaryHeap<Reverse<u32>>,
}

impl Agenda {
    pub(super) fn all(net: &Net) -> Self {
        let order = order(net);
        let mut sorted = vec![NodeId(0); net.nodes.len()];
        for id in net.node_ids() {
            sorted[order[id.index()] as usize] = id;
        }
        Agenda {
            waits: vec![false; sorted.len()],
            again: BinaryHeap::new(),
            done: 0,
            order,
            sorted,
        }
    }

    pub(super) fn next(&mut self) -> Option<NodeId> {
        let earlier = self.again.peek().is_some_and(|place| place.0 < self.done);
        if !earlier && (self.done as usize) < self.sorted.len() {
            self.done += 1;
            return Some(self.sorted[self.done as usize - 1]);
        }
        let place = self.again.pop()?.0 as usize;
        self.waits[place] = false;
        Some(self.sorted[place])
    }

    /// Queues nodes again. Nodes that the first round has still to return are not queued.
    pub(super) fn add(&mut self, nodes: &[NodeId]) {
        for id in nodes {
            let place = self.order[id.index()];
            if place < self.done && !std::mem::replace(&mut self.waits[place as usize], true) {
                self.again.push(Reverse(place));
            }
        }
    }
}

/// Dependents of nodes and fragments.
pub(super) struct Readers {
    of: Users,
    activated_by: Map<NodeId, Vec<FragmentId>>,
    /// For each fragment, the nodes that read across its border.
    across: Vec<Vec<NodeId>>,
}

impl Readers {
    pub(super) fn new(net: &Net) -> Self {
        let mut readers = Readers {
            of: Users::new(net),
            activated_by: Map::default(),
            across: vec![Vec::new(); net.fragments.len()],
        };
        for id in net.node_ids() {
            readers.add(net, id);
        }
        for fragment in net.fragment_ids() {
            if let Activation::When { condition, .. } = net.fragment(fragment).activation {
                let activated = readers.activated_by.entry(condition.node);
                activated.or_default().push(fragment);
            }
        }
        readers
    }

    fn add(&mut self, net: &Net, id: NodeId) {
        let node = net.node(id);
        for port in node.inputs.iter().filter_map(|input| input.port()) {
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
        self.of.of(id)
    }

    pub(super) fn activated_by(&self, id: NodeId) -> &[FragmentId] {
        self.activated_by.get(&id).map_or(&[], Vec::as_slice)
    }

    pub(super) fn across(&self, fragment: FragmentId) -> &[NodeId] {
        &self.across[fragment.index()]
    }
}
