//! Arrays at the ports of primitives: packs leaves, extracts elements, and passes whole arrays on directly.

use crate::elab::built_arrays;
use crate::elab::deferred_arrays;
use crate::elab::nodes;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::primitive_family::member;
use crate::elab::signal::{Signal, alias_of};
use crate::elab::{Elaborator, Position};
use rpi_diag::Span;
use rpi_image::{PortType, Scalar, Type, Value};
use rpi_net::prim;
use rpi_net::{Input, Inputs, PortRef, Types};
use rpi_prims::PrimId;
use smallvec::smallvec;

/// Returns the input of a net node for an in-port of type `ty`, connected to the signals of the value's leaves (scalar
/// parts).
pub(super) fn elab_input(
    elab: &mut Elaborator<'_>,
    wire: &[Signal],
    ty: Type,
    at: Position,
    span: Span,
) -> Input {
    match (ty, wire.first()) {
        (Type::Scalar(_), None) => Input::Unconnected,
        (Type::Scalar(scalar), Some(signal)) => one_input(elab, signal, scalar, at, span),
        (Type::Array(..) | Type::Matrix(..), _) => array_input(elab, wire, ty, at, span),
    }
}

pub(super) fn one_input(
    elab: &mut Elaborator<'_>,
    signal: &Signal,
    scalar: Scalar,
    at: Position,
    span: Span,
) -> Input {
    match signal {
        Signal::Const(value) => Input::constant(value.clone()),
        Signal::Port(port) => Input::Port(*port),
        Signal::Element(port, k) => Input::Port(elab_element(elab, *port, *k, span)),
        Signal::Absent => match absent_leaves(elab, scalar, at, span) {
            Some(port) => Input::Port(port),
            None => Input::Unconnected,
        },
    }
}

/// Adds a net node whose output is absent in every cycle, and returns its port; `None` if there is no primitive for the
/// type.
pub(super) fn absent_leaves(
    elab: &mut Elaborator<'_>,
    scalar: Scalar,
    at: Position,
    span: Span,
) -> Option<PortRef> {
    let prim = member(PrimitiveFamily::SetNull, scalar)?;
    let value = Input::constant(Value::neutral(Type::Scalar(scalar)));
    let inputs = smallvec![value, Input::constant(Value::bool(true))];
    let params = crate::elab::nodes::default_params(prim);
    let node = nodes::add_node(
        elab,
        prim,
        inputs,
        params,
        Types::from([Type::Scalar(scalar)]),
        at.fragment,
        span,
    );
    Some(PortRef { node, port: 0 })
}

/// Returns the port with element `k` of an array port. The element is extracted once, in the fragment of the array, and
/// the port is used again.
pub(super) fn elab_element(
    elab: &mut Elaborator<'_>,
    array: PortRef,
    k: u32,
    span: Span,
) -> PortRef {
    if let Some(port) = elab.cache.elements.get(&(array, k)) {
        return *port;
    }
    let source = elab.net.node(array.node);
    let (fragment, ty) = (
        source.fragment,
        source.outputs.get(usize::from(array.port)).copied(),
    );
    let port = ty
        .and_then(|ty| extract_element(elab, array, ty, k, Position::in_fragment(fragment), span));
    let port = port.unwrap_or(array);
    elab.cache.elements.insert((array, k), port);
    port
}

/// Adds a net node that extracts element `k` of an array port, and returns its port. `ty` is the type of the array.
fn extract_element(
    elab: &mut Elaborator<'_>,
    array: PortRef,
    ty: Type,
    k: u32,
    at: Position,
    span: Span,
) -> Option<PortRef> {
    let (prim, scalar, mut given) = match ty {
        Type::Scalar(_) => return None,
        Type::Array(scalar, n) => {
            let get = member(PrimitiveFamily::ArrayGet, scalar)?;
            (get, scalar, vec![("Size", n)])
        }
        Type::Matrix(..) => (prim!("Core::MatrixGet"), Scalar::Real, Vec::new()),
    };
    given.extend(element_params(ty, k));
    let (inputs, params) = (smallvec![Input::Port(array)], sized_params(prim, &given));
    let outputs = Types::from([Type::Scalar(scalar)]);
    let node = nodes::add_node(elab, prim, inputs, params, outputs, at.fragment, span);
    Some(PortRef { node, port: 0 })
}

/// Returns an array as one input of a net node. If some leaves (scalar parts) are placeholders for signals that are not
/// known yet, packing is deferred to the end, because the leaves may turn out to be the elements of an existing array.
fn array_input(
    elab: &mut Elaborator<'_>,
    wire: &[Signal],
    ty: Type,
    at: Position,
    span: Span,
) -> Input {
    let is_open = |signal: &Signal| matches!(signal, Signal::Port(p) if alias_of(*p).is_some());
    if wire.iter().any(is_open) {
        return Input::Port(deferred_arrays::defer_array(
            elab,
            wire.into(),
            ty,
            at,
            span,
        ));
    }
    resolved_array(elab, wire, ty, at, span)
}

