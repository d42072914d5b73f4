//! Results, exports and probes.

use super::Builder;
use rpi_image::image::{End, EndKind, EndResult, Export, Signal};
use rpi_net::{Driver, FragmentId, Input, PortRef, ResultKind};

impl Builder<'_> {
    /// Adds results, root ports and exports, as they are at the end of the cycle.
    pub(super) fn ends(&mut self) {
        let net = self.net;
        for export in &net.exports {
            let input = Input::Port(export.source);
            let value = self.at_root(&input);
            let key = export.key.clone();
            self.flat.tables.exports.push(Export { key, value });
        }
        self.flat.tables.end = match &net.driver {
            Driver::Results(results) => {
                let result = |r: &rpi_net::ResultPort| EndResult {
                    name: r.name.clone(),
                    kind: kind(r.kind),
                    condition: self.at_root(&r.condition),
                };
                End::Results(results.iter().map(result).collect())
            }
            Driver::Ports { terminate, fail } => End::Ports {
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
                let at = self.first[id.index()] as usize + usize::from(port.port);
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

fn kind(kind: ResultKind) -> EndKind {
    match kind {
        ResultKind::Finish => EndKind::Finish,
        ResultKind::Yield => EndKind::Yield,
        ResultKind::Fail => EndKind::Fail,
    }
}
