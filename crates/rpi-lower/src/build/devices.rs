//! Lowering of sensors, set-points and device functions.

use super::Builder;
use super::compute::ports;
use super::flows::{Flow, InputFlow};
use super::port_names::{self, device_port};
use crate::flat_net::{self, OpKind, index};
use crate::registers::{Region, Register};
use rpi_image::external::{EXTERNAL_DEVICE, EXTERNAL_KINDS, ExternalFunction, ExternalPort};
use rpi_image::image::{DevicePort, SensorPort};
use rpi_image::{DeviceUse, Presence, Scalar, Type, Value};
use rpi_net::NodeId;

/// Adds the device ports that a sensor node reads to the sensor table, one for each out-port.
pub(super) fn sensor(builder: &mut Builder<'_>, id: NodeId, device: DeviceUse) {
    for (k, port) in ports(id, builder.desc(id)).enumerate() {
        let flow = builder.external_flow(port);
        let value = flow.to_signal(builder.net.output_type(port));
        let port = device_port(builder.net.node(id), device, k, value.ty);
        let sensor = SensorPort { port, value };
        builder.flat.tables.sensors.push((sensor, id.0));
    }
}

/// Adds the device port of an actuator node to the actuator table, and the operation that sets it. Adds neither if an
/// input is never present.
pub(super) fn actuator(builder: &mut Builder<'_>, id: NodeId, device: DeviceUse) {
    let links = builder.links(id);
    let Some((scope, present)) = builder.open_guard(id, &links, true) else {
        return;
    };
    let port = device_port(
        builder.net.node(id),
        device,
        0,
        concatenated_type(connected_types(&links)),
    );
    let outputs = builder.outputs(id, present);
    let words = words(builder, id, &links, &outputs);
    let actuators = &mut builder.flat.tables.actuators;
    let number = index(actuators.len());
    let answers = device.responses;
    actuators.push(flat_net::Actuator { port, answers });
    let inputs = index(words.len() - outputs.len());
    builder
        .flat
        .push(scope, OpKind::Actuate(number, inputs), &words, id.0);
    builder.close_guard(id, scope);
}

/// Adds the function of a node that calls a device function, such as inverse kinematics, to the function table, and the
/// operation that calls it. Adds neither if an input is never present.
pub(super) fn function(builder: &mut Builder<'_>, id: NodeId, device: DeviceUse) {
    let types = builder.net.node(id).outputs.iter().copied();
    let port = device_port(builder.net.node(id), device, 0, concatenated_type(types));
    call(builder, id, port, None);
}

/// Adds the external function of a node, whose signature is the text parameter with this name, to the function table,
/// and the operation that calls it. A node without a valid signature never has results.
pub(super) fn external(builder: &mut Builder<'_>, id: NodeId, signature: &str) {
    let node = builder.net.node(id);
    let text = port_names::param(node, signature).and_then(Value::as_str);
    let Some(external) = text.and_then(ExternalFunction::from_text) else {
        return;
    };
    let port = DevicePort {
        device: EXTERNAL_DEVICE.to_owned(),
        port: external.symbol.clone(),
        index: 0,
        ty: concatenated_type(node.outputs.iter().copied()),
    };
    call(builder, id, port, Some(external));
}

fn call(
    builder: &mut Builder<'_>,
    id: NodeId,
    port: DevicePort,
    external: Option<ExternalFunction>,
) {
    let links = builder.links(id);
    let results = &builder.net.node(id).outputs;
    if external.as_ref().is_some_and(|e| !fits(e, &links, results)) {
        return;
    }
    let Some((scope, present)) = builder.open_guard(id, &links, true) else {
        return;
    };
    let outputs = builder.outputs(id, present);
    let maybe = builder
        .desc(id)
        .outputs
        .iter()
        .any(|o| o.presence == Presence::Maybe);
    let mut words = words(builder, id, &links, &outputs);
    let inputs = index(connected(&links).count());
    let mut found = Register::TRUE;
    if maybe {
        found = builder.flat.registers.add(Region::Value, 1);
        words.push(found.0);
    }
    let number = index(builder.flat.tables.functions.len());
    builder.flat.tables.functions.push(flat_net::Function {
        port,
        may_fail: maybe,
        work: builder.desc(id).work,
        external,
    });
    builder
        .flat
        .push(scope, OpKind::Call(number, inputs), &words, id.0);
    builder.close_guard(id, scope);
    restrict_presence(builder, id, &outputs, found);
}

/// Returns whether the values of a node are those of a signature, group by group. A program may write a call of the primitive
/// itself, with any signature.
fn fits(external: &ExternalFunction, links: &[InputFlow], results: &[Type]) -> bool {
    let same = |types: &[Type], ports: &[ExternalPort]| {
        let kinds = EXTERNAL_KINDS.iter();
        let lens = kinds.map(|kind| ExternalFunction::group_len(ports, *kind));
        lens.eq(types.iter().map(|ty| ty.slots()))
    };
    let arguments: Vec<Type> = links.iter().map(|l| l.ty).collect();
    same(&arguments, &external.inputs) && same(results, &external.outputs)
}

/// Makes the presence of a node's out-ports also depend on the Boolean register `also`: a flow in `outputs` then is
/// present only if its own presence register and `also` are true.
fn restrict_presence(builder: &mut Builder<'_>, id: NodeId, outputs: &[Flow], also: Register) {
    let scope = builder.scope_of(id);
    for (port, flow) in ports(id, builder.desc(id)).zip(outputs) {
        let present = builder
            .logic
            .and(&mut builder.flat, scope, flow.present, also);
        builder.flows.set(
            port,
            Flow {
                value: flow.value,
                present,
            },
        );
    }
}

/// Returns the operand words of a device access: the value registers of the connected in-ports, then those of the
/// out-ports. Empty arrays have none.
fn words(builder: &Builder<'_>, id: NodeId, links: &[InputFlow], outputs: &[Flow]) -> Vec<u32> {
    let types = builder.net.node(id).outputs.iter();
    let results = outputs.iter().zip(types).filter(|(_, ty)| ty.slots() > 0);
    let arguments = connected(links).map(|l| l.flow);
    let flows = arguments.chain(results.map(|(flow, _)| *flow));
    flows.map(|f| f.value.0).collect()
}

/// Returns the connected in-ports with at least one value.
fn connected(links: &[InputFlow]) -> impl Iterator<Item = &InputFlow> {
    links.iter().filter(|l| !l.is_open && l.ty.slots() > 0)
}

fn connected_types(links: &[InputFlow]) -> impl Iterator<Item = Type> {
    links.iter().filter(|l| !l.is_open).map(|l| l.ty)
}

/// Returns the type of several values in a row: an array of reals with the slots of all. A single value keeps its type.
fn concatenated_type(types: impl Iterator<Item = Type>) -> Type {
    let types: Vec<Type> = types.collect();
    match types[..] {
        [one] => one,
        _ => Type::Array(Scalar::Real, types.iter().map(|ty| ty.slots()).sum()),
    }
}
