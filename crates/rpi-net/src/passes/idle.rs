//! Flows that only they themselves read: a counter that nobody looks at, two delays that hand each other their values.

use super::live;
use crate::net::{Input, Net, NodeId, without_calls};
use petgraph::unionfind::UnionFind;
use rpi_diag::{Code, Finding, Span};
use rpi_image::Role;
use std::collections::BTreeMap;

/// A warning for each group of named flows that nothing outside of the group reads; `live` and `used` are as in
/// [`live`].
pub(super) fn check(net: &Net, live: &[bool], used: &[bool]) -> Vec<Finding> {
    let may_be = |at: usize| used[at] && !live[at];
    if !(0..net.nodes.len()).any(may_be) {
        return Vec::new();
    }
    let idle = idle(net, live, used);
    let others = net.node_ids().filter(|id| !idle[id.index()]);
    let others = others.filter(|id| !net.node(*id).inputs.is_empty());
    let mut elsewhere: Vec<Span> = others.map(|id| net.node(id).origin.span).collect();
    elsewhere.sort_unstable();
    let mut told: BTreeMap<Vec<Span>, Vec<&str>> = BTreeMap::new();
    for group in groups(net, &idle) {
        let mut flows: Vec<(Span, &str)> = group.iter().filter_map(|id| flow(net, *id)).collect();
        flows.sort_unstable();
        flows.dedup();
        let is_elsewhere = |span: &Span| elsewhere.binary_search(span).is_ok();
        if !flows.is_empty() && !flows.iter().any(|(span, _)| is_elsewhere(span)) {
            let (places, names) = flows.into_iter().unzip();
            told.insert(places, names);
        }
    }
    told.iter()
        .map(|(places, names)| finding(places, names))
        .collect()
}

/// The flow of the program that a node computes, unless it is meant to stay.
fn flow(net: &Net, id: NodeId) -> Option<(Span, &str)> {
    let origin = &net.node(id).origin;
    let name = origin.flow.as_deref()?;
    (!origin.span.is_none() && !name.starts_with('_')).then_some((origin.span, name))
}

/// Whether a node computes a flow that is meant to stay, read or not: so is what that is made of.
fn is_meant(net: &Net, id: NodeId) -> bool {
    let flow = net.node(id).origin.flow.as_deref();
    flow.is_some_and(|name| name.starts_with('_'))
}

/// For each node whether it is read, and from nowhere a way leads from it to what nobody reads, to what is meant to stay, or
/// to an effect.
fn idle(net: &Net, live: &[bool], used: &[bool]) -> Vec<bool> {
    // Constants, and whether it is the first cycle, are shared: they connect nothing.
    let may_be = net.nodes.iter().zip(live);
    let may_be = may_be.map(|(node, live)| !live && !node.inputs.is_empty());
    let mut idle: Vec<bool> = may_be.collect();
    let unread = net.node_ids().filter(|id| !used[id.index()]);
    let meant = net.node_ids().filter(|id| is_meant(net, *id));
    let mut open: Vec<NodeId> = unread.chain(meant).chain(live::given(net)).collect();
    while let Some(id) = open.pop() {
        if std::mem::replace(&mut idle[id.index()], false) {
            open.extend(sources(net, id));
        }
    }
    idle
}

fn sources(net: &Net, id: NodeId) -> impl Iterator<Item = NodeId> + '_ {
    let ports = net.node(id).inputs.iter().filter_map(Input::port);
    ports.map(|port| port.node)
}

/// The idle nodes, together with those that they read or are read by. Without the groups in which nothing is delayed:
/// a ring without a delay is told as such.
fn groups(net: &Net, idle: &[bool]) -> Vec<Vec<NodeId>> {
    let mut joined: UnionFind<u32> = UnionFind::new(idle.len());
    let members = || net.node_ids().filter(|id| idle[id.index()]);
    for id in members() {
        for source in sources(net, id).filter(|id| idle[id.index()]) {
            joined.union(id.0, source.0);
        }
    }
    let is_delay = |id: &NodeId| net.node(*id).desc().role == Role::Delay;
    let delays = members().filter(is_delay);
    let mut groups: BTreeMap<u32, Vec<NodeId>> =
        delays.map(|id| (joined.find(id.0), Vec::new())).collect();
    for id in members() {
        if let Some(group) = groups.get_mut(&joined.find(id.0)) {
            group.push(id);
        }
    }
    groups.into_values().collect()
}

/// Flows of a group that are named.
const NAMED: usize = 8;

fn finding(places: &[Span], names: &[&str]) -> Finding {
    let mut quoted: Vec<String> = names
        .iter()
        .take(NAMED)
        .map(|n| format!("`{}`", without_calls(n)))
        .collect();
    quoted.dedup();
    let message = match &quoted[..] {
        [one] => format!("nothing else uses {one}"),
        many if names.len() > NAMED => {
            let more = names.len() - NAMED;
            format!(
                "nothing but one another uses {} and {more} more",
                many.join(", ")
            )
        }
        many => format!("nothing but one another uses {}", many.join(", ")),
    };
    let finding = Finding::new(Code::RPI3101, message)
        .help("delete it, or let its name begin with `_` if it shall stay");
    let places = places.iter().take(NAMED);
    places.fold(finding, |finding, place| {
        finding.at(*place, "computed here")
    })
}
