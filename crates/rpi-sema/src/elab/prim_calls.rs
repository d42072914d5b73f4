//! Calls of primitives: arguments, parameters and results.

use crate::elab::arrays::default_port_type;
use crate::elab::elementwise;
use crate::elab::expr;
use crate::elab::identities;
use crate::elab::nodes;
use crate::elab::presence;
use crate::elab::sampled_flows;
use crate::elab::scope::Scope;
use crate::elab::short_circuit;
use crate::elab::signal::{PrimInputs, Signal, Wire, empty_wire, single_wire};
use crate::elab::time;
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::typed::ExprId;
use crate::typed::PrimCall;
use rpi_diag::Span;
use rpi_image::{ParamType, PortType, Role, Scalar, Type, Value};

pub(super) fn prim_call<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: &'u PrimCall,
    id: ExprId,
    at: Position,
) -> Wire {
    let span = scope.unit.expr(id).span;
    if elab.mode == ElabMode::Constant
        && let Some(wire) = time::constant_duration(elab, scope, call, at, span)
    {
        return wire;
    }
    if let Some(test) = presence::not_present(elab, scope, call, id, at) {
        return test;
    }
    if let Some(decided) = short_circuit::short_circuit(elab, scope, call, id, at) {
        return decided;
    }
    let desc = call.prim.desc();
    let is_of_cycle = matches!(desc.role, Role::Flow(_) | Role::First)
        && desc.inputs.is_empty()
        && desc.params.is_empty();
    let key = (at.fragment, call.prim);
    if let Some(known) = elab.cache.cycle_inputs.get(&key).filter(|_| is_of_cycle) {
        return known.clone();
    }
    let at = match crate::elab::guards::has_state(call) {
        true => at.unguarded(),
        false => at,
    };
    let mut inputs = PrimInputs::new();
    for (port, input) in call.prim.desc().inputs.iter().zip(&call.inputs) {
        inputs.push(input.map(|input| primitive_argument(elab, scope, [id, input], port.ty, at)));
    }
    if let Some(operand) = identities::equal_operand(call.prim, &inputs) {
        return operand;
    }
    let Some(params) = primitive_params(elab, scope, call, at, span) else {
        return empty_wire();
    };
    let wire = match at
        .guard
        .and_then(|guard| crate::elab::guards::guarded_variant(call.prim).map(|twin| (guard, twin)))
    {
        Some((guard, twin)) => {
            let guard = single_wire(Signal::Port(guard));
            inputs.insert(0, Some((Type::Scalar(Scalar::Bool), guard)));
            nodes::add_prim_typed(elab, twin, inputs, params, at, span)
        }
        None => nodes::add_prim_typed(elab, call.prim, inputs, params, at, span),
    };
    if is_of_cycle && elab.mode != ElabMode::Constant {
        elab.cache.cycle_inputs.insert(key, wire.clone());
    }
    wire
}

/// Returns the machine type and the signals of an argument for a primitive's port. `pair` is the call and the argument.
fn primitive_argument<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    pair: [ExprId; 2],
    port: PortType,
    at: Position,
) -> (Type, Wire) {
    let wire = sampled_flows::operand_wire(elab, scope, pair, at);
    let known = crate::ty::machine_types::machine_type(&scope.unit.expr(pair[1]).ty);
    let is_array = !matches!(port, PortType::Scalar(_));
    let ty = known.filter(|_| is_array);
    (
        ty.unwrap_or_else(|| default_port_type(port, wire.len())),
        wire,
    )
}

/// Returns the value of a primitive's parameter that consists of these leaves (scalar parts); `None` if there are none.
fn param_value(ty: ParamType, leaves: &[Value]) -> Option<Value> {
    match ty {
        ParamType::Array(scalar) => Some(crate::ty::machine_types::pack_leaves(scalar, leaves)),
        _ => leaves.first().cloned(),
    }
}

/// Returns the values of a primitive's parameters, which must be constant. `None`, with the failure recorded, if one is
/// not.
fn primitive_params<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: &'u PrimCall,
    at: Position,
    span: Span,
) -> Option<Vec<Value>> {
    let desc = call.prim.desc();
    let mut params = Vec::with_capacity(desc.params.len());
    for (param, given) in desc.params.iter().zip(&call.params) {
        let Some(id) = given else {
            params.extend(crate::ty::machine_types::param_default(param));
            continue;
        };
        let wire = expr::elab_expr(elab, scope, *id, at);
        let values: Option<Vec<Value>> = wire
            .iter()
            .map(|signal| elementwise::constant_value(elab, signal))
            .collect();
        match values.and_then(|leaves| param_value(param.ty, &leaves)) {
            Some(value) => params.push(value),
            None => {
                elab.fail(NotConstantError::RunTime(span));
                return None;
            }
        }
    }
    Some(params)
}
