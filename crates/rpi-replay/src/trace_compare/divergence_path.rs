//! Path of a divergence: from the deviating port backwards through the inputs that deviate.

use std::collections::BTreeSet;

use rpi_image::Role;
use rpi_net::{Input, PortRef};

use super::distance::deviation;
use super::engine::Replay;
use super::report::{Divergence, DivergenceLink};
use super::text::value_text;
use super::trace_view::RecordedValue;

/// Maximum number of ports on the path of a deviation. Longer paths give no further information.
const MAX_LINKS: usize = 64;

/// Returns the path of deviating ports that led to the deviation at an out-port: from this port backwards through the
/// inputs with the largest deviations.
pub(super) fn divergence(replay: &Replay<'_>, port: PortRef) -> Divergence {
    let mut path = Vec::new();
    let mut seen = BTreeSet::new();
    let mut next = Some(port);
    while let Some(port) = next.filter(|p| seen.insert(*p) && path.len() < MAX_LINKS) {
        path.push(path_link(replay, port));
        next = worst_input(replay, port);
    }
    Divergence {
        cycle: replay.view.number,
        path,
    }
}

/// Returns the path of deviating ports that led to the deviation at the port `name`, which only shows the value of
/// `source`.
pub(super) fn alias_divergence(replay: &Replay<'_>, name: &str, source: &Input) -> Divergence {
    let ty = super::comparison_plan::type_of(replay.net, source);
    let computed = replay.input_value(source);
    let first = DivergenceLink {
        port: name.to_owned(),
        primitive: String::new(),
        computed: ty.map_or_else(String::new, |ty| value_text(computed, ty)),
        recorded: None,
        deviation: None,
        since: None,
        inputs: Vec::new(),
    };
    let mut found = match source {
        Input::Port(port) => divergence(replay, *port),
        Input::Unconnected | Input::Const(_) => Divergence {
            cycle: replay.view.number,
            path: Vec::new(),
        },
    };
    found.path.insert(0, first);
    found
}

fn path_link(replay: &Replay<'_>, port: PortRef) -> DivergenceLink {
    let ty = replay.plan.out_port(port).signal.ty;
    let recorded = Some(replay.recorded(port)).filter(|r| *r != RecordedValue::Unknown);
    DivergenceLink {
        port: replay.port_name(port),
        primitive: replay.net.node(port.node).desc().name.to_owned(),
        computed: value_text(replay.computed(port), ty),
        recorded: recorded.map(|r| r.text(ty)),
        deviation: port_deviation(replay, port),
        since: first_deviation(replay, port),
        inputs: input_rows(replay, port),
    }
}

fn input_rows(replay: &Replay<'_>, port: PortRef) -> Vec<(String, String, String)> {
    let node = replay.net.node(port.node);
    let ports = node.desc().inputs.iter().zip(&node.inputs);
    let row = |(port, input): (&rpi_image::InPort, &Input)| {
        let ty = super::comparison_plan::type_of(replay.net, input)?;
        let from = match input {
            Input::Port(source) => replay.port_name(*source),
            _ => "constant".to_owned(),
        };
        let value = match (input, node.desc().role) {
            (Input::Port(source), Role::Delay) => replay.previous_value_text(*source),
            _ => value_text(replay.input_value(input), ty),
        };
        Some((port.name.to_owned(), from, value))
    };
    ports.filter_map(row).collect()
}

/// Returns the source of the deviating input of a port's node with the largest deviation; `None` if no input deviates,
/// and at a delay, because a delay reads a value of the previous cycle, in which nothing deviated.
fn worst_input(replay: &Replay<'_>, port: PortRef) -> Option<PortRef> {
    let node = replay.net.node(port.node);
    if node.desc().role == Role::Delay {
        return None;
    }
    let sources = node.inputs.iter().filter_map(|input| match input {
        Input::Port(source) => Some(*source),
        _ => None,
    });
    let off = sources.filter(|s| first_deviation(replay, *s).is_some());
    let by = |port: &PortRef| port_deviation(replay, *port).unwrap_or(f64::INFINITY);
    off.max_by(|a, b| by(a).total_cmp(&by(b)))
}

fn first_deviation(replay: &Replay<'_>, port: PortRef) -> Option<u64> {
    replay.first_deviation[port.node.index()][usize::from(port.port)]
}

fn port_deviation(replay: &Replay<'_>, port: PortRef) -> Option<f64> {
    let computed = replay.computed(port)?;
    match replay.recorded(port) {
        RecordedValue::Value(cells) => Some(deviation(
            replay.plan.out_port(port).signal.ty,
            computed,
            &cells,
        )),
        _ => None,
    }
}
