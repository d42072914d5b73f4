//! Unused flows of a program: flows that nothing reads, and flows that only themselves read.

use super::dead_state;
use super::mark_live::port_sources;
use crate::net::{Input, Net, strip_unnamed_calls};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::Role;
use std::collections::BTreeSet;

/// Returns a warning for each named flow of a program that is never used: no node or port of a fragment reads any
/// instance of it.
///
/// A name that begins with `_` suppresses the warning. For each node, `live` is whether a result, an export or an
/// effect depends on it.
pub(crate) fn check(net: &Net, live: &[bool]) -> Vec<Diagnostic> {
    let used = used(net, live);
    // Inputs are set from outside rather than computed, so an unused one is not reported here.
    let dead = net.nodes.iter().zip(&used);
    let dead = dead.filter(|(node, used)| !**used && node.desc().role != Role::Input);
    let dead = dead.filter_map(|(n, _)| Some((n.origin.span, n.origin.flow.as_deref()?)));
    let dead: Vec<(Span, &str)> = dead
        .filter(|(span, name)| !span.is_none() && !name.starts_with('_'))
        .collect();
    if dead.is_empty() {
        return dead_state::check(net, live, &used);
    }
    let elsewhere = net.nodes.iter().zip(&used).filter(|(_, used)| **used);
    let mut elsewhere: Vec<Span> = elsewhere.map(|(node, _)| node.origin.span).collect();
    elsewhere.sort_unstable();
    let mut reported: BTreeSet<Span> = BTreeSet::new();
    let is_reported =
        |(span, _): &(Span, &str)| elsewhere.binary_search(span).is_err() && reported.insert(*span);
    let dead = dead.into_iter().filter(is_reported);
    let dead = dead.map(|(span, name)| unused(span, name));
    dead.chain(dead_state::check(net, live, &used)).collect()
}

/// Returns for each node whether it is live, another node reads it, or a port of a fragment carries its value.
fn used(net: &Net, live: &[bool]) -> Vec<bool> {
    let mut used = live.to_vec();
    let read = net.nodes.iter().flat_map(|node| &node.inputs);
    for port in read.filter_map(Input::port) {
        used[port.node.index()] = true;
    }
    port_sources(net).for_each(|id| used[id.index()] = true);
    used
}

/// Returns the diagnostic for a flow that is never used.
#[must_use]
pub fn unused(span: Span, name: &str) -> Diagnostic {
    let name = strip_unnamed_calls(name);
    Diagnostic::new(Code::RPI3101, format!("`{name}` is never used"))
        .primary(span, "computed here")
        .help(
            match name.contains(|c: char| !c.is_alphanumeric() && c != '_') {
                // A path cannot be declared, so no name is suggested; the label shows which part is the flow's name.
                true => "delete it, or start its name with `_` to keep it".to_owned(),
                false => format!("delete it, or rename it to `_{name}` to keep it"),
            },
        )
}
