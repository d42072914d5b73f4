//! Decides whether a documented difference between the systems explains a deviating value.

use rpi_image::PrimDesc;
use rpi_net::{Input, NodeId, PortRef};
use rpi_prims::differences::{self, Condition, DIFFERENCES, Difference, DifferenceCase};

use super::engine::Replay;
use super::relation::equal_within;
use super::trace_view::RecordedValue;

/// Returns true if a documented difference to the reference system (the control core of the Robotics API) covers the
/// out-port with the index `port`. Such a port may be set to any value or to absence.
pub(super) fn is_documented(desc: &PrimDesc, port: usize) -> bool {
    differences::has_difference(desc, port)
}

/// Returns true if the reference system (the control core of the Robotics API) may have computed a wrong value at the
/// out-port with the index `port`. Without a recorded value the true value is then unknown.
pub(super) fn may_be_wrong(desc: &PrimDesc, port: usize) -> bool {
    let own = |d: &&Difference| !matches!(d.condition, Condition::ReadsAliased);
    let mut entries = DIFFERENCES.iter().filter(own);
    entries.any(|d| d.applies_to(desc, port))
}

/// Returns the documented difference to the reference system (the control core of the Robotics API) that explains why a
/// computed value deviates from the recorded one; `None` if no difference explains it.
pub(super) fn explain(
    replay: &Replay<'_>,
    port: PortRef,
    computed: Option<&[u64]>,
    recorded: &RecordedValue,
) -> Option<&'static Difference> {
    let node = replay.net.node(port.node);
    let inputs: Vec<_> = node.inputs.iter().map(|i| replay.input_value(i)).collect();
    let sources: Vec<_> = node
        .inputs
        .iter()
        .map(|i| source_primitive(replay, i))
        .collect();
    let origins = origins(replay, port);
    let origins: Vec<&[u64]> = origins.iter().map(Vec::as_slice).collect();
    let case = DifferenceCase {
        desc: node.desc(),
        port: usize::from(port.port),
        dt: replay.dt(),
        inputs: &inputs,
        sources: &sources,
        origins: &origins,
        params: &node.params,
        computed,
        recorded: match recorded {
            RecordedValue::Value(cells) => differences::Recorded::Value(cells),
            RecordedValue::WrongType(_) => differences::Recorded::Other,
            _ => differences::Recorded::Absent,
        },
        after_pause: replay.was_inactive[port.node.index()],
        reads_aliased: reads_aliased(replay, port.node),
    };
    let ty = replay.plan.out_port(port).signal.ty;
    differences::explain(&case, |a, b| equal_within(ty, a, b, replay.tolerance))
}

/// Returns true if a node reads a recorded value that the reference system (the control core of the Robotics API) has
/// overwritten since.
pub(super) fn reads_aliased(replay: &Replay<'_>, node: NodeId) -> bool {
    let mut reads = replay.net.node(node).inputs.iter();
    reads.any(|i| matches!(i, Input::Port(p) if replay.aliased[p.node.index()]))
}

fn source_primitive<'a>(replay: &Replay<'a>, input: &Input) -> Option<&'a str> {
    match input {
        Input::Port(port) => Some(replay.net.node(port.node).desc().name),
        Input::Unconnected | Input::Const(_) => None,
    }
}

/// Returns the values recorded in this cycle upstream of the node's first in-port, through primitives by which the
/// reference system (the control core of the Robotics API) passes objects on without copying them.
fn origins(replay: &Replay<'_>, port: PortRef) -> Vec<Vec<u64>> {
    let ty = replay.plan.out_port(port).signal.ty;
    let mut found = Vec::new();
    let mut seen = vec![port.node];
    let first = replay.net.node(port.node).inputs.first();
    let mut open: Vec<&Input> = first.into_iter().collect();
    while let Some(input) = open.pop() {
        let Input::Port(source) = input else {
            continue;
        };
        if replay.plan.out_port(*source).signal.ty == ty
            && let RecordedValue::Value(cells) = replay.recorded(*source)
        {
            found.push(cells);
        }
        let node = replay.net.node(source.node);
        if differences::outputs_alias(node.desc().name) && !seen.contains(&source.node) {
            seen.push(source.node);
            open.extend(&node.inputs);
        }
    }
    found
}
