//! Elaborates expressions, one method per kind.

use crate::clocks::ClockId;
use crate::elab::call;
use crate::elab::device;
use crate::elab::elementwise;
use crate::elab::external_ports;
use crate::elab::fragment_outputs;
use crate::elab::guards;
use crate::elab::node_budget;
use crate::elab::nodes;
use crate::elab::outside_flows;
use crate::elab::presence;
use crate::elab::prim_calls;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::sampled_flows;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire, empty_wire};
use crate::elab::subrange;
use crate::elab::time;
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::typed::ExprId;
use crate::typed::{Activation, TypedKind};
use rpi_diag::{Diagnostic, Span};
use rpi_image::{Scalar, Value};
use rpi_net::prim;
use smallvec::SmallVec;

/// Maximum depth of nested first operands that are elaborated by recursion from the outside in.
const MAX_RECURSIVE_CALLS: usize = 30;

/// Returns the first argument of a call, or the value of which an expression is a part; `None` for other expressions.
fn first_operand(scope: &Scope<'_>, id: ExprId) -> Option<ExprId> {
    match &scope.unit.expr(id).kind {
        TypedKind::Call(call) if matches!(call.activation, Activation::Always) => {
            call.args.first().copied().flatten()
        }
        TypedKind::Prim(call) => call.inputs.first().copied().flatten(),
        TypedKind::Part { base, .. } => Some(*base),
        _ => None,
    }
}

/// Returns the signals of an expression, one for each leaf (scalar part). The expression is elaborated on first use.
pub(super) fn elab_expr<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: ExprId,
    at: Position,
) -> Wire {
    if let Some(wire) = scope.cached(id, at.guard) {
        return wire;
    }
    if elab.budget.is_exhausted {
        return empty_wire();
    }
    let at = sampled_flows::position_of(elab, scope, id, at);
    innermost_first(elab, scope, id, at);
    let wire = elaborate_expr(elab, scope, id, at);
    node_budget::charge_leaves(elab, wire.len(), scope.unit.expr(id).span);
    let guard = at.guard.filter(|_| guards::elab_can_fault(elab, scope, id));
    scope.cache(id, &wire, guard);
    wire
}

/// Elaborates deeply nested first operands from the inside out, because each level of recursion needs stack. An array
/// iterator such as `red` is a nest of one call per element.
fn innermost_first<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>, id: ExprId, at: Position) {
    let mut chain = Vec::new();
    let mut next = first_operand(scope, id);
    while let Some(inner) = next.filter(|inner| !scope.check_known_at_load(*inner)) {
        chain.push(inner);
        next = first_operand(scope, inner);
    }
    if chain.len() > MAX_RECURSIVE_CALLS {
        for inner in chain.into_iter().rev() {
            elab_expr(elab, scope, inner, at);
        }
    }
}

/// Reports an internal error: an invalid expression for which no diagnostic was reported. Returns a value without
/// signals.
fn unreported_error(elab: &mut Elaborator<'_>, span: Span) -> Wire {
    if elab.mode == ElabMode::Constant {
        return elab.fail(NotConstantError::Reported);
    }
    let message = "internal error: an invalid expression was not reported";
    call::report_failure(elab, Diagnostic::internal_error(message, span), span)
}

