//! Strongly connected components of the flows whose intervals are analysed, each after those that it depends on.
//!
//! A fixed point is iterated for one component at a time (Bourdoncle 1993, Efficient chaotic iteration strategies with
//! widenings), because an iteration over a whole net would repeat the work of all nodes until the last loop is stable.
//! The components are found by the algorithm of Tarjan (1972), with a stack of its own, so that the length of a chain of
//! nodes is not limited by the stack of the thread.

use super::intervals::full_range;
use crate::net::{Input, Net, NodeId};

/// Mark of a node that the search has not reached yet.
const NEW: u32 = 0;

/// Calls `visit` for each strongly connected component, with its nodes in arbitrary order. A component comes after those
/// whose flows it reads. Nodes without an interval count as constants, so nothing is followed through them.
pub(super) fn for_each_component(net: &Net, mut visit: impl FnMut(&mut [NodeId])) {
    let mut search = Search {
        net,
        index: vec![NEW; net.nodes.len()],
        lowest: vec![NEW; net.nodes.len()],
        is_open: vec![false; net.nodes.len()],
        open: Vec::new(),
        count: NEW,
    };
    for id in net.node_ids() {
        if search.index[id.index()] == NEW {
            search.run(id, &mut visit);
        }
    }
}

/// Depth-first search over the nodes that a node reads.
struct Search<'a> {
    net: &'a Net,
    /// For each node, its number in the order in which the search reached it, from 1.
    index: Vec<u32>,
    /// For each node, the lowest number of an open node that is known to be reached from it.
    lowest: Vec<u32>,
    /// For each node, whether its component is not complete yet.
    is_open: Vec<bool>,
    /// Nodes whose component is not complete yet, in the order in which the search reached them.
    open: Vec<NodeId>,
    count: u32,
}

impl Search<'_> {
    fn run(&mut self, start: NodeId, visit: &mut impl FnMut(&mut [NodeId])) {
        // Each node on the way to the present one, with the number of its in-port that is followed next.
        let mut path = vec![(start, 0)];
        self.open(start);
        while let Some((node, port)) = path.last_mut() {
            let node = *node;
            match self.next_source(node, port) {
                Some(source) if self.index[source.index()] == NEW => {
                    self.open(source);
                    path.push((source, 0));
                }
                Some(source) => {
                    if self.is_open[source.index()] {
                        self.reaches(node, self.index[source.index()]);
                    }
                }
                None => {
                    path.pop();
                    if let Some((reader, _)) = path.last() {
                        self.reaches(*reader, self.lowest[node.index()]);
                    }
                    if self.lowest[node.index()] == self.index[node.index()] {
                        self.close(node, visit);
                    }
                }
            }
        }
    }

    fn open(&mut self, node: NodeId) {
        self.count += 1;
        self.index[node.index()] = self.count;
        self.lowest[node.index()] = self.count;
        self.is_open[node.index()] = true;
        self.open.push(node);
    }

    fn reaches(&mut self, node: NodeId, number: u32) {
        let lowest = &mut self.lowest[node.index()];
        *lowest = (*lowest).min(number);
    }

    /// Completes the component whose first node in the order of the search is `first`.
    fn close(&mut self, first: NodeId, visit: &mut impl FnMut(&mut [NodeId])) {
        let from = self.open.iter().rposition(|node| *node == first);
        let from = from.unwrap_or(0);
        for node in &self.open[from..] {
            self.is_open[node.index()] = false;
        }
        visit(&mut self.open[from..]);
        self.open.truncate(from);
    }

    /// Returns the node that the next connected in-port of `node` reads, and moves `port` behind it; `None` behind the
    /// last one.
    fn next_source(&self, node: NodeId, port: &mut usize) -> Option<NodeId> {
        let node = self.net.node(node);
        full_range(node)?;
        while let Some(input) = node.inputs.get(*port) {
            *port += 1;
            if let Input::Port(source) = input {
                return Some(source.node);
            }
        }
        None
    }
}
