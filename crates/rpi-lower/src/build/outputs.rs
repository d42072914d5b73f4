//! Results, exports and probes.

use super::Builder;
use rpi_image::image::{CommandEnd, CommandEndKind, Export, NamedResult, Signal};
use rpi_net::{FragmentId, Input, ResultKind, Termination};

/// Adds the exports of the net and its end conditions (results, or the ports for termination and failure) to the
/// tables, each with the registers of its flow as seen from the root fragment.
pub(super) fn exports_and_results(builder: &mut Builder<'_>) {
    let net = builder.net;
    for export in &net.exports {
        let input = Input::Port(export.source);
        let value = at_root(builder, &input);
        builder.flat.tables.exports.push(Export {
            key: export.key.clone(),
            unit: export.unit.clone(),
            value,
        });
    }
    builder.flat.tables.end = match &net.termination {
        Termination::Results(results) => {
            let result = |r: &rpi_net::ResultPort| NamedResult {
                name: r.name.clone(),
                kind: kind(r.kind),
                condition: at_root(builder, &r.condition),
            };
            CommandEnd::Results(results.iter().map(result).collect())
        }
        Termination::Ports { terminate, fail } => CommandEnd::Ports {
            terminate: terminate.as_ref().map(|i| at_root(builder, i)),
            fail: fail.as_ref().map(|i| at_root(builder, i)),
        },
    };
}

fn at_root(builder: &mut Builder<'_>, input: &Input) -> Signal {
    let link = builder.read(input, FragmentId::ROOT);
    link.flow.to_signal(link.ty)
}

/// Adds a probe, an entry that allows observers to read a flow, for every out-port of every node.
pub(super) fn probes(builder: &mut Builder<'_>) {
    for id in builder.net.node_ids() {
        for port in super::compute::ports(id, builder.desc(id)) {
            let flow = builder.flows.get(port);
            let signal = flow.to_signal(builder.net.output_type(port));
            let probe = (port.node.0, port.port, signal);
            builder.flat.tables.probes.push(probe);
        }
    }
}

fn kind(kind: ResultKind) -> CommandEndKind {
    match kind {
        ResultKind::Finish => CommandEndKind::Finish,
        ResultKind::Yield => CommandEndKind::Yield,
        ResultKind::Fail => CommandEndKind::Fail,
    }
}
