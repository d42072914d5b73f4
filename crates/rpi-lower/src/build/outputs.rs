//! Results, exports and probes.

use super::Builder;
use rpi_image::image::{CommandEnd, CommandEndKind, Export, NamedResult, Signal};
use rpi_net::{FragmentId, Input, PortRef, ResultKind, Termination};

impl Builder<'_> {
    /// Adds results, root ports and exports, as they are at the end of the cycle.
    pub(super) fn exports_and_results(&mut self) {
        let net = self.net;
        for export in &net.exports {
            let input = Input::Port(export.source);
            let value = self.at_root(&input);
            let key = export.key.clone();
            self.flat.tables.exports.push(Export { key, value });
        }
        self.flat.tables.end = match &net.termination {
            Termination::Results(results) => {
                let result = |r: &rpi_net::ResultPort| NamedResult {
                    name: r.name.clone(),
                    kind: kind(r.kind),
                    condition: self.at_root(&r.condition),
                };
                CommandEnd::Results(results.iter().map(result).collect())
            }
            Termination::Ports { terminate, fail } => CommandEnd::Ports {
                terminate: terminate.as_ref().map(|i| self.at_root(i)),
                fail: fail.as_ref().map(|i| self.at_root(i)),
            },
        };
    }

    fn at_root(&mut self, input: &Input) -> Signal {
        let link = self.read(input, FragmentId::ROOT);
        self.signal(link.flow, link.ty)
    }

    /// Adds a probe for every port of every node.
    pub(super) fn probes(&mut self) {
        for id in self.net.node_ids() {
            for port in super::compute::ports(id, self.desc(id)) {
                let at = self.first_output[id.index()] as usize + usize::from(port.port);
                let signal = self.signal(self.flows[at], self.ty(port));
                self.probe(port, signal);
            }
        }
    }

    fn probe(&mut self, port: PortRef, signal: Signal) {
        self.flat
            .tables
            .probes
            .push((port.node.0, port.port, signal));
    }
}

fn kind(kind: ResultKind) -> CommandEndKind {
    match kind {
        ResultKind::Finish => CommandEndKind::Finish,
        ResultKind::Yield => CommandEndKind::Yield,
        ResultKind::Fail => CommandEndKind::Fail,
    }
}
