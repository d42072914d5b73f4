//! Elaborates operators that do not always need their right operand: `and`, `or` and `=>` unless the left operand
//! decides, `??` if the left operand is absent. Operations in the right operand that can fault are guarded by that
//! condition.

use crate::elab::elementwise;
use crate::elab::elementwise::reads_flows;
use crate::elab::expr;
use crate::elab::expr::leaf_scalars;
use crate::elab::guards;
use crate::elab::nodes;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::sampled_flows;
use crate::elab::sampled_flows::LeafPositions;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire, single_wire};
use crate::elab::{ElabMode, Elaborator, Position};
use crate::typed::ExprId;
use crate::typed::{PrimCall, TypedKind};
use rpi_diag::Span;
use rpi_image::{Scalar, Value};
use rpi_net::prim;
use rpi_prims::PrimId;
use std::ops::Range;

/// Boolean operators whose result the left operand can decide without the right one.
#[derive(Clone, Copy, PartialEq, Eq)]
enum ShortCircuitOp {
    And,
    Or,
    Implies,
}

impl ShortCircuitOp {
    fn from_prim(prim: PrimId) -> Option<ShortCircuitOp> {
        [
            (prim!("Core::BooleanAnd"), ShortCircuitOp::And),
            (prim!("Core::BooleanOr"), ShortCircuitOp::Or),
            (prim!("Rpi::BooleanImplies"), ShortCircuitOp::Implies),
        ]
        .into_iter()
        .find_map(|(one, logic)| (one == prim).then_some(logic))
    }

    /// Returns the value of the left operand with which it decides the result: `true` for `or`, `false` for `and` and
    /// `=>`.
    fn deciding_value(self) -> bool {
        self == ShortCircuitOp::Or
    }

    /// Returns the result if the left operand decides it: `false` for `and`, `true` for `or` and `=>`.
    fn const_condition(self) -> bool {
        self != ShortCircuitOp::And
    }
}

/// Operand that is not needed in every cycle and contains state. The state runs in all cycles nevertheless.
#[derive(Clone, Debug)]
pub struct LazyOperand {
    /// Span of the operand.
    pub span: Span,
    /// Range of the indices of the net nodes that compute the operand.
    pub nodes: Range<u32>,
}

/// Elaborates an operand that is not needed in every cycle, by calling `wire`, and returns its signals. The operand is
/// recorded if it contains state.
pub(super) fn lazy_operand<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: ExprId,
    wire: impl FnOnce(&mut Elaborator<'u>, &mut Scope<'u>) -> Wire,
) -> Wire {
    if elab.mode != ElabMode::Net || !guards::contains_state(elab, scope, id) {
        return wire(elab, scope);
    }
    let number = |elab: &Elaborator| u32::try_from(elab.net.nodes.len()).unwrap_or(u32::MAX);
    let before = number(elab);
    let wire = wire(elab, scope);
    let nodes = before..number(elab);
    let span = scope.unit.expr(id).span;
    elab.lazy_operands.push(LazyOperand { span, nodes });
    wire
}

/// Elaborates `x and y`, `x or y` or `x => y` if `y` can fault or has state, so that `y` runs only if `x` does not
/// decide the result. `None` for all other primitives and operands.
pub(super) fn short_circuit<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: &'u PrimCall,
    id: ExprId,
    at: Position,
) -> Option<Wire> {
    let span = scope.unit.expr(id).span;
    let logic = ShortCircuitOp::from_prim(call.prim)?;
    let &[Some(left), Some(right)] = &call.inputs[..] else {
        return None;
    };
    if elab.mode != ElabMode::Constant
        && !guards::elab_can_fault(elab, scope, right)
        && !guards::contains_state(elab, scope, right)
    {
        return None;
    }
    let first = expr::elab_operand(elab, scope, [id, left], at);
    if first == Signal::Const(Value::bool(logic.deciding_value()))
        && can_drop_operand(elab, scope, right)
    {
        return Some(single_wire(Signal::Const(Value::bool(
            logic.const_condition(),
        ))));
    }
    let there = match elab.mode != ElabMode::Constant && guards::elab_can_fault(elab, scope, right)
    {
        true => {
            let needed = undecided_condition(elab, logic, &first, at, span);
            elementwise::with_guard(elab, needed, at, span)
        }
        false => at,
    };
    let second = lazy_operand(elab, scope, right, |elab, scope| {
        sampled_flows::operand_wire(elab, scope, [id, right], there)
    });
    let second = second.first().cloned().unwrap_or(Signal::Absent);
    Some(single_wire(nodes::add_simple(
        elab,
        call.prim,
        &[first, second],
        at,
        span,
    )))
}

/// Returns whether an operand that is never needed, because a constant left operand decides the result, can be left out
/// of the net.
fn can_drop_operand<'u>(elab: &mut Elaborator<'u>, scope: &Scope<'u>, operand: ExprId) -> bool {
    elab.mode == ElabMode::Constant
        || !guards::contains_state(elab, scope, operand)
            && expr::drops_dead_code(elab, reads_flows(scope.unit, operand))
}