fn elaborate_expr<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: ExprId,
    at: Position,
) -> Wire {
    let unit = scope.unit;
    let expr = unit.expr(id);
    let span = expr.span;
    match &expr.kind {
        TypedKind::Error => unreported_error(elab, span),
        TypedKind::Const(leaves) => time::constants(elab, leaves, &expr.ty, at, span),
        TypedKind::Literal(leaf) => {
            time::constants(elab, std::slice::from_ref(leaf), &expr.ty, at, span)
        }
        TypedKind::None => (0..expr.ty.leaf_count().max(1))
            .map(|_| Signal::Absent)
            .collect(),
        TypedKind::Arbitrary => external_ports::open_value(elab, scope, id, at),
        TypedKind::Flow(flow) => {
            let facts = sampled_flows::facts_of(elab, scope);
            let outside = facts.is_some_and(|facts| facts.clocks.reads_inactive_block(id));
            fragment_outputs::read_flow(elab, scope, (*flow, outside), at, span)
        }
        TypedKind::Sensor { device, port } => device::sensor(elab, scope, *device, *port, at, span),
        TypedKind::Part { base, at: offset } => {
            let wire = elab_expr(elab, scope, *base, at);
            sub_wire(&wire, *offset as usize, expr.ty.leaf_count())
        }
        TypedKind::Slice { base, from, step } => slice(elab, scope, *base, *from, *step, id, at),
        TypedKind::Select { base, index } => select(elab, scope, *base, *index, id, at),
        TypedKind::Build(parts) => build(elab, scope, parts, &expr.ty, at),
        TypedKind::Repeat(element) => {
            let wire = elab_expr(elab, scope, *element, at);
            let count = expr.ty.leaf_count();
            wire.iter().cloned().cycle().take(count).collect()
        }
        TypedKind::Replace {
            base,
            at: offset,
            value,
        } => replace(elab, scope, (id, *base, *value), *offset, at),
        TypedKind::Each(each, operands) => {
            elementwise::elementwise(elab, scope, *each, operands, id, at)
        }
        TypedKind::Equal { operands, negated } => {
            presence::equality(elab, scope, id, *operands, *negated, at)
        }
        TypedKind::Present(operand) => presence::present(elab, scope, [id, *operand], at, span),
        TypedKind::Prim(call) => prim_calls::prim_call(elab, scope, call, id, at),
        TypedKind::Call(call) => call::elab_call(elab, scope, call, id, at),
        TypedKind::When { value, .. } => {
            outside_flows::sampled_value(elab, scope, [id, *value], at)
        }
        TypedKind::Merge { on, cases } => {
            sampled_flows::merge_expr(elab, scope, *on, cases, id, at)
        }
        TypedKind::Current(operand) => sampled_flows::elab_current(elab, scope, [id, *operand], at),
    }
}

/// Returns the signals of `base` with its leaves (scalar parts) from `offset` on replaced by those of `value`. `id` is
/// the whole expression.
fn replace<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    (id, base, value): (ExprId, ExprId, ExprId),
    offset: u32,
    at: Position,
) -> Wire {
    let mut wire = elab_expr(elab, scope, base, at).to_vec();
    let leaves = elab_expr(elab, scope, value, at);
    for (slot, signal) in wire.iter_mut().skip(offset as usize).zip(leaves.iter()) {
        *slot = signal.clone();
    }
    subrange::check_replaced(elab, scope, wire.into(), [id, value], offset, at)
}

/// Returns the signals of a struct, array or tuple that is built from its parts, checked against the subranges of
/// struct fields.
fn build<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    parts: &[ExprId],
    ty: &crate::ty::Ty,
    at: Position,
) -> Wire {
    let mut signals = Vec::with_capacity(parts.len());
    for (k, part) in parts.iter().enumerate() {
        let wire = elab_expr(elab, scope, *part, at);
        let place = scope.unit.expr(*part).span;
        let wire = subrange::check_field(elab, wire, (ty, k), at, place);
        signals.extend_from_slice(&wire);
    }
    signals.into()
}

/// Returns the signal of a Boolean expression, such as the condition of a block, with a value in all cycles of the
/// block.
pub(super) fn elab_condition<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: ExprId,
    at: Position,
) -> Signal {
    let wire = sampled_flows::read_at(elab, scope, id, ClockId::BASE, at);
    wire.first().cloned().unwrap_or(Signal::Absent)
}

/// Returns the signal of an operand with one leaf (scalar part). `pair` is the operator and the operand.
pub(super) fn elab_operand<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    pair: [ExprId; 2],
    at: Position,
) -> Signal {
    let wire = sampled_flows::operand_wire(elab, scope, pair, at);
    wire.first().cloned().unwrap_or(Signal::Absent)
}

fn slice<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    base: ExprId,
    from: u32,
    step: i32,
    id: ExprId,
    at: Position,
) -> Wire {
    let wire = elab_expr(elab, scope, base, at);
    let total = scope.unit.expr(id).ty.leaf_count();
    let crate::ty::Ty::Array(element, _) = &scope.unit.expr(base).ty else {
        return empty_wire();
    };
    let size = element.leaf_count().max(1);
    let mut leaves = Vec::with_capacity(total);
    let mut k = i64::from(from);
    while leaves.len() < total {
        let at = usize::try_from(k)
            .unwrap_or(usize::MAX)
            .saturating_mul(size);
        let Some(element) = wire.get(at..at.saturating_add(size)) else {
            break;
        };
        leaves.extend_from_slice(element);
        k += i64::from(step);
    }
    leaves.into()
}

