//! Lowering of primitives that the core handles by their role.

use super::Builder;
use super::compute::ports;
use super::flows::Flow;
use super::port_names;
use crate::flat_net::NO_NODE;
use crate::registers::{Region, Register};
use rpi_image::image;
use rpi_image::{CommandFlow, Presence, Value};
use rpi_net::passes::FlowPresence;
use rpi_net::{NodeId, PortRef};

impl Builder<'_> {
    pub(super) fn constant(&mut self, id: NodeId) {
        let net = self.net;
        let value = net.node(id).params.first();
        let value = value.map_or(Register::FALSE, |v| self.flat.registers.value(v));
        for port in ports(id, self.desc(id)) {
            self.flows.set(port, Flow::total(value));
        }
    }

    /// Adds the state registers of a delay node and the copies from them to its output. The separate output allows the
    /// state to be overwritten before the end of the cycle. The copies into the state are added by
    /// [`Builder::latches`].
    pub(super) fn delay(&mut self, id: NodeId) {
        let port = PortRef { node: id, port: 0 };
        let node = self.net.node(id);
        let (Some(ty), region) = (node.outputs.first(), Region::State(node.fragment)) else {
            return;
        };
        let scope = self.scope_of(id);
        let first = Value::neutral(*ty);
        let total = self.plan.presences.own(port) == FlowPresence::Total;
        let present_at_first = self.desc(id).outputs[0].presence != Presence::Maybe;
        let kept = Flow {
            value: self.flat.registers.add_with_initial(region, first.slots()),
            present: match total {
                true => Register::TRUE,
                false => self
                    .flat
                    .registers
                    .add_with_initial(region, &[u64::from(present_at_first)]),
            },
        };
        let present = match total {
            true => Register::TRUE,
            false => self.flat.registers.add(Region::Value, 1),
        };
        if !total {
            self.flat.copy(scope, kept.present, present, NO_NODE);
        }
        let output = self.output(port, present);
        self.flat.copy(scope, kept.value, output.value, id.0);
        self.delays.push((id, kept));
    }

    pub(super) fn is_absent(&mut self, id: NodeId) {
        let link = self.link(id, 0);
        let scope = self.scope_of(id);
        let value = self.logic.not(&mut self.flat, scope, link.flow.present);
        self.copy_to_output(id, value);
    }

    pub(super) fn first(&mut self, id: NodeId) {
        let fragment = self.net.node(id).fragment;
        let kept = match self.first_flows.get(&fragment) {
            Some(kept) => *kept,
            None => {
                let kept = self
                    .flat
                    .registers
                    .add_with_initial(Region::State(fragment), &[1]);
                self.flat.scopes[self.fragments.scope(fragment).index()]
                    .latches
                    .push((Register::FALSE, kept));
                self.first_flows.insert(fragment, kept);
                kept
            }
        };
        self.copy_to_output(id, kept);
    }

    /// Copies a register to a new register for the single out-port of a node, so that the flow of the node can be
    /// observed and forced by itself.
    fn copy_to_output(&mut self, id: NodeId, value: Register) {
        let scope = self.scope_of(id);
        let port = PortRef { node: id, port: 0 };
        let present = self.forcible_presence(scope, port, Register::TRUE);
        let own = self.output(port, present);
        self.flat.copy(scope, value, own.value, id.0);
    }

    pub(super) fn input_port(&mut self, id: NodeId) {
        let start = port_names::start_value(self.net.node(id));
        let mut signals = Vec::new();
        for (k, port) in ports(id, self.desc(id)).enumerate() {
            let flow = self.external_flow(port);
            if let (0, Some(content)) = (k, &start) {
                self.flat.registers.set_initial(flow.value, content);
            }
            signals.push(flow.to_signal(self.net.output_type(port)));
        }
        let mut signals = signals.into_iter();
        if let Some(value) = signals.next() {
            let (key, updated) = (port_names::key(self.net.node(id)), signals.next());
            let unit = self.net.input_units.get(&key).cloned().unwrap_or_default();
            self.flat.tables.inputs.push(image::InputPort {
                key,
                unit,
                value,
                last_updated: updated,
            });
        }
    }

    pub(super) fn flow(&mut self, id: NodeId, flow: CommandFlow) {
        for port in ports(id, self.desc(id)) {
            let slots = self.external_flow(port);
            let value = slots.to_signal(self.net.output_type(port));
            self.flat
                .tables
                .flows
                .push(image::CoreFlow { kind: flow, value });
        }
    }

    pub(super) fn export(&mut self, id: NodeId) {
        let link = self.link(id, 0);
        let value = link.flow.to_signal(link.ty);
        let key = port_names::key(self.net.node(id));
        self.flat.tables.exports.push(image::Export {
            key,
            unit: String::new(),
            value,
        });
    }

    /// Adds registers for an out-port whose value the core sets between cycles, and returns them. If the flow may be
    /// absent, the core sets its presence register, too.
    pub(super) fn external_flow(&mut self, port: PortRef) -> Flow {
        let value = self
            .flat
            .registers
            .add(Region::External, self.net.output_type(port).slots());
        let present = match self.plan.presences.own(port) {
            FlowPresence::Total => Register::TRUE,
            FlowPresence::Optional | FlowPresence::Never => {
                self.flat.registers.add(Region::External, 1)
            }
        };
        let flow = Flow { value, present };
        self.flows.set(port, flow);
        flow
    }
}
