//! Decides whether a documented difference between the systems explains a deviating value.

use rpi_image::PrimDesc;
use rpi_net::{Input, NodeId, PortRef};
use rpi_prims::differences::{self, Case, DIFFERENCES, Difference, When};

use super::engine::Replay;
use super::recorded::Recorded;
use super::relation::same;

/// Returns true if a documented difference covers this port. Such a port may be forced to any value or to absence.
pub(super) fn concerns(desc: &PrimDesc, port: usize) -> bool {
    differences::concerns(desc, port)
}

/// Returns true if the reference system may have computed a wrong value at this port. Without a recorded value the true
/// value is then unknown.
pub(super) fn may_be_wrong(desc: &PrimDesc, port: usize) -> bool {
    let own = |d: &&Difference| !matches!(d.when, When::ReadsAliased);
    let mut entries = DIFFERENCES.iter().filter(own);
    entries.any(|d| d.speaks_of(desc, port))
}

/// Returns the documented difference that explains a deviating value.
pub(super) fn explain(
    replay: &Replay<'_>,
    port: PortRef,
    computed: Option<&[u64]>,
    recorded: &Recorded,
) -> Option<&'static Difference> {
    let node = replay.net.node(port.node);
    let inputs: Vec<_> = node.inputs.iter().map(|i| replay.input(i)).collect();
    let sources: Vec<_> = node.inputs.iter().map(|i| source(replay, i)).collect();
    let origins = origins(replay, port);
    let origins: Vec<&[u64]> = origins.iter().map(Vec::as_slice).collect();
    let case = Case {
        desc: node.desc(),
        port: usize::from(port.port),
        dt: replay.dt(),
        inputs: &inputs,
        sources: &sources,
        origins: &origins,
        params: &node.params,
        computed,
        recorded: match recorded {
            Recorded::Value(cells) => differences::Recorded::Value(cells),
            Recorded::Foreign(_) => differences::Recorded::Other,
            _ => differences::Recorded::Absent,
        },
        after_pause: replay.paused[port.node.index()],
        reads_aliased: reads_aliased(replay, port.node),
    };
    let ty = replay.plan.out(port).signal.ty;
    differences::explain(&case, |a, b| same(ty, a, b, replay.tolerance))
}

/// Returns true if a node reads a value that the reference system has overwritten since.
pub(super) fn reads_aliased(replay: &Replay<'_>, node: NodeId) -> bool {
    let mut reads = replay.net.node(node).inputs.iter();
    reads.any(|i| matches!(i, Input::Port(p) if replay.aliased[p.node.index()]))
}

fn source<'a>(replay: &Replay<'a>, input: &Input) -> Option<&'a str> {
    match input {
        Input::Port(port) => Some(replay.net.node(port.node).desc().name),
        Input::Open | Input::Const(_) => None,
    }
}

/// Returns the values recorded in this cycle upstream of the first in-port, through primitives of the reference system
/// that pass objects on.
fn origins(replay: &Replay<'_>, port: PortRef) -> Vec<Vec<u64>> {
    let ty = replay.plan.out(port).signal.ty;
    let mut found = Vec::new();
    let mut seen = vec![port.node];
    let first = replay.net.node(port.node).inputs.first();
    let mut open: Vec<&Input> = first.into_iter().collect();
    while let Some(input) = open.pop() {
        let Input::Port(source) = input else {
            continue;
        };
        if replay.plan.out(*source).signal.ty == ty
            && let Recorded::Value(cells) = replay.recorded(*source)
        {
            found.push(cells);
        }
        let node = replay.net.node(source.node);
        if differences::passes_on(node.desc().name) && !seen.contains(&source.node) {
            seen.push(source.node);
            open.extend(&node.inputs);
        }
    }
    found
}
