//! Order of evaluation of the nodes in the fixpoint iteration, and the nodes to re-evaluate after a change.

use crate::hash::FastMap;
use rpi_image::Role;
use rpi_net::passes::Readers;
use rpi_net::{Activation, FragmentId, Net, NodeId};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Returns for each node its position in an order in which each node comes after the nodes that it reads. Dependency
/// cycles are cut at an arbitrary node.
fn topological_order(net: &Net) -> Vec<u32> {
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

/// Nodes to be evaluated: first all nodes of a net once, each after the nodes that it reads, then the nodes that were
/// added again.
pub(super) struct Worklist {
    order: Vec<u32>,
    sorted: Vec<NodeId>,
    /// Number of nodes of the first round that have been returned.
    visited_count: u32,
    /// For each position in the order, whether its node is queued for a further evaluation.
    is_queued: Vec<bool>,
    queue: BinaryHeap<Reverse<u32>>,
}

impl Worklist {
    pub(super) fn new(net: &Net) -> Self {
        let order = topological_order(net);
        let mut sorted = vec![NodeId(0); net.nodes.len()];
        for id in net.node_ids() {
            sorted[order[id.index()] as usize] = id;
        }
        Worklist {
            is_queued: vec![false; sorted.len()],
            queue: BinaryHeap::new(),
            visited_count: 0,
            order,
            sorted,
        }
    }

    pub(super) fn next(&mut self) -> Option<NodeId> {
        let earlier = self
            .queue
            .peek()
            .is_some_and(|place| place.0 < self.visited_count);
        if !earlier && (self.visited_count as usize) < self.sorted.len() {
            self.visited_count += 1;
            return Some(self.sorted[self.visited_count as usize - 1]);
        }
        let place = self.queue.pop()?.0 as usize;
        self.is_queued[place] = false;
        Some(self.sorted[place])
    }

    /// Adds nodes for a further evaluation. Nodes that the first round has not returned yet are not added.
    pub(super) fn add(&mut self, nodes: &[NodeId]) {
        for id in nodes {
            let place = self.order[id.index()];
            if place < self.visited_count
                && !std::mem::replace(&mut self.is_queued[place as usize], true)
            {
                self.queue.push(Reverse(place));
            }
        }
    }
}

/// Dependencies of a net: for each node, the nodes that read its outputs, and the fragments that it activates.
pub(super) struct Dependents {
    users: Readers,
    activated_by: FastMap<NodeId, Vec<FragmentId>>,
    /// For each fragment, the nodes that read flows from the other side of its border.
    across: Vec<Vec<NodeId>>,
}

impl Dependents {
    pub(super) fn new(net: &Net) -> Self {
        let mut readers = Dependents {
            users: Readers::new(net),
            activated_by: FastMap::default(),
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
            for fragment in net.ancestors(source).chain(net.ancestors(node.fragment)) {
                self.across[fragment.index()].push(id);
            }
        }
    }

    pub(super) fn users(&self, id: NodeId) -> &[NodeId] {
        self.users.readers_of(id)
    }

    pub(super) fn sample_activated_case(&self, id: NodeId) -> &[FragmentId] {
        self.activated_by.get(&id).map_or(&[], Vec::as_slice)
    }

    pub(super) fn across(&self, fragment: FragmentId) -> &[NodeId] {
        &self.across[fragment.index()]
    }
}