/// Elaborates an array element at an index that is computed at run time, as a chain of conditionals with a check of the
/// index.
fn select<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    base: ExprId,
    index: ExprId,
    id: ExprId,
    at: Position,
) -> Wire {
    let span = scope.unit.expr(id).span;
    let wire = sampled_flows::operand_wire(elab, scope, [id, base], at);
    let index = elab_operand(elab, scope, [id, index], at);
    let scalars = leaf_scalars(&scope.unit.expr(id).ty);
    let size = scalars.len().max(1);
    let count = wire.len() / size;
    check_index(elab, &index, count, at, span);
    let mut chosen = wire.get(..size).unwrap_or_default().to_vec();
    for k in 1..count {
        let place = Signal::Const(Value::int(k as i64));
        let here = nodes::add_simple(
            elab,
            prim!("Core::IntEquals"),
            &[index.clone(), place],
            at,
            span,
        );
        for (leaf, scalar) in chosen
            .iter_mut()
            .zip(&scalars)
            .enumerate()
            .map(|(n, (c, s))| ((n, c), s))
        {
            let (n, slot) = leaf;
            let inputs = [here.clone(), wire[k * size + n].clone(), slot.clone()];
            *slot = nodes::add_family_member(
                elab,
                PrimitiveFamily::Conditional,
                *scalar,
                &inputs,
                at,
                span,
            );
        }
    }
    chosen.into()
}

fn check_index(elab: &mut Elaborator<'_>, index: &Signal, count: usize, at: Position, span: Span) {
    if let Signal::Const(value) = index
        && let Some(k) = value.as_int()
        && !(0..count as i64).contains(&k)
        && at.guard.is_none()
    {
        let text = format!(
            "index {k} is out of bounds: the array has {}, counted from 0",
            rpi_diag::with_noun(count, "element")
        );
        return nodes::report_certain_fault(elab, text, span);
    }
    let [first, last, length] =
        [0, count as i64 - 1, count as i64].map(|k| Signal::Const(Value::int(k)));
    let mut at_least = |operands: [Signal; 2]| {
        let prim = prim!("Rpi::IntGreaterOrEqual");
        nodes::add_simple(elab, prim, &operands, at, span)
    };
    let from = at_least([index.clone(), first]);
    let to = at_least([last, index.clone()]);
    let inside = nodes::add_simple(elab, prim!("Core::BooleanAnd"), &[from, to], at, span);
    presence::assert_index(elab, &inside, [index.clone(), length], at, span);
}

/// Returns whether code that a constant makes unreachable is left out of the net. `reads` is whether that code reads
/// flows; this is recorded, because a dependency cycle may lead through that code.
pub(super) fn drops_dead_code(elab: &mut Elaborator<'_>, reads: bool) -> bool {
    elab.leaves_out_code |= reads;
    !reads || matches!(elab.mode, ElabMode::Net | ElabMode::Constant)
}

/// Returns the signals of `count` leaves (scalar parts) of a value from leaf `at` on; none if the value has too few
/// leaves.
pub(super) fn sub_wire(wire: &Wire, at: usize, count: usize) -> Wire {
    match wire.get(at..at.saturating_add(count)) {
        Some(leaves) if leaves.len() == wire.len() => wire.clone(),
        Some(leaves) => leaves.into(),
        None => empty_wire(),
    }
}

/// Machine types of the leaves (scalar parts) of a type.
pub(super) type Scalars = SmallVec<[Scalar; 4]>;

/// Returns the machine type of each leaf (scalar part) of a type, in order.
pub(super) fn leaf_scalars(ty: &crate::ty::Ty) -> Scalars {
    let mut scalars = Scalars::new();
    ty.for_each_leaf(&mut |_, leaf| scalars.push(leaf.scalar().unwrap_or(Scalar::Bool)));
    scalars
}
