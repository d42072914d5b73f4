//! Processes the nodes of a cycle: input values are taken from the trace, all other values are compared with it.

use rpi_core::Machine;
use rpi_image::image::Signal;
use rpi_image::{State, Type};
use rpi_net::{Input, NodeId, PortRef};
use rpi_prims::differences::{self, When};

use super::engine::Replay;
use super::explain::{explain, may_be_wrong, reads_aliased};
use super::path;
use super::plan::{Alias, AliasPlace};
use super::recorded::Recorded;
use super::relation::{Relation, relate};
use super::tally::Occasion;
use super::text::text;

impl Replay<'_> {
    pub(super) fn finish(&mut self, id: NodeId) {
        let watched = &self.plan.nodes[id.index()];
        let (ports, is_input) = (watched.outs.len(), watched.is_input);
        self.unsure[id.index()] = self.reads_unsure(id);
        let hands_on = differences::passes_on(self.net.node(id).desc().name);
        self.aliased[id.index()] = hands_on && reads_aliased(self, id);
        for k in 0..ports {
            let port = PortRef {
                node: id,
                port: k as u8,
            };
            match is_input {
                true => self.take(port),
                false => self.compare(port),
            }
        }
    }

    /// Returns true if a node depends on an unknown value. A node with state stays unknown from then on.
    fn reads_unsure(&self, id: NodeId) -> bool {
        let node = self.net.node(id);
        let keeps = !matches!(node.desc().state, State::None);
        let reads = |input: &Input| matches!(input, Input::Port(p) if self.unsure[p.node.index()]);
        (keeps && self.unsure[id.index()]) || node.inputs.iter().any(reads)
    }

    /// Forces an input port to its recorded value.
    fn take(&mut self, port: PortRef) {
        let recorded = self.recorded(port);
        let held = &mut self.held[port.node.index()][usize::from(port.port)];
        match recorded {
            Recorded::Unknown => {
                let as_recorded = self.plan.out(port).recorded;
                let varies = as_recorded.is_some_and(|p| self.varies[p.0 as usize]);
                self.unsure[port.node.index()] |= varies;
            }
            known => {
                self.tally.report.taken += u64::from(known != Recorded::Absent);
                *held = known;
            }
        }
        let signal = self.plan.out(port).signal;
        let held = &self.held[port.node.index()][usize::from(port.port)];
        if !force(&mut self.machine, signal, held) {
            let name = self.name(port);
            self.tally.differs(self.occasion(port, &name), None);
        }
    }

    /// Compares the computed value of a port with the recorded one.
    fn compare(&mut self, port: PortRef) {
        let recorded = self.recorded(port);
        if recorded == Recorded::Unknown {
            let desc = self.net.node(port.node).desc();
            self.unsure[port.node.index()] |= may_be_wrong(desc, usize::from(port.port));
        }
        if self.is_unsure(port.node, &recorded) {
            return;
        }
        let nature = self.nature(port);
        let computed = self.computed(port).map(<[u64]>::to_vec);
        let ty = self.plan.out(port).signal.ty;
        let relation = relate(ty, nature, computed.as_deref(), &recorded, self.tolerance);
        self.note_off(port, relation);
        self.judge(port, ty, computed.as_deref(), &recorded, relation);
    }

    fn judge(
        &mut self,
        port: PortRef,
        ty: Type,
        computed: Option<&[u64]>,
        recorded: &Recorded,
        relation: Relation,
    ) {
        if relation == Relation::Unknown {
            return;
        }
        self.tally.compared(recorded);
        let name = self.name(port);
        let at = self.occasion(port, &name);
        match relation {
            Relation::Unknown => {}
            Relation::Agrees(deviation) => {
                let texts = || (text(computed, ty), recorded.text(ty));
                self.tally.agrees(at, deviation, texts);
            }
            Relation::Rewritten => {
                self.tally.report.rewritten += 1;
                force(&mut self.machine, self.plan.out(port).signal, recorded);
            }
            Relation::Differs(deviation) => match explain(self, port, computed, recorded) {
                Some(entry) => {
                    self.tally.explained(at, entry.name, entry.fault);
                    self.aliased[port.node.index()] |= matches!(entry.when, When::AliasedSource);
                    force(&mut self.machine, self.plan.out(port).signal, recorded);
                }
                None if self.tally.differs(at, deviation) => {
                    self.tally.report.first = Some(path::divergence(self, port));
                }
                None => {}
            },
        }
    }

    fn occasion<'s>(&self, port: PortRef, name: &'s str) -> Occasion<'s> {
        Occasion {
            cycle: self.view.number,
            port: name,
            primitive: self.net.node(port.node).desc().name,
        }
    }

    pub(super) fn alias(&mut self, k: usize) {
        let alias = &self.plan.aliases[k];
        let recorded = match alias.place {
            AliasPlace::Border(port) => self.view.out_port(port, alias.ty),
            AliasPlace::InPort(port) => self.view.in_port(port, alias.ty),
        };
        if let Input::Port(port) = alias.source
            && self.unsure[port.node.index()]
        {
            self.tally.report.unknown += u64::from(recorded != Recorded::Unknown);
            return;
        }
        self.judge_alias(k, &recorded);
    }

    fn judge_alias(&mut self, k: usize, recorded: &Recorded) {
        let Alias {
            name, ty, source, ..
        } = &self.plan.aliases[k];
        let computed = self.input(source);
        let nature = self.alias_nature(source);
        let relation = relate(*ty, nature, computed, recorded, self.tolerance);
        if relation == Relation::Unknown {
            return;
        }
        self.tally.compared(recorded);
        if let Relation::Differs(deviation) = relation {
            let at = Occasion {
                cycle: self.view.number,
                port: name,
                primitive: "",
            };
            if self.tally.differs(at, deviation) {
                let (name, source) = (name.clone(), source.clone());
                self.tally.report.first = Some(path::alias_divergence(self, &name, &source));
            }
        }
    }

    fn is_unsure(&mut self, id: NodeId, recorded: &Recorded) -> bool {
        let unsure = self.unsure[id.index()];
        self.tally.report.unknown += u64::from(unsure && *recorded != Recorded::Unknown);
        unsure
    }

    /// Stores the first cycle in which a port deviates by any amount.
    fn note_off(&mut self, port: PortRef, relation: Relation) {
        if !matches!(relation, Relation::Unknown) && relation != Relation::Agrees(0.0) {
            let since = &mut self.since[port.node.index()][usize::from(port.port)];
            since.get_or_insert(self.view.number);
        }
    }
}

/// Forces a port to a recorded value. Values that were not recorded leave the port unchanged. Returns false if the
/// recorded value has the wrong type.
fn force(machine: &mut Machine, signal: Signal, recorded: &Recorded) -> bool {
    match recorded {
        Recorded::Value(cells) => machine.force(signal, Some(cells)),
        Recorded::Absent => machine.force(signal, None),
        Recorded::Unknown | Recorded::Opaque => true,
        Recorded::Foreign(_) => false,
    }
}
