//! Liveness: nodes with an effect outside the net, and all that they depend on.

use crate::net::{Activation, FragmentId, Input, Net, NodeId, Restart, Termination};
use rpi_image::{PrimDesc, Role};

/// Returns for each node whether it is live: a result, an export or an effect depends on it.
#[must_use]
pub fn mark_live(net: &Net) -> Vec<bool> {
    let mut search = Search::new(net);
    effects(net).for_each(|id| search.mark(id));
    // Most nodes read earlier ones, so one backward sweep in memory order marks nearly all live nodes.
    for id in net.node_ids().rev() {
        search.sweep = id.index();
        if search.live[id.index()] {
            search.follow(id);
        }
    }
    while let Some(id) = search.open.pop() {
        search.follow(id);
    }
    search.live
}

/// State of the search for live nodes, which a result, an export or an effect depends on.
struct Search<'n> {
    net: &'n Net,
    live: Vec<bool>,
    seen: Vec<bool>,
    /// Index of the node that the backward sweep over all nodes has reached.
    sweep: usize,
    /// Live nodes that the sweep has passed already, whose inputs still have to be marked.
    open: Vec<NodeId>,
}

impl<'n> Search<'n> {
    fn new(net: &'n Net) -> Self {
        Search {
            net,
            live: vec![false; net.nodes.len()],
            seen: vec![false; net.fragments.len()],
            sweep: net.nodes.len(),
            open: Vec::new(),
        }
    }

    fn mark(&mut self, id: NodeId) {
        let known = std::mem::replace(&mut self.live[id.index()], true);
        if !known && id.index() >= self.sweep {
            self.open.push(id);
        }
    }

    /// Marks the nodes whose values a live node reads, and the conditions of the fragments around it.
    fn follow(&mut self, id: NodeId) {
        let net = self.net;
        let node = net.node(id);
        let sources = node.inputs.iter().filter_map(Input::port);
        sources.for_each(|port| self.mark(port.node));
        let mut around = Some(node.fragment);
        while let Some(fragment) = around {
            if std::mem::replace(&mut self.seen[fragment.index()], true) {
                break;
            }
            conditions(net, fragment).for_each(|id| self.mark(id));
            around = net.fragment(fragment).parent;
        }
    }
}

/// Returns whether a primitive is used for its effect, such as driving an actuator, instead of its value.
#[must_use]
pub fn has_effect(desc: &PrimDesc) -> bool {
    matches!(desc.role, Role::Actuator(_) | Role::Export) || desc.outputs.is_empty()
}

/// Returns the nodes with an effect outside of the net, and the sources of the command's results and exports.
fn effects(net: &Net) -> impl Iterator<Item = NodeId> + '_ {
    let acting = net.node_ids().filter(|id| has_effect(net.node(*id).desc()));
    let ends: Vec<&Input> = match &net.termination {
        Termination::Results(results) => results.iter().map(|r| &r.condition).collect(),
        Termination::Ports { terminate, fail } => terminate.iter().chain(fail).collect(),
    };
    let ends = ends.into_iter().filter_map(|i| Some(i.port()?.node));
    acting
        .chain(ends)
        .chain(net.exports.iter().map(|e| e.source.node))
}

fn conditions(net: &Net, id: FragmentId) -> impl Iterator<Item = NodeId> {
    let fragment = net.fragment(id);
    let activation = match fragment.activation {
        Activation::Always => None,
        Activation::When { condition, .. } => Some(condition.node),
    };
    let restart = match fragment.restart {
        Restart::Never | Restart::OnActivation => None,
        Restart::Every(condition) => Some(condition.node),
    };
    activation.into_iter().chain(restart)
}

/// Returns the nodes that are sources of ports of fragments.
pub(super) fn port_sources(net: &Net) -> impl Iterator<Item = NodeId> + '_ {
    let ports = net.fragments.iter();
    let ports = ports.flat_map(|f| f.inputs.iter().chain(&f.outputs));
    ports.filter_map(|port| Some(port.source.port()?.node))
}
