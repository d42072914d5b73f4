//! Hoists delays of first-generation nets to the level of the dependency cycle that they break.
//!
//! To its parent, a fragment is one vertex that waits for its activation (M6), so a `Pre` inside it breaks no
//! dependency cycle outside. The reference system's first generation had another rule: a reader of a `Pre`, even
//! through out-ports of fragments, does not wait for it, and gets the value of the previous cycle if the fragment was
//! active then. A `Pre` on the same flow outside the fragment means the same. So one is added where such a read closes
//! a dependency cycle. Dependency cycles that remain are errors.

use crate::fragment_tree::Item;
use crate::net::{Activation, FragmentId, Input, Net, Node, PortRef, Restart, Termination};
use crate::passes::dependencies::{Dependencies, Dependency, Graph, Reader};
use crate::passes::dependency_cycles::CyclicComponents;
use petgraph::visit::EdgeRef;
use rpi_image::Role;
use std::collections::{BTreeMap, BTreeSet};

/// Adds copies of delays outside of their fragments in an imported net where that breaks a dependency cycle. Returns
/// the number of added delays.
///
/// `dependencies` are those of the unchanged net.
pub fn hoist_delays(net: &mut Net, dependencies: &Dependencies) -> usize {
    if !matches!(net.termination, Termination::Ports { .. }) {
        return 0;
    }
    let mut added = 0;
    for level in net.fragment_ids() {
        let graph = dependencies.graph(level);
        for (port, readers) in delays_to_hoist(net, graph) {
            let delay = copy_outside(net, level, port);
            added += 1;
            for reader in readers {
                redirect(net, reader, delay);
            }
        }
    }
    added
}

/// Returns the delays inside child fragments whose readers close a dependency cycle in the graph of a fragment, each
/// with all its readers in that graph.
fn delays_to_hoist(net: &Net, graph: &Graph) -> BTreeMap<PortRef, Vec<Reader>> {
    let is_delay = |d: &Dependency| net.node(d.source.node).desc().role == Role::Delay;
    let from_inside = |v| matches!(graph[v], Item::Fragment(f) if !net.fragment(f).is_clock);
    if !graph.node_indices().any(from_inside) {
        return BTreeMap::new();
    }
    let rings = CyclicComponents::new(graph);
    let closing: BTreeSet<PortRef> = rings
        .edges()
        .filter(|e| is_delay(&graph[*e]))
        .filter(|e| {
            graph
                .edge_endpoints(*e)
                .is_some_and(|(v, _)| from_inside(v))
        })
        .map(|e| graph[e].source)
        .collect();
    let mut readings: BTreeMap<PortRef, Vec<Reader>> = BTreeMap::new();
    for edge in graph.edge_references() {
        let Dependency { source, reader } = *edge.weight();
        if from_inside(edge.source()) && closing.contains(&source) {
            readings.entry(source).or_default().push(reader);
        }
    }
    readings
}

/// Adds a copy of the delay `port` to the fragment `level` and returns its out-port. The copy reads the same flow as
/// the original.
fn copy_outside(net: &mut Net, level: FragmentId, port: PortRef) -> PortRef {
    let inside = net.node(port.node);
    let node = Node {
        name: free_name(net, level, &inside.name),
        fragment: level,
        ..inside.clone()
    };
    PortRef {
        node: net.add_node(node),
        port: port.port,
    }
}

fn redirect(net: &mut Net, reader: Reader, to: PortRef) {
    match reader {
        Reader::Input(id, k) => net.nodes[id.index()].inputs[k as usize] = Input::Port(to),
        Reader::InPort(id, k) => {
            net.fragments[id.index()].inputs[k as usize].source = Input::Port(to)
        }
        Reader::Restart(id) => net.fragments[id.index()].restart = Restart::Every(to),
        Reader::Activation(id) => {
            if let Activation::When { condition, .. } = &mut net.fragments[id.index()].activation {
                *condition = to;
            }
        }
    }
}

/// Returns a name that is not used in the fragment `level`: `preferred`, with a number appended if necessary.
fn free_name(net: &Net, level: FragmentId, preferred: &str) -> String {
    let nodes = net
        .nodes
        .iter()
        .filter(|n| n.fragment == level)
        .map(|n| &n.name);
    let fragments = net
        .fragments
        .iter()
        .filter(|f| f.parent == Some(level))
        .map(|f| &f.name);
    let taken: BTreeSet<&String> = nodes.chain(fragments).collect();
    let numbered = (2..).map(|n| format!("{preferred}_{n}"));
    let mut names = std::iter::once(preferred.to_owned()).chain(numbered);
    names.find(|n| !taken.contains(n)).unwrap_or_default()
}
