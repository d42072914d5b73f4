//! The net of a command as a graph for readers: equations as boxes, fragments and calls as boxes that can be opened.
//!
//! | file | idea |
//! |---|---|
//! | `boxes.rs` | the box of each primitive: that of the flow to whose expression it belongs |
//! | `lines.rs` | data flow between boxes, through the borders of the boxes around them |

mod boxes;
mod lines;

use rpi_diag::Span;
use rpi_graph::{NetGraph, Place};
use rpi_net::{Activation, FragmentId, Input, Net, NodeId, Restart, Termination};

use rpi_image::Role;

use boxes::{Boxes, is_constant_flow, shown_name};
use lines::{LineKind, Lines};

/// Returns the graph of a net. `place` returns the place in a text to which a span refers.
#[must_use]
pub fn net_graph(net: &Net, place: &dyn Fn(Span) -> Option<Place>) -> NetGraph {
    let mut boxes = Boxes::new(net, place);
    let leaves: Vec<_> = net.node_ids().map(|id| boxes.leaf(id)).collect();
    boxes.name_exports(&leaves);
    let results = results(net, &mut boxes);
    boxes.name_conditions();
    let mut lines = Lines::new(boxes.finish());
    for to in net.node_ids() {
        let node = net.node(to);
        let kind = match node.desc().role {
            Role::Delay => LineKind::Delayed,
            _ => LineKind::Value,
        };
        let sources = node.inputs.iter().filter_map(Input::port);
        for from in sources.filter(|from| is_shown(net, from.node)) {
            lines.add(leaves[from.node.index()], leaves[to.index()], kind);
        }
    }
    for id in net.fragment_ids() {
        let fragment = net.fragment(id);
        let active = match fragment.activation {
            Activation::When { condition, .. } => Some(condition),
            Activation::Always => None,
        };
        let reset = match fragment.restart {
            Restart::Every(condition) => Some(condition),
            Restart::Never | Restart::OnActivation => None,
        };
        let own = lines.fragment_box(id);
        for condition in active.into_iter().chain(reset) {
            if let Some(own) = own {
                lines.add(leaves[condition.node.index()], own, LineKind::Condition);
            }
        }
    }
    for (condition, result) in results {
        lines.add(leaves[condition.index()], result, LineKind::Value);
    }
    lines.finish(&net.name)
}

/// Returns whether a line from a node is shown. Constants, and the mark of the first cycle, are shared by equations that have nothing
/// to do with one another.
fn is_shown(net: &Net, node: NodeId) -> bool {
    let node = net.node(node);
    let is_part = shown_name(net, node).1 && !is_constant_flow(node);
    !(is_part && matches!(node.desc().role, Role::Constant | Role::First))
}

/// Adds boxes for the results of a net. Returns the node that decides about each, with its box.
fn results(net: &Net, boxes: &mut Boxes<'_>) -> Vec<(NodeId, boxes::BoxId)> {
    let ports: Vec<(&str, &Input, Span)> = match &net.termination {
        Termination::Results(results) => results
            .iter()
            .map(|r| (r.name.as_str(), &r.condition, r.origin.span))
            .collect(),
        Termination::Ports { terminate, fail } => [("outTerminate", terminate), ("outFail", fail)]
            .into_iter()
            .filter_map(|(name, input)| Some((name, input.as_ref()?, Span::NONE)))
            .collect(),
    };
    let added = ports.into_iter().filter_map(|(name, input, span)| {
        let result = boxes.result(FragmentId::ROOT, name, span);
        Some((input.port()?.node, result))
    });
    added.collect()
}
