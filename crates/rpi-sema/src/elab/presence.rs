//! Presence tests and conditions on presence.

use crate::elab::expr;
use crate::elab::nodes;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::sampled_flows;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire, single_wire};
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::typed::ExprId;
use crate::typed::{PrimCall, TypedKind};
use rpi_diag::Span;
use rpi_image::Value;
use rpi_net::prim;
use rpi_prims::PrimId;

/// Returns the condition in the form `guard => condition`, where the guard is that of `at`: it is true in cycles in
/// which the branch of the `if` around `at` is not taken.
pub(super) fn imply_guard(
    elab: &mut Elaborator<'_>,
    condition: &Signal,
    at: Position,
    span: Span,
) -> Signal {
    match at.guard {
        Some(guard) => nodes::add_simple(
            elab,
            prim!("Rpi::BooleanImplies"),
            &[Signal::Port(guard), condition.clone()],
            at,
            span,
        ),
        None => condition.clone(),
    }
}

/// Adds a check to the net: in a cycle in which the condition is false, the primitive `check` ends the command with a
/// fault.
pub(super) fn assert(
    elab: &mut Elaborator<'_>,
    check: PrimId,
    condition: &Signal,
    at: Position,
    span: Span,
) {
    if *condition == Signal::Const(Value::bool(true)) {
        return;
    }
    let condition = imply_guard(elab, condition, at, span);
    add_check(elab, check, &[condition], at, span);
}

/// Adds a check of an array index to the net. `inside` is whether the index is within the array, and `values` are the
/// index and the number of elements, for the message of the fault.
pub(super) fn assert_index(
    elab: &mut Elaborator<'_>,
    inside: &Signal,
    values: [Signal; 2],
    at: Position,
    span: Span,
) {
    if *inside == Signal::Const(Value::bool(true)) {
        return;
    }
    let inside = imply_guard(elab, inside, at, span);
    let [index, length] = values;
    let check = prim!("Rpi::AssertIndex");
    add_check(elab, check, &[inside, index, length], at, span);
}

fn add_check(
    elab: &mut Elaborator<'_>,
    check: PrimId,
    inputs: &[Signal],
    at: Position,
    span: Span,
) {
    if elab.mode != ElabMode::Constant {
        nodes::add_simple(elab, check, inputs, at, span);
    } else {
        elab.fail(NotConstantError::Fault(
            span,
            "the index is out of bounds".to_owned(),
        ));
    }
}

/// Elaborates `x = y` (or `x <> y` if `negated`), which compares all leaves (scalar parts) of two values.
pub(super) fn equality<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: ExprId,
    operands: [ExprId; 2],
    negated: bool,
    at: Position,
) -> Wire {
    let span = scope.unit.expr(id).span;
    let scalars = expr::leaf_scalars(&scope.unit.expr(operands[0]).ty);
    let [a, b] =
        operands.map(|operand| sampled_flows::operand_wire(elab, scope, [id, operand], at));
    let mut all: Option<Signal> = None;
    for ((a, b), scalar) in a.iter().zip(b.iter()).zip(scalars) {
        let same = nodes::add_family_member(
            elab,
            PrimitiveFamily::Equals,
            scalar,
            &[a.clone(), b.clone()],
            at,
            span,
        );
        all = Some(match all {
            None => same,
            Some(all) => nodes::add_simple(elab, prim!("Core::BooleanAnd"), &[all, same], at, span),
        });
    }
    let all = all.unwrap_or(Signal::Const(Value::bool(true)));
    single_wire(match negated {
        true => nodes::add_simple(elab, prim!("Core::BooleanNot"), &[all], at, span),
        false => all,
    })
}

/// Elaborates `present(x)`, which is true if all leaves (scalar parts) of `x` are present.
pub(super) fn present<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    [id, operand]: [ExprId; 2],
    at: Position,
    span: Span,
) -> Wire {
    let scalars = expr::leaf_scalars(&scope.unit.expr(operand).ty);
    let wire = sampled_flows::operand_wire(elab, scope, [id, operand], at);
    let mut all = Signal::Const(Value::bool(true));
    for (signal, scalar) in wire.iter().zip(scalars) {
        let there = match signal {
            Signal::Const(_) => Signal::Const(Value::bool(true)),
            Signal::Absent => Signal::Const(Value::bool(false)),
            other => {
                let absent = nodes::add_family_member(
                    elab,
                    PrimitiveFamily::IsNull,
                    scalar,
                    std::slice::from_ref(other),
                    at,
                    span,
                );
                nodes::add_simple(elab, prim!("Core::BooleanNot"), &[absent], at, span)
            }
        };
        all = conjunction(elab, &all, &there, at, span);
    }
    single_wire(all)
}

/// Returns the conjunction of two conditions. No net node is added if one of them is the constant `true`, or `false` so
/// that the other is not needed.
pub(super) fn conjunction(
    elab: &mut Elaborator<'_>,
    a: &Signal,
    b: &Signal,
    at: Position,
    span: Span,
) -> Signal {
    let known = |signal: &Signal| match signal {
        Signal::Const(value) => value.as_bool(),
        _ => None,
    };
    match (known(a), known(b)) {
        (Some(true), _) => b.clone(),
        (_, Some(true)) => a.clone(),
        (Some(false), other) | (other, Some(false))
            if expr::drops_dead_code(elab, other.is_none()) =>
        {
            Signal::Const(Value::bool(false))
        }
        _ => nodes::add_simple(
            elab,
            prim!("Core::BooleanAnd"),
            &[a.clone(), b.clone()],
            at,
            span,
        ),
    }
}

/// Elaborates `not present(x)` by one primitive if `x` has a single leaf (scalar part); `None` for other calls.
pub(super) fn not_present<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: &'u PrimCall,
    id: ExprId,
    at: Position,
) -> Option<Wire> {
    let span = scope.unit.expr(id).span;
    let operand = call.inputs.first().copied().flatten()?;
    let TypedKind::Present(tested) = scope.unit.expr(operand).kind else {
        return None;
    };
    let [scalar] = expr::leaf_scalars(&scope.unit.expr(tested).ty)[..] else {
        return None;
    };
    if call.prim != prim!("Core::BooleanNot") {
        return None;
    }
    let wire = sampled_flows::operand_wire(elab, scope, [operand, tested], at);
    let is_flow = matches!(wire.first()?, Signal::Port(_) | Signal::Element(..));
    is_flow.then(|| {
        single_wire(nodes::add_family_member(
            elab,
            PrimitiveFamily::IsNull,
            scalar,
            &wire,
            at,
            span,
        ))
    })
}