/// Returns the signal that is true if the left operand `left` does not decide the result. An absent operand does not
/// decide it.
fn undecided_condition(
    elab: &mut Elaborator<'_>,
    logic: ShortCircuitOp,
    left: &Signal,
    at: Position,
    span: Span,
) -> Signal {
    let deciding = logic.deciding_value();
    let left = match left {
        Signal::Const(_) => left.clone(),
        Signal::Absent => Signal::Const(Value::bool(!deciding)),
        _ => {
            let otherwise = Signal::Const(Value::bool(!deciding));
            let inputs = [left.clone(), otherwise];
            nodes::add_family_member(
                elab,
                PrimitiveFamily::Coalesce,
                Scalar::Bool,
                &inputs,
                at,
                span,
            )
        }
    };
    match deciding {
        true => nodes::add_simple(elab, prim!("Core::BooleanNot"), &[left], at, span),
        false => left,
    }
}

/// Elaborates `x ?? y`, the value of `x` where it is present, else that of `y`.
pub(super) fn coalesce_operands<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    [id, a, b]: [ExprId; 3],
    at: Position,
) -> Wire {
    let unit = scope.unit;
    let (scalars, span) = (leaf_scalars(&unit.expr(id).ty), unit.expr(id).span);
    let first = sampled_flows::read_leaves(elab, scope, [id, a], scalars.len(), at);
    let places = sampled_flows::leaf_places(elab, scope, id, at);
    let is_of_one_clock =
        matches!(places, LeafPositions::Uniform(_)) && elab.mode != ElabMode::Constant;
    let second = match is_of_one_clock && guards::elab_can_fault(elab, scope, b) {
        true => {
            let absent = first.iter().zip(&scalars).enumerate();
            let absent: Vec<Signal> = absent
                .map(|(k, (leaf, scalar))| is_absent(elab, leaf, *scalar, places.at(k), span))
                .collect();
            where_absent(elab, scope, [id, b], &absent, at)
        }
        false => lazy_operand(elab, scope, b, |elab, scope| {
            sampled_flows::read_leaves(elab, scope, [id, b], scalars.len(), at)
        }),
    };
    let leaves = first.iter().zip(second.iter()).zip(scalars).enumerate();
    leaves
        .map(|(k, ((a, b), scalar))| {
            coalesce_leaf(elab, a.clone(), b.clone(), scalar, places.at(k), span)
        })
        .collect()
}

/// Elaborates the right operand of `??`, or a part of it. `absent` is, for each leaf (scalar part), the condition that
/// the left operand is absent. Operations that can fault run only where their value is needed; for a struct or array
/// written in place, this is decided for each part.
fn where_absent<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    [reader, id]: [ExprId; 2],
    absent: &[Signal],
    at: Position,
) -> Wire {
    let unit = scope.unit;
    let expr = unit.expr(id);
    let is_one = absent.iter().all(|leaf| *leaf == absent[0]);
    if let TypedKind::Build(parts) = &expr.kind
        && !is_one
        && sampled_flows::clocked_facts(elab, scope).is_none()
    {
        let mut rest = absent;
        let mut leaves = Vec::with_capacity(absent.len());
        for part in parts {
            let count = unit.expr(*part).ty.leaf_count().min(rest.len());
            let (own, others) = rest.split_at(count);
            let wire = where_absent(elab, scope, [reader, *part], own, at);
            leaves.extend_from_slice(&wire);
            rest = others;
        }
        return leaves.into();
    }
    let needed = any_of(elab, absent, at, expr.span);
    let there = match needed == Signal::Const(Value::bool(true)) {
        true => at,
        false => elementwise::with_guard(elab, needed, at, expr.span),
    };
    lazy_operand(elab, scope, id, |elab, scope| {
        sampled_flows::read_leaves(elab, scope, [reader, id], absent.len(), there)
    })
}

/// Returns the disjunction of these conditions, none of which is ever absent.
fn any_of(elab: &mut Elaborator<'_>, conditions: &[Signal], at: Position, span: Span) -> Signal {
    let mut any = Signal::Const(Value::bool(false));
    for (k, condition) in conditions.iter().enumerate() {
        any = match (&any, condition) {
            (Signal::Const(known), one) if known.as_bool() == Some(false) => one.clone(),
            (Signal::Const(_), _) => any,
            (_, Signal::Const(known)) if known.as_bool() == Some(false) => any,
            _ if k > 0 && conditions[k - 1] == *condition => any,
            _ => nodes::add_simple(
                elab,
                prim!("Core::BooleanOr"),
                &[any, condition.clone()],
                at,
                span,
            ),
        };
    }
    any
}

fn is_absent(
    elab: &mut Elaborator<'_>,
    leaf: &Signal,
    scalar: Scalar,
    at: Position,
    span: Span,
) -> Signal {
    match leaf {
        Signal::Const(_) => Signal::Const(Value::bool(false)),
        Signal::Absent => Signal::Const(Value::bool(true)),
        _ => nodes::add_family_member(
            elab,
            PrimitiveFamily::IsNull,
            scalar,
            std::slice::from_ref(leaf),
            at,
            span,
        ),
    }
}
/// Elaborates one leaf (scalar part) of `x ?? y`. `first` and `second` are the signals of the leaf in `x` and `y`.
fn coalesce_leaf(
    elab: &mut Elaborator<'_>,
    first: Signal,
    second: Signal,
    scalar: Scalar,
    at: Position,
    span: Span,
) -> Signal {
    match (&first, &second) {
        (Signal::Const(_), Signal::Port(_)) if expr::drops_dead_code(elab, true) => first,
        (Signal::Const(_), Signal::Const(_)) | (_, Signal::Absent) => first,
        (Signal::Absent, _) => second,
        _ => nodes::add_family_member(
            elab,
            PrimitiveFamily::Coalesce,
            scalar,
            &[first, second],
            at,
            span,
        ),
    }
}
