//! Elaborates reads and writes of device ports.

use crate::elab::elementwise;
use crate::elab::expr;
use crate::elab::expr::leaf_scalars;
use crate::elab::flows;
use crate::elab::nodes;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::primitive_family::member;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire, empty_wire};
use crate::elab::subrange;
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::ty::{DevicePortTy, DeviceTy, Ty};
use crate::typed::{ExprId, FlowId, Target};
use rpi_diag::Span;
use rpi_image::{Scalar, Type, Value};
use rpi_net::{Alternatives, FragmentId, Inputs, PortRef};
use rpi_prims::PrimId;

/// Elaborates a read of the sensor or status port with index `port` and returns its signals. Each port is read once, at
/// the start of the cycle, independently of activations.
pub(super) fn sensor<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    device: ExprId,
    port: u32,
    at: Position,
    span: Span,
) -> Wire {
    if elab.mode == ElabMode::Constant {
        return elab.fail(NotConstantError::RunTime(span));
    }
    let unit = scope.unit;
    let Ty::Device(ty) = &unit.expr(device).ty else {
        return empty_wire();
    };
    let name = expr::elab_expr(elab, scope, device, at);
    let name = name.first().cloned().unwrap_or(Signal::Absent);
    let (Some(name), Some(port)) = (device_name(elab, &name), ty.ports.get(port as usize)) else {
        return empty_wire();
    };
    let family = if port.optional {
        PrimitiveFamily::Sample
    } else {
        PrimitiveFamily::Read
    };
    let scalars = port.ty.as_ref().map(leaf_scalars).unwrap_or_default();
    let known = elab.cache.sensors.len();
    let mut leaves = Vec::with_capacity(scalars.len());
    let places = port.ty.iter().flat_map(|ty| leaf_places(ty, &port.name));
    for ((leaf, k), scalar) in places.zip(scalars) {
        let key = (name.clone(), leaf, k);
        leaves.push(match elab.cache.sensors.get(&key) {
            Some(port) => Signal::Port(*port),
            None => read(elab, family, scalar, key, span),
        });
    }
    match &port.ty {
        Some(ty) if elab.cache.sensors.len() > known => {
            check_sensor_subranges(elab, leaves, ty, (&name, &port.name), span)
        }
        _ => leaves.into(),
    }
}

/// Checks that the value of a sensor port that is read for the first time is in the subrange of its type. `of` is the
/// device and the port. Returns the checked signals.
fn check_sensor_subranges(
    elab: &mut Elaborator<'_>,
    leaves: Vec<Signal>,
    ty: &Ty,
    of: (&str, &str),
    span: Span,
) -> Wire {
    let count = leaves.len();
    let wire = subrange::check_leaves(elab, leaves.into(), ty, 0..count, (Position::ROOT, span));
    for ((leaf, k), signal) in leaf_places(ty, of.1).into_iter().zip(wire.iter()) {
        if let Signal::Port(port) = signal {
            let key = (of.0.to_owned(), leaf, k);
            elab.cache.sensors.insert(key, *port);
        }
    }
    wire
}

/// Returns the port name and index by which a device knows each leaf (scalar part) of a sensor value. A field of a
/// struct has a port name of its own, as in `state.pose`, and the elements of an array are numbered.
fn leaf_places(ty: &Ty, port: &str) -> Vec<(String, u32)> {
    let mut places: Vec<(String, u32)> = Vec::new();
    ty.for_each_leaf(&mut |path, _| {
        let name = format!("{port}{}", without_indices(path));
        let next = match places.last() {
            Some((last, index)) if *last == name => index + 1,
            _ => 0,
        };
        places.push((name, next));
    });
    places
}

/// Returns the path of a part without its indices: `.x` for `.x[2]`.
fn without_indices(path: &str) -> String {
    let mut depth = 0;
    let outside = |c: &char| {
        depth += i32::from(*c == '[');
        let is_outside = depth == 0;
        depth -= i32::from(*c == ']');
        is_outside
    };
    path.chars().filter(outside).collect()
}

fn read(
    elab: &mut Elaborator<'_>,
    family: PrimitiveFamily,
    scalar: Scalar,
    key: (String, String, u32),
    span: Span,
) -> Signal {
    let Some(prim) = member(family, scalar) else {
        return Signal::Absent;
    };
    let params = port_params(prim, &key.0, &key.1, key.2);
    let node = nodes::add_node(
        elab,
        prim,
        Inputs::new(),
        params,
        rpi_net::Types::from([Type::Scalar(scalar)]),
        FragmentId::ROOT,
        span,
    );
    elab.net.nodes[node.index()].name = format!("{}.{}#{}", key.0, key.1, node.0);
    elab.net.nodes[node.index()].origin.flow = Some(port_name(&key.0, &key.1, key.2));
    let port = PortRef { node, port: 0 };
    elab.cache.sensors.insert(key, port);
    Signal::Port(port)
}

fn device_name(elab: &Elaborator<'_>, signal: &Signal) -> Option<String> {
    elementwise::constant_value(elab, signal)?
        .as_str()
        .map(str::to_owned)
}

/// Adds the writes of a set-point to the actuator port with index `port`, one net node for each leaf (scalar part).
/// `wire` has the signals of the set-point.
pub(super) fn write<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    device: FlowId,
    port: u32,
    target: &Target,
    wire: &Wire,
    at: Position,
) {
    let unit = scope.unit;
    let Some(ty): Option<&DeviceTy> = unit.device_type_instance(device).map(|ty| &**ty) else {
        return;
    };
    let name = flows::elab_flow(elab, scope, device, target.span);
    let name = name.first().and_then(|signal| device_name(elab, signal));
    let (Some(name), Some(port)) = (name, ty.ports.get(port as usize)) else {
        return;
    };
    record_alternatives(elab, &name, ty, port);
    for (k, (scalar, signal)) in (0..).zip(leaf_scalars(&target.ty).into_iter().zip(wire.iter())) {
        let Some(prim) = member(PrimitiveFamily::Write, scalar) else {
            continue;
        };
        let params = port_params(prim, &name, &port.name, k);
        let inputs = vec![Some(crate::elab::signal::single_wire(signal.clone()))];
        nodes::add_prim(elab, prim, inputs, params, at, target.span);
    }
}

/// Records in the net that the ports of an actuator of which the port `port` is one exclude one another.
fn record_alternatives(
    elab: &mut Elaborator<'_>,
    device: &str,
    ty: &DeviceTy,
    port: &DevicePortTy,
) {
    let same = |other: &&DevicePortTy| other.is_actuator && other.actuator == port.actuator;
    let group = Alternatives {
        device: device.to_owned(),
        ports: ty
            .ports
            .iter()
            .filter(same)
            .map(|p| p.name.to_string())
            .collect(),
    };
    if group.ports.len() > 1 && !elab.net.alternatives.contains(&group) {
        elab.net.alternatives.push(group);
    }
}

/// Returns the name of a port's leaf (scalar part), such as `arm.joints[2]`; without an index for leaf 0.
fn port_name(device: &str, port: &str, index: u32) -> String {
    match index {
        0 => format!("{device}.{port}"),
        _ => format!("{device}.{port}[{index}]"),
    }
}

fn port_params(prim: PrimId, device: &str, port: &str, index: u32) -> Vec<Value> {
    let value = |param: &rpi_image::Param| match param.name {
        "Device" => Some(Value::Str(device.to_owned())),
        "Port" => Some(Value::Str(port.to_owned())),
        "Index" => Some(Value::int(index.into())),
        _ => crate::ty::machine_types::param_default(param),
    };
    prim.desc().params.iter().filter_map(value).collect()
}
