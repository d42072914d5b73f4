//! Dead state: flows that are read only by themselves, such as a counter without a reader or two delays that read each
//! other.

use super::mark_live;
use crate::net::{Input, Net, NodeId, strip_unnamed_calls};
use petgraph::unionfind::UnionFind;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::Role;
use std::collections::BTreeMap;

/// Returns a warning for each group of named flows that only the flows of the group read.
///
/// For each node, `live` is whether a result, an export or an effect depends on it; `used` is whether it is live, read
/// by another node or a port of a fragment.
pub(super) fn check(net: &Net, live: &[bool], used: &[bool]) -> Vec<Diagnostic> {
    let may_be = |at: usize| used[at] && !live[at];
    if !(0..net.nodes.len()).any(may_be) {
        return Vec::new();
    }
    let idle = dead_state(net, live, used);
    let others = net.node_ids().filter(|id| !idle[id.index()]);
    let others = others.filter(|id| !net.node(*id).inputs.is_empty());
    let mut elsewhere: Vec<Span> = others.map(|id| net.node(id).origin.span).collect();
    elsewhere.sort_unstable();
    let mut by_places: BTreeMap<Vec<Span>, Vec<&str>> = BTreeMap::new();
    for group in groups(net, &idle) {
        let mut flows: Vec<(Span, &str)> = group.iter().filter_map(|id| flow(net, *id)).collect();
        flows.sort_unstable();
        flows.dedup();
        let is_elsewhere = |span: &Span| elsewhere.binary_search(span).is_ok();
        if !flows.is_empty() && !flows.iter().any(|(span, _)| is_elsewhere(span)) {
            let (places, names) = flows.into_iter().unzip();
            by_places.insert(places, names);
        }
    }
    by_places
        .iter()
        .map(|(places, names)| diagnostic(places, names))
        .collect()
}

/// Returns the location and name of the flow that a node computes; `None` without a name, or if the name begins with
/// `_`, which suppresses the warning.
fn flow(net: &Net, id: NodeId) -> Option<(Span, &str)> {
    let origin = &net.node(id).origin;
    let name = origin.flow.as_deref()?;
    (!origin.span.is_none() && !name.starts_with('_')).then_some((origin.span, name))
}

/// Returns whether a node computes a flow whose name begins with `_`, which suppresses warnings about the flow and its
/// sources.
fn is_intended(net: &Net, id: NodeId) -> bool {
    let flow = net.node(id).origin.flow.as_deref();
    flow.is_some_and(|name| name.starts_with('_'))
}

/// Returns for each node whether it is dead state: other nodes read it, but no path leads from it to a result, an
/// effect, an unread flow or a flow whose name begins with `_`.
///
/// The parameters are those of [`check`].
fn dead_state(net: &Net, live: &[bool], used: &[bool]) -> Vec<bool> {
    // Constants and `first` have no inputs and are shared; they must not connect groups.
    let may_be = net.nodes.iter().zip(live);
    let may_be = may_be.map(|(node, live)| !live && !node.inputs.is_empty());
    let mut idle: Vec<bool> = may_be.collect();
    let unread = net.node_ids().filter(|id| !used[id.index()]);
    let meant = net.node_ids().filter(|id| is_intended(net, *id));
    let mut open: Vec<NodeId> = unread
        .chain(meant)
        .chain(mark_live::port_sources(net))
        .collect();
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

/// Returns the connected groups of nodes with dead state (`idle`). A group without a delay is left out, since it is
/// reported as a dependency cycle.
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

/// Maximum number of flows that one diagnostic names, so that the message stays readable.
const SHOWN: usize = 8;

fn diagnostic(places: &[Span], names: &[&str]) -> Diagnostic {
    let mut quoted: Vec<String> = names
        .iter()
        .take(SHOWN)
        .map(|n| format!("`{}`", strip_unnamed_calls(n)))
        .collect();
    quoted.dedup();
    let message = match &quoted[..] {
        [one] => format!("{one} is only used by itself"),
        many if names.len() > SHOWN => {
            let more = names.len() - SHOWN;
            format!(
                "{} and {more} more are only used by each other",
                many.join(", ")
            )
        }
        many => format!("{} are only used by each other", many.join(", ")),
    };
    let diagnostic = Diagnostic::new(Code::RPI3101, message)
        .help("delete it, or start its name with `_` to keep it");
    let places = places.iter().take(SHOWN);
    places.fold(diagnostic, |diagnostic, place| {
        diagnostic.primary(*place, "computed here")
    })
}
