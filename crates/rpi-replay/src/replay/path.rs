//! Path of a divergence: from the deviating port backwards through the inputs that deviate.

use std::collections::BTreeSet;

use rpi_image::Role;
use rpi_net::{Input, PortRef};

use super::compare::deviation;
use super::engine::Replay;
use super::recorded::Recorded;
use super::report::{Divergence, Link};
use super::text::text;

/// Maximum length of a path. Longer paths give no further information.
const MAX_LINKS: usize = 64;

/// Returns the path backwards from a deviating out-port.
pub(super) fn divergence(replay: &Replay<'_>, port: PortRef) -> Divergence {
    let mut path = Vec::new();
    let mut seen = BTreeSet::new();
    let mut next = Some(port);
    while let Some(port) = next.filter(|p| seen.insert(*p) && path.len() < MAX_LINKS) {
        path.push(link(replay, port));
        next = worst_input(replay, port);
    }
    Divergence {
        cycle: replay.view.number,
        path,
    }
}

/// Returns the path backwards from a port that only forwards `source`.
pub(super) fn alias_divergence(replay: &Replay<'_>, name: &str, source: &Input) -> Divergence {
    let ty = super::plan::type_of(replay.net, source);
    let computed = replay.input(source);
    let first = Link {
        port: name.to_owned(),
        primitive: String::new(),
        computed: ty.map_or_else(String::new, |ty| text(computed, ty)),
        recorded: None,
        deviation: None,
        since: None,
        inputs: Vec::new(),
    };
    let mut found = match source {
        Input::Port(port) => divergence(replay, *port),
        Input::Open | Input::Const(_) => Divergence {
            cycle: replay.view.number,
            path: Vec::new(),
        },
    };
    found.path.insert(0, first);
    found
}

fn link(replay: &Replay<'_>, port: PortRef) -> Link {
    let ty = replay.plan.out(port).signal.ty;
    let recorded = Some(replay.recorded(port)).filter(|r| *r != Recorded::Unknown);
    Link {
        port: replay.name(port),
        primitive: replay.net.node(port.node).desc().name.to_owned(),
        computed: text(replay.computed(port), ty),
        recorded: recorded.map(|r| r.text(ty)),
        deviation: off_by(replay, port),
        since: since(replay, port),
        inputs: inputs(replay, port),
    }
}

fn inputs(replay: &Replay<'_>, port: PortRef) -> Vec<(String, String, String)> {
    let node = replay.net.node(port.node);
    let ports = node.desc().inputs.iter().zip(&node.inputs);
    let row = |(port, input): (&rpi_image::InPort, &Input)| {
        let ty = super::plan::type_of(replay.net, input)?;
        let from = match input {
            Input::Port(source) => replay.name(*source),
            _ => "constant".to_owned(),
        };
        let value = match (input, node.desc().role) {
            (Input::Port(source), Role::Delay) => replay.before(*source),
            _ => text(replay.input(input), ty),
        };
        Some((port.name.to_owned(), from, value))
    };
    ports.filter_map(row).collect()
}

/// Returns the deviating input with the largest deviation, if any. The path ends at a delay: a delay reads a value of
/// the previous cycle, in which nothing deviated.
fn worst_input(replay: &Replay<'_>, port: PortRef) -> Option<PortRef> {
    let node = replay.net.node(port.node);
    if node.desc().role == Role::Delay {
        return None;
    }
    let sources = node.inputs.iter().filter_map(|input| match input {
        Input::Port(source) => Some(*source),
        _ => None,
    });
    let off = sources.filter(|s| since(replay, *s).is_some());
    let by = |port: &PortRef| off_by(replay, *port).unwrap_or(f64::INFINITY);
    off.max_by(|a, b| by(a).total_cmp(&by(b)))
}

fn since(replay: &Replay<'_>, port: PortRef) -> Option<u64> {
    replay.since[port.node.index()][usize::from(port.port)]
}

fn off_by(replay: &Replay<'_>, port: PortRef) -> Option<f64> {
    let computed = replay.computed(port)?;
    match replay.recorded(port) {
        Recorded::Value(cells) => {
            Some(deviation(replay.plan.out(port).signal.ty, computed, &cells))
        }
        _ => None,
    }
}
