//! Readers of each node.

use crate::net::{Input, Net, NodeId};

/// For each node, the nodes that read one of its out-ports, in declaration order. The lists are stored one after the
/// other (compressed sparse rows).
#[derive(Clone, Debug)]
pub struct Readers {
    /// For each node, the index in `readers` at which its list begins; a last entry marks the end of the last list.
    start: Vec<u32>,
    readers: Vec<NodeId>,
}

impl Readers {
    /// Collects, for each node of the net, the nodes that read its out-ports.
    #[must_use]
    pub fn new(net: &Net) -> Self {
        let mut start = vec![0_u32; net.nodes.len() + 1];
        each_link(net, |source, _| start[source.index() + 1] += 1);
        for k in 1..start.len() {
            start[k] += start[k - 1];
        }
        let mut next = start.clone();
        let total = start.last().map_or(0, |n| *n as usize);
        let mut readers = vec![NodeId(0); total];
        each_link(net, |source, reader| {
            let at = &mut next[source.index()];
            readers[*at as usize] = reader;
            *at += 1;
        });
        Readers { start, readers }
    }

    /// Returns the nodes that read an out-port of `node`. A node that reads it twice occurs twice.
    #[must_use]
    pub fn readers_of(&self, node: NodeId) -> &[NodeId] {
        let at = node.index();
        &self.readers[self.start[at] as usize..self.start[at + 1] as usize]
    }
}

/// Calls `visit` for each link of a net with the node that is read and the reader, in the order of the readers.
fn each_link(net: &Net, mut visit: impl FnMut(NodeId, NodeId)) {
    for (reader, node) in net.node_ids().zip(&net.nodes) {
        for port in node.inputs.iter().filter_map(Input::port) {
            visit(port.node, reader);
        }
    }
}