/// Returns an array as one input of a net node. All its leaves (scalar parts) are known: they are an existing array
/// port, constants, or values that added nodes pack into an array.
pub(super) fn resolved_array(
    elab: &mut Elaborator<'_>,
    wire: &[Signal],
    ty: Type,
    at: Position,
    span: Span,
) -> Input {
    if let Some(port) = existing_array(elab, wire, ty) {
        return Input::Port(port);
    }
    if let Some(values) = constant_array(wire, ty) {
        return Input::constant(values);
    }
    match built_arrays::build_array(elab, wire, ty, at, span) {
        Some(port) => Input::Port(port),
        None => Input::Unconnected,
    }
}

/// Returns the port of type `ty` whose elements are exactly these leaves (scalar parts), in order; `None` if there is
/// none.
fn existing_array(elab: &Elaborator<'_>, wire: &[Signal], ty: Type) -> Option<PortRef> {
    let Some(Signal::Element(array, 0)) = wire.first() else {
        return None;
    };
    let in_order = (0..)
        .zip(wire.iter())
        .all(|(k, s)| *s == Signal::Element(*array, k));
    let outputs = &elab.net.node(array.node).outputs;
    let same = outputs.get(usize::from(array.port)) == Some(&ty);
    (in_order && same && wire.len() == elements_at(ty)).then_some(*array)
}

/// Returns a port with the value of a signal, for inputs that accept only ports. Adds a net node if the signal is not a
/// port; `None` if there is no primitive for its type.
pub(super) fn port_of(
    elab: &mut Elaborator<'_>,
    signal: &Signal,
    scalar: Scalar,
    at: Position,
    span: Span,
) -> Option<PortRef> {
    match signal {
        Signal::Const(value) => {
            let prim = member(PrimitiveFamily::Value, scalar)?;
            let node = nodes::add_node(
                elab,
                prim,
                Inputs::new(),
                vec![value.clone()],
                Types::from([Type::Scalar(scalar)]),
                at.fragment,
                span,
            );
            Some(PortRef { node, port: 0 })
        }
        other => match one_input(elab, other, scalar, at, span) {
            Input::Port(port) => Some(port),
            _ => None,
        },
    }
}

/// Returns the parameters, with their values, that select element `k` of an array or matrix of type `ty`.
pub(super) fn element_params(ty: Type, k: u32) -> Vec<(&'static str, u32)> {
    match ty {
        Type::Scalar(_) => Vec::new(),
        Type::Array(..) => vec![("Index", k)],
        Type::Matrix(_, cols) => vec![("Row", k / cols.max(1)), ("Col", k % cols.max(1))],
    }
}

/// Returns the type of a primitive's port that carries this number of leaves (scalar parts). A matrix gets one row.
pub(super) fn default_port_type(port: PortType, leaves: usize) -> Type {
    let n = u32::try_from(leaves).unwrap_or(u32::MAX);
    match port {
        PortType::Scalar(scalar) => Type::Scalar(scalar),
        PortType::Array(scalar) => Type::Array(scalar, n),
        PortType::Matrix => Type::Matrix(1, n),
    }
}

fn elements_at(ty: Type) -> usize {
    match ty {
        Type::Scalar(_) => 1,
        Type::Array(_, n) => n as usize,
        Type::Matrix(rows, cols) => rows as usize * cols as usize,
    }
}

/// Returns the values of a primitive's parameters in their order: those in `given` by name, defaults for the others.
pub(super) fn sized_params(prim: PrimId, given: &[(&str, u32)]) -> Vec<Value> {
    let value = |param: &rpi_image::Param| {
        let given = given.iter().find(|(name, _)| *name == param.name);
        given
            .map(|(_, v)| Value::int((*v).into()))
            .or_else(|| crate::ty::machine_types::param_default(param))
    };
    prim.desc().params.iter().filter_map(value).collect()
}

/// Returns the array of type `ty` with these leaves (scalar parts) if all are constant.
pub(super) fn constant_array(wire: &[Signal], ty: Type) -> Option<Value> {
    let values: Option<Vec<Value>> = wire.iter().map(constant).collect();
    let cells = values?
        .iter()
        .flat_map(|leaf| leaf.slots())
        .copied()
        .collect();
    Some(Value::Slots { ty, cells })
}

fn constant(signal: &Signal) -> Option<Value> {
    match signal {
        Signal::Const(value) => Some(value.clone()),
        _ => None,
    }
}
