//! What has an effect outside the net, and which flows of a program have none.

use crate::net::{Activation, Driver, FragmentId, Input, Net, NodeId, Restart};
use rpi_diag::{Code, Finding, Span};
use rpi_image::Role;
use std::collections::BTreeSet;

/// For each node whether something that leaves the net depends on it.
#[must_use]
pub fn live(net: &Net) -> Vec<bool> {
    let mut live = vec![false; net.nodes.len()];
    let mut seen = vec![false; net.fragments.len()];
    let mut open: Vec<NodeId> = effects(net).collect();
    while let Some(id) = open.pop() {
        if std::mem::replace(&mut live[id.index()], true) {
            continue;
        }
        let node = net.node(id);
        open.extend(node.inputs.iter().filter_map(|i| Some(i.port()?.node)));
        for fragment in net.enclosing(node.fragment) {
            if std::mem::replace(&mut seen[fragment.index()], true) {
                break;
            }
            open.extend(conditions(net, fragment));
        }
    }
    live
}

/// Nodes that act on the outside, and those of which the command's end or exports are made.
fn effects(net: &Net) -> impl Iterator<Item = NodeId> + '_ {
    let acting = net.node_ids().filter(|id| {
        let desc = net.node(*id).desc();
        matches!(desc.role, Role::Actuator(_) | Role::Export) || desc.outputs.is_empty()
    });
    let ends: Vec<&Input> = match &net.driver {
        Driver::Results(results) => results.iter().map(|r| &r.condition).collect(),
        Driver::Ports { terminate, fail } => terminate.iter().chain(fail).collect(),
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

/// A warning for each named flow of a program that nothing reads, in any of its instances, and that no fragment gives
/// out. Names that begin with `_` are meant so.
pub(crate) fn check(net: &Net, live: &[bool]) -> Vec<Finding> {
    if net.nodes.iter().all(|n| n.origin.flow.is_none()) {
        return Vec::new();
    }
    let used = used(net, live);
    let mut reported: BTreeSet<Span> = BTreeSet::new();
    // What is set from outside is not computed here, whoever reads it.
    let computed = net.nodes.iter().filter(|n| n.desc().role != Role::Input);
    let flows = computed.filter_map(|n| Some((n.origin.span, n.origin.flow.as_deref()?)));
    let dead = flows
        .filter(|(span, name)| !span.is_none() && !name.starts_with('_') && !used.contains(span));
    dead.filter(|(span, _)| reported.insert(*span))
        .map(finding)
        .collect()
}

/// Places of flows that are live, read by another flow or given out in some instance.
fn used(net: &Net, live: &[bool]) -> BTreeSet<Span> {
    let is_live = net.node_ids().filter(|id| live[id.index()]);
    let read = net
        .nodes
        .iter()
        .flat_map(|n| &n.inputs)
        .filter_map(|i| Some(i.port()?.node));
    let given = net
        .fragments
        .iter()
        .flat_map(|f| f.inputs.iter().chain(&f.outputs));
    let given = given.filter_map(|p| Some(p.source.port()?.node));
    is_live
        .chain(read)
        .chain(given)
        .map(|id| net.node(id).origin.span)
        .collect()
}

fn finding((span, name): (Span, &str)) -> Finding {
    Finding::new(Code::RPI3101, format!("nothing uses `{name}`"))
        .at(span, "computed here")
        .help(format!("delete it, or call it `_{name}` if it shall stay"))
}
