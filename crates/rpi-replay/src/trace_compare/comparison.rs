//! Processes the nodes of a cycle: input values are taken from the trace, all other values are compared with it.

use rpi_core::Instance;
use rpi_image::image::Signal;
use rpi_image::{StateSize, Type};
use rpi_net::{Input, NodeId, PortRef};
use rpi_prims::differences::{self, Condition};

use super::comparison_plan::{Alias, AliasKind};
use super::counters::PortInCycle;
use super::divergence_path;
use super::engine::Replay;
use super::explain::{explain, may_be_wrong, reads_aliased};
use super::relation::{Relation, compare};
use super::text::value_text;
use super::trace_view::RecordedValue;

impl Replay<'_> {
    pub(super) fn process_node(&mut self, id: NodeId) {
        let watched = &self.plan.nodes[id.index()];
        let (ports, is_input) = (watched.out_ports.len(), watched.is_input);
        self.unknown[id.index()] = self.reads_unknown(id);
        let hands_on = differences::outputs_alias(self.net.node(id).desc().name);
        self.aliased[id.index()] = hands_on && reads_aliased(self, id);
        for k in 0..ports {
            let port = PortRef {
                node: id,
                port: k as u8,
            };
            match is_input {
                true => self.force_input(port),
                false => self.compare(port),
            }
        }
    }

    /// Returns true if a node depends on a value that the trace does not contain, so that its own values are unknown. A
    /// node with state stays unknown from then on.
    fn reads_unknown(&self, id: NodeId) -> bool {
        let node = self.net.node(id);
        let keeps = !matches!(node.desc().state, StateSize::None);
        let reads = |input: &Input| matches!(input, Input::Port(p) if self.unknown[p.node.index()]);
        (keeps && self.unknown[id.index()]) || node.inputs.iter().any(reads)
    }

    /// Sets an out-port whose value comes from the environment, such as a sensor, to the value recorded in this cycle.
    fn force_input(&mut self, port: PortRef) {
        let recorded = self.recorded(port);
        let held = &mut self.held_inputs[port.node.index()][usize::from(port.port)];
        match recorded {
            RecordedValue::Unknown => {
                let as_recorded = self.plan.out_port(port).recorded;
                let varies = as_recorded.is_some_and(|p| self.varies[p.0 as usize]);
                self.unknown[port.node.index()] |= varies;
            }
            known => {
                self.tally.report.taken += u64::from(known != RecordedValue::Absent);
                *held = known;
            }
        }
        let signal = self.plan.out_port(port).signal;
        let held = &self.held_inputs[port.node.index()][usize::from(port.port)];
        if !force(&mut self.machine, signal, held) {
            let name = self.port_name(port);
            self.tally
                .count_differing(self.port_in_cycle(port, &name), None);
        }
    }

    /// Compares the computed value of a port in this cycle with the recorded one, and counts the result.
    fn compare(&mut self, port: PortRef) {
        let recorded = self.recorded(port);
        if recorded == RecordedValue::Unknown {
            let desc = self.net.node(port.node).desc();
            self.unknown[port.node.index()] |= may_be_wrong(desc, usize::from(port.port));
        }
        if self.count_unknown(port.node, &recorded) {
            return;
        }
        let nature = self.comparison(port);
        let computed = self.computed(port).map(<[u64]>::to_vec);
        let ty = self.plan.out_port(port).signal.ty;
        let relation = compare(ty, nature, computed.as_deref(), &recorded, self.tolerance);
        self.note_deviation(port, relation);
        self.record_relation(port, ty, computed.as_deref(), &recorded, relation);
    }

    fn record_relation(
        &mut self,
        port: PortRef,
        ty: Type,
        computed: Option<&[u64]>,
        recorded: &RecordedValue,
        relation: Relation,
    ) {
        if relation == Relation::NotComparable {
            return;
        }
        self.tally.count_compared(recorded);
        let name = self.port_name(port);
        let at = self.port_in_cycle(port, &name);
        match relation {
            Relation::NotComparable => {}
            Relation::Agrees(deviation) => {
                let texts = || (value_text(computed, ty), recorded.text(ty));
                self.tally.count_agreeing(at, deviation, texts);
            }
            Relation::EquivalentAngle => {
                self.tally.report.rewritten += 1;
                force(&mut self.machine, self.plan.out_port(port).signal, recorded);
            }
            Relation::Differs(deviation) => match explain(self, port, computed, recorded) {
                Some(entry) => {
                    self.tally.count_explained(at, entry.name, entry.fault);
                    self.aliased[port.node.index()] |=
                        matches!(entry.condition, Condition::AliasedSource);
                    force(&mut self.machine, self.plan.out_port(port).signal, recorded);
                }
                None if self.tally.count_differing(at, deviation) => {
                    self.tally.report.first = Some(divergence_path::divergence(self, port));
                }
                None => {}
            },
        }
    }

    fn port_in_cycle<'s>(&self, port: PortRef, name: &'s str) -> PortInCycle<'s> {
        PortInCycle {
            cycle: self.view.number,
            port: name,
            primitive: self.net.node(port.node).desc().name,
        }
    }

    pub(super) fn compare_alias(&mut self, k: usize) {
        let alias = &self.plan.aliases[k];
        let recorded = match alias.place {
            AliasKind::FragmentOutput(port) => self.view.out_port(port, alias.ty),
            AliasKind::InPort(port) => self.view.in_port(port, alias.ty),
        };
        if let Input::Port(port) = alias.source
            && self.unknown[port.node.index()]
        {
            self.tally.report.unknown += u64::from(recorded != RecordedValue::Unknown);
            return;
        }
        self.record_alias_relation(k, &recorded);
    }

    fn record_alias_relation(&mut self, k: usize, recorded: &RecordedValue) {
        let Alias {
            name, ty, source, ..
        } = &self.plan.aliases[k];
        let computed = self.input_value(source);
        let nature = self.alias_comparison(source);
        let relation = compare(*ty, nature, computed, recorded, self.tolerance);
        if relation == Relation::NotComparable {
            return;
        }
        self.tally.count_compared(recorded);
        if let Relation::Differs(deviation) = relation {
            let at = PortInCycle {
                cycle: self.view.number,
                port: name,
                primitive: "",
            };
            if self.tally.count_differing(at, deviation) {
                let (name, source) = (name.clone(), source.clone());
                self.tally.report.first =
                    Some(divergence_path::alias_divergence(self, &name, &source));
            }
        }
    }

    fn count_unknown(&mut self, id: NodeId, recorded: &RecordedValue) -> bool {
        let unsure = self.unknown[id.index()];
        self.tally.report.unknown += u64::from(unsure && *recorded != RecordedValue::Unknown);
        unsure
    }

    /// Stores the number of the cycle if the port deviates from the trace for the first time, by any amount.
    fn note_deviation(&mut self, port: PortRef, relation: Relation) {
        if !matches!(relation, Relation::NotComparable) && relation != Relation::Agrees(0.0) {
            let since = &mut self.first_deviation[port.node.index()][usize::from(port.port)];
            since.get_or_insert(self.view.number);
        }
    }
}

/// Sets a port of the running net to a recorded value. Values that were not recorded leave the port unchanged. Returns
/// false if the recorded value has the wrong type.
fn force(machine: &mut Instance, signal: Signal, recorded: &RecordedValue) -> bool {
    match recorded {
        RecordedValue::Value(cells) => machine.force(signal, Some(cells)),
        RecordedValue::Absent => machine.force(signal, None),
        RecordedValue::Unknown | RecordedValue::Unprintable => true,
        RecordedValue::WrongType(_) => false,
    }
}
