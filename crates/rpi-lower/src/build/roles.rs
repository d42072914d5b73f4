//! Lowering of primitives that the core handles by their role.

use super::Builder;
use super::compute::ports;
use super::inputs::{Flow, InputFlow};
use crate::flat_net::{self, NO_NODE, OpKind, index};
use crate::registers::{Region, Register};
use rpi_image::image::{self, DevicePort, Signal};
use rpi_image::{CommandFlow, DevicePortNames, DeviceUse, Presence, Scalar, Type, Value};
use rpi_net::passes::FlowPresence;
use rpi_net::{NodeId, PortRef};

impl Builder<'_> {
    pub(super) fn constant(&mut self, id: NodeId) {
        let net = self.net;
        let value = net.node(id).params.first();
        let value = value.map_or(Register::FALSE, |v| self.flat.registers.value(v));
        for port in ports(id, self.desc(id)) {
            self.set(
                port,
                Flow {
                    value,
                    present: Register::TRUE,
                },
            );
        }
    }

    /// Lowers a delay: copies the kept value to the output. The separate copy allows the kept value to be overwritten
    /// before the end of the cycle.
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
            self.copy(scope, kept.present, present, NO_NODE);
        }
        let given = self.output(port, present);
        self.copy(scope, kept.value, given.value, id.0);
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
                self.flat.scopes[self.scope[fragment.index()].index()]
                    .latches
                    .push((Register::FALSE, kept));
                self.first_flows.insert(fragment, kept);
                kept
            }
        };
        self.copy_to_output(id, kept);
    }

    /// Copies a value to a new register for the node's out-port, so that it can be observed and forced.
    fn copy_to_output(&mut self, id: NodeId, value: Register) {
        let scope = self.scope_of(id);
        let port = PortRef { node: id, port: 0 };
        let present = self.forcible_presence(scope, port, Register::TRUE);
        let own = self.output(port, present);
        self.copy(scope, value, own.value, id.0);
    }

    pub(super) fn sensor(&mut self, id: NodeId, device: DeviceUse) {
        for (k, port) in ports(id, self.desc(id)).enumerate() {
            let flow = self.external_flow(port);
            let value = self.signal(flow, self.ty(port));
            let port = self.device_port(id, device, k, value.ty);
            let sensor = image::SensorPort { port, value };
            self.flat.tables.sensors.push((sensor, id.0));
        }
    }

    pub(super) fn input_port(&mut self, id: NodeId) {
        let start = self.start_value(id);
        let mut signals = Vec::new();
        for (k, port) in ports(id, self.desc(id)).enumerate() {
            let flow = self.external_flow(port);
            if let (0, Some(content)) = (k, &start) {
                self.flat.registers.set_initial(flow.value, content);
            }
            signals.push(self.signal(flow, self.ty(port)));
        }
        let mut signals = signals.into_iter();
        if let Some(value) = signals.next() {
            let (key, updated) = (self.key(id), signals.next());
            self.flat.tables.inputs.push(image::InputPort {
                key,
                value,
                last_updated: updated,
            });
        }
    }

    /// Value of an input before it is set; `None` if it is zero.
    fn start_value(&self, id: NodeId) -> Option<Vec<u64>> {
        let node = self.net.node(id);
        let value = node.params.get(node.desc().param("Value")?)?;
        let fits = value.ty() == node.outputs.first().copied();
        (fits && value.slots().iter().any(|c| *c != 0)).then(|| value.slots().to_vec())
    }

    pub(super) fn flow(&mut self, id: NodeId, flow: CommandFlow) {
        for port in ports(id, self.desc(id)) {
            let slots = self.external_flow(port);
            let value = self.signal(slots, self.ty(port));
            self.flat
                .tables
                .flows
                .push(image::CoreFlow { kind: flow, value });
        }
    }

    pub(super) fn export(&mut self, id: NodeId) {
        let link = self.link(id, 0);
        let value = self.signal(link.flow, link.ty);
        let key = self.key(id);
        self.flat.tables.exports.push(image::Export { key, value });
    }

    pub(super) fn actuator(&mut self, id: NodeId, device: DeviceUse) {
        let links = self.links(id);
        let Some((scope, present)) = self.open_guard(id, &links, true) else {
            return;
        };
        let port = self.device_port(id, device, 0, concatenated_type(connected_types(&links)));
        let outputs = self.outputs(id, present);
        let words = words(&links, &outputs);
        let actuators = &mut self.flat.tables.actuators;
        let number = index(actuators.len());
        let answers = device.responses;
        actuators.push(flat_net::Actuator { port, answers });
        let inputs = index(words.len() - outputs.len());
        self.flat
            .push(scope, OpKind::Actuate(number, inputs), &words, id.0);
        self.close_guard(id, scope);
    }

    pub(super) fn function(&mut self, id: NodeId, device: DeviceUse) {
        let links = self.links(id);
        let Some((scope, present)) = self.open_guard(id, &links, true) else {
            return;
        };
        let outputs = self.outputs(id, present);
        let maybe = self
            .desc(id)
            .outputs
            .iter()
            .any(|o| o.presence == Presence::Maybe);
        let types = self.net.node(id).outputs.iter().copied();
        let port = self.device_port(id, device, 0, concatenated_type(types));
        let mut words = words(&links, &outputs);
        let inputs = index(words.len() - outputs.len());
        let mut found = Register::TRUE;
        if maybe {
            found = self.flat.registers.add(Region::Value, 1);
            words.push(found.0);
        }
        let number = index(self.flat.tables.functions.len());
        self.flat.tables.functions.push(flat_net::Function {
            port,
            may_fail: maybe,
            work: self.desc(id).work,
        });
        self.flat
            .push(scope, OpKind::Call(number, inputs), &words, id.0);
        self.close_guard(id, scope);
        self.restrict_presence(id, &outputs, found);
    }

    /// Makes the presence of out-ports also depend on `also`.
    fn restrict_presence(&mut self, id: NodeId, outputs: &[Flow], also: Register) {
        let scope = self.scope_of(id);
        for (port, flow) in ports(id, self.desc(id)).zip(outputs) {
            let present = self.logic.and(&mut self.flat, scope, flow.present, also);
            self.set(
                port,
                Flow {
                    value: flow.value,
                    present,
                },
            );
        }
    }

    /// External registers for an out-port, with a presence if it may be absent.
    fn external_flow(&mut self, port: PortRef) -> Flow {
        let value = self
            .flat
            .registers
            .add(Region::External, self.ty(port).slots());
        let present = match self.plan.presences.own(port) {
            FlowPresence::Total => Register::TRUE,
            FlowPresence::Optional | FlowPresence::Never => {
                self.flat.registers.add(Region::External, 1)
            }
        };
        let flow = Flow { value, present };
        self.set(port, flow);
        flow
    }

    pub(super) fn ty(&self, port: PortRef) -> Type {
        self.net.node(port.node).outputs[usize::from(port.port)]
    }

    pub(super) fn signal(&self, flow: Flow, ty: Type) -> Signal {
        Signal {
            start: flow.value.0,
            present: flow.present.0,
            ty,
        }
    }

    /// Key of an input or export: its string parameters, joined by `/`.
    fn key(&self, id: NodeId) -> String {
        let texts = self.net.node(id).params.iter().filter_map(Value::as_str);
        texts.collect::<Vec<_>>().join("/")
    }

    fn device_port(&self, id: NodeId, device: DeviceUse, k: usize, ty: Type) -> DevicePort {
        let text = |name: &str| {
            self.param_of(id, name)
                .and_then(Value::as_str)
                .unwrap_or("")
                .to_owned()
        };
        let index = device
            .index
            .and_then(|name| self.param_of(id, name)?.as_int());
        DevicePort {
            device: text(device.device),
            port: match device.ports {
                DevicePortNames::Fixed(names) => names.get(k).copied().unwrap_or("").to_owned(),
                DevicePortNames::Param(name) => text(name),
            },
            // An invalid index becomes one that no device has, so that loading reports it.
            index: index.map_or(0, |i| u32::try_from(i).unwrap_or(u32::MAX)),
            ty,
        }
    }

    fn param_of(&self, id: NodeId, name: &str) -> Option<&Value> {
        let node = self.net.node(id);
        node.params.get(node.desc().param(name)?)
    }
}

/// Words of connected inputs, then of outputs.
fn words(links: &[InputFlow], outputs: &[Flow]) -> Vec<u32> {
    let inputs = links.iter().filter(|l| !l.is_open).map(|l| l.flow);
    inputs
        .chain(outputs.iter().copied())
        .map(|f| f.value.0)
        .collect()
}

fn connected_types(links: &[InputFlow]) -> impl Iterator<Item = Type> {
    links.iter().filter(|l| !l.is_open).map(|l| l.ty)
}

/// Type of the concatenation of several ports.
fn concatenated_type(types: impl Iterator<Item = Type>) -> Type {
    let types: Vec<Type> = types.collect();
    match types[..] {
        [one] => one,
        _ => Type::Array(Scalar::Real, types.iter().map(|ty| ty.slots()).sum()),
    }
}
