//! Exact time. Values of the type `time` count ticks. They become seconds where a real is expected; a duration in
//! seconds that is fixed at load time becomes whole ticks, rounded up, where a time is expected.
//!
//! Such a conversion is often known only when the other operand is checked. Therefore an expression that may need one
//! is added together with a part that covers all of it, and that part is turned into the conversion. The indices of
//! checked expressions do not change.

use crate::check::Checker;
use crate::check::bodies::body::Body;
use crate::check::calls::prim;
use crate::check::signatures::constraint::parse_constraint;
use crate::check::signatures::header::Header;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::program::{DeclId, DeclKind};
use crate::ty::Ty;
use crate::ty::machine_types::SECONDS;
use crate::typed::{ElementwiseOp, PrimCall, TypedKind};
use crate::typed::{ExprId, FlowRole, Unit, UnitKind};
use crate::units::Dimension;
use rpi_diag::Span;
use rpi_image::{Role, StateSize};
use rpi_net::prim;
use rpi_prims::PrimId;
use rpi_syntax::Name;
use rpi_syntax::ops::BinaryOp;

use BinaryOp::{Add, Div, Ge, Gt, IntDiv, Le, Lt, Mod, Mul, Pow, Sub};

/// Maximum number of alternatives, such as branches of `if`, of an expression in seconds that may be converted to
/// ticks.
const MAX_ALTERNATIVES: usize = 1000;

/// Operator on exact times (whole ticks): its primitive, whether the primitive takes the right operand first, and the
/// type of its result.
struct TimeOp {
    op: BinaryOp,
    prim: PrimId,
    swapped: bool,
    gives: Ty,
}

const fn time_op(op: BinaryOp, prim: PrimId, swapped: bool, gives: Ty) -> TimeOp {
    TimeOp {
        op,
        prim,
        swapped,
        gives,
    }
}

/// Operators on two exact times, and on an exact time and an integer.
#[rustfmt::skip]
const TIME_OPS: &[TimeOp] = &[
    time_op(Add,    prim!("Core::IntAdd"),           false, Ty::Duration),
    time_op(Sub,    prim!("Rpi::IntSubtract"),       false, Ty::Duration),
    time_op(Mul,    prim!("Core::IntMultiply"),      false, Ty::Duration),
    time_op(Mod,    prim!("Rpi::IntModulo"),         false, Ty::Duration),
    time_op(IntDiv, prim!("Core::IntDivide"),        false, Ty::Int),
    time_op(Lt,     prim!("Core::IntGreater"),       true,  Ty::Bool),
    time_op(Gt,     prim!("Core::IntGreater"),       false, Ty::Bool),
    time_op(Le,     prim!("Rpi::IntGreaterOrEqual"), true,  Ty::Bool),
    time_op(Ge,     prim!("Rpi::IntGreaterOrEqual"), false, Ty::Bool),
];

/// Whether a new expression is wrapped in a part expression. The wrapper can later become a conversion between ticks
/// and seconds.
pub(crate) fn may_be_converted(unit: &Unit, kind: &TypedKind, ty: &Ty) -> bool {
    match ty {
        Ty::Duration => !matches!(kind, TypedKind::Error),
        Ty::Real(Dimension::TIME) => is_load_time_constant(unit, kind),
        _ => false,
    }
}

/// Whether a value is the same in all cycles. Only the expression and its direct operands are examined.
pub(crate) fn is_load_time_constant(unit: &Unit, kind: &TypedKind) -> bool {
    match kind {
        TypedKind::Flow(flow) => unit.flow(*flow).role == FlowRole::Param,
        TypedKind::Prim(call) => {
            let desc = call.prim.desc();
            let is_pure = desc.role == Role::Compute && matches!(desc.state, StateSize::None);
            let mut inputs = call.inputs.iter().flatten();
            is_pure && inputs.all(|input| is_fixed_operand(unit, *input))
        }
        _ => false,
    }
}

fn is_fixed_operand(unit: &Unit, id: ExprId) -> bool {
    match &unit.expr(id).kind {
        TypedKind::Literal(_) => true,
        TypedKind::Flow(flow) => unit.flow(*flow).role == FlowRole::Param,
        _ => covers_whole(unit, id, &SECONDS),
    }
}

/// Returns `base` if the expression `id` is a part `base.x` of an expression of type `ty`, so that the part stands for
/// the whole value; `None` for other expressions.
fn covered_expr(unit: &Unit, id: ExprId, ty: &Ty) -> Option<ExprId> {
    match unit.expr(id).kind {
        TypedKind::Part { base, .. } if unit.expr(base).ty == *ty => Some(base),
        _ => None,
    }
}

fn covers_whole(unit: &Unit, id: ExprId, ty: &Ty) -> bool {
    covered_expr(unit, id, ty).is_some()
}

/// Converts the expression `id` to seconds if it is an exact time. The expression is changed in place.
pub(crate) fn convert_to_seconds(cx: &mut Body<'_, '_>, id: ExprId) {
    if *cx.ty_of(id) != Ty::Duration {
        return;
    }
    let base = covered_expr(&cx.unit, id, &Ty::Duration);
    let converted = base.map(|base| match &cx.unit.expr(base).kind {
        // The core provides these values in seconds, too.
        TypedKind::Prim(call) if call.prim == prim!("Rpi::PeriodTicks") => {
            prim_call(prim!("Core::CycleTime"), None)
        }
        TypedKind::Prim(call) if call.prim == prim!("Rpi::Elapsed") => {
            prim_call(prim!("Rpi::Time"), None)
        }
        _ => prim_call(prim!("Rpi::SecondsFromTicks"), Some(base)),
    });
    let expr = &mut cx.unit.exprs[id.0 as usize];
    expr.ty = SECONDS;
    if let Some(kind) = converted {
        expr.kind = kind;
    } else if let TypedKind::Prim(call) = &expr.kind
        && let (true, [Some(base)]) = (call.prim == prim!("Rpi::WholeTicks"), &call.inputs[..])
    {
        // An earlier conversion is undone rather than converted back, because it has rounded.
        expr.kind = TypedKind::Part { base: *base, at: 0 };
    }
}

/// Converts the expression `id` from seconds to whole ticks, rounded up, and returns whether this was possible. It is
/// possible if the seconds are fixed when the command is loaded, or chosen among such values.
pub(crate) fn convert_to_ticks(cx: &mut Body<'_, '_>, id: ExprId) -> bool {
    let Some(parts) = fixed_alternatives(cx, id) else {
        return false;
    };
    for part in parts {
        let base = covered_expr(&cx.unit, part, &SECONDS);
        let expr = &mut cx.unit.exprs[part.0 as usize];
        expr.ty = Ty::Duration;
        if let Some(base) = base {
            expr.kind = prim_call(prim!("Rpi::WholeTicks"), Some(base));
        }
    }
    true
}

/// Returns an expression in seconds with all its alternatives, such as the branches of `if` or the cases of `merge`.
/// `None` unless all of them are fixed when the command is loaded, as far as their direct operands show.
pub(crate) fn fixed_alternatives(cx: &Body<'_, '_>, id: ExprId) -> Option<Vec<ExprId>> {
    let mut parts = Vec::new();
    let mut open = vec![id];
    while let Some(id) = open.pop() {
        let expr = cx.unit.expr(id);
        // `none` has any type.
        if expr.ty.is_unknown() && !parts.is_empty() {
            continue;
        }
        if expr.ty != SECONDS || parts.len() > MAX_ALTERNATIVES {
            return None;
        }
        parts.push(id);
        match &expr.kind {
            TypedKind::Literal(_) | TypedKind::Error => {}
            TypedKind::Each(each, operands) => {
                let conditions = usize::from(*each == ElementwiseOp::If);
                open.extend(operands.iter().skip(conditions));
            }
            TypedKind::When { value, .. } | TypedKind::Current(value) => open.push(*value),
            TypedKind::Merge { cases, .. } => open.extend(cases.iter().map(|case| case.1)),
            _ if covers_whole(&cx.unit, id, &SECONDS) => {}
            _ => return None,
        }
    }
    Some(parts)
}

/// Converts an exact time and a real to a common type: a duration that is fixed when the command is loaded becomes
/// ticks; otherwise the time becomes seconds.
pub(crate) fn unify_times(cx: &mut Body<'_, '_>, a: ExprId, b: ExprId) {
    for (time, other) in [(a, b), (b, a)] {
        let is_real = matches!(cx.ty_of(other), Ty::Real(_));
        if *cx.ty_of(time) == Ty::Duration && is_real && !convert_to_ticks(cx, other) {
            convert_to_seconds(cx, time);
        }
    }
}

/// Converts the expression `id` between seconds and ticks as the expected type `wanted` requires.
pub(crate) fn convert_time_for(cx: &mut Body<'_, '_>, id: ExprId, wanted: &Ty) {
    match wanted {
        Ty::Real(_) => convert_to_seconds(cx, id),
        Ty::Duration => _ = convert_to_ticks(cx, id),
        _ => {}
    }
}

/// Returns an argument for a port of the type `time`. Seconds are converted to whole ticks, rounded up, even if they
/// change at run time.
fn ticks_for_port(cx: &mut Body<'_, '_>, id: ExprId) -> ExprId {
    if *cx.ty_of(id) != SECONDS || convert_to_ticks(cx, id) {
        return id;
    }
    ticks_from_seconds(cx, id, cx.span_of(id))
}

/// Adds the conversion `time(x)` from seconds to whole ticks, rounded up, and returns it.
pub(crate) fn ticks_from_seconds(cx: &mut Body<'_, '_>, x: ExprId, span: Span) -> ExprId {
    prim::add_prim(cx, prim!("Rpi::TicksFromSeconds"), &[x], Ty::Duration, span)
}

/// Converts the operands of an operator, of which one is an exact time. Returns whether the operator works on two
/// times, or on a time and an integer; otherwise the operands become seconds, unless one is a Boolean, an integer or an
/// enum value.
fn unify_time_operands(cx: &mut Body<'_, '_>, op: BinaryOp, left: ExprId, right: ExprId) -> bool {
    if matches!(op, Add | Sub | Mod | IntDiv | Lt | Le | Gt | Ge) {
        unify_times(cx, left, right);
    }
    match (cx.ty_of(left), cx.ty_of(right)) {
        (Ty::Duration, Ty::Duration) if !matches!(op, Mul | Div | Pow) => return true,
        (Ty::Duration, Ty::Int) if matches!(op, Mul | IntDiv) => return true,
        (Ty::Int, Ty::Duration) if op == Mul => return true,
        _ => {}
    }
    let is_other = |body: &Body, id| matches!(body.ty_of(id), Ty::Bool | Ty::Int | Ty::Enum(_));
    if !is_other(cx, left) && !is_other(cx, right) {
        convert_to_seconds(cx, left);
        convert_to_seconds(cx, right);
    }
    false
}

/// Converts the fixed duration in a product such as `n * 10[ms]` to ticks, so that the product is an exact multiple of
/// the duration.
fn convert_multiplied_duration(cx: &mut Body<'_, '_>, op: BinaryOp, left: ExprId, right: ExprId) {
    let is_constant = cx.unit.kind == UnitKind::Constant;
    for (count, duration) in [(left, right), (right, left)] {
        let counts = *cx.ty_of(count) == Ty::Int;
        if op == Mul && counts && !is_constant {
            convert_to_ticks(cx, duration);
        }
    }
}

/// Checks an operator of which at least one operand is an exact time, and returns its typed expression. Returns `None`
/// if the operator has no such operand or works on seconds, to which the operands are then converted.
pub(crate) fn time_operator(
    cx: &mut Body<'_, '_>,
    op: BinaryOp,
    left: ExprId,
    right: ExprId,
    span: Span,
) -> Option<ExprId> {
    let is_time = |body: &Body, id| *body.ty_of(id) == Ty::Duration;
    convert_multiplied_duration(cx, op, left, right);
    if !is_time(cx, left) && !is_time(cx, right) || !unify_time_operands(cx, op, left, right) {
        return None;
    }
    let row = TIME_OPS.iter().find(|row| row.op == op)?;
    let gives = match (op, is_time(cx, right)) {
        (IntDiv, false) => Ty::Duration,
        _ => row.gives.clone(),
    };
    let operands = match row.swapped {
        true => [right, left],
        false => [left, right],
    };
    Some(prim::add_prim(cx, row.prim, &operands, gives, span))
}

/// Decides for each type parameter of a callee whether it stands for exact times. It does if all arguments for it are
/// exact times or can be converted, and its constraint allows times; otherwise the arguments become seconds.
pub(crate) fn unify_generic_times(cx: &mut Body<'_, '_>, header: &Header, args: &[Option<ExprId>]) {
    let given = header.inputs.iter().zip(args);
    let generic = given.filter_map(|(port, arg)| match (&port.ty, arg) {
        (Ty::Generic(name), Some(arg)) => Some((name, *arg)),
        _ => None,
    });
    let generic: Vec<(&Name, ExprId)> = generic.collect();
    let is_time = |body: &Body, id| *body.ty_of(id) == Ty::Duration;
    for (name, arg) in &generic {
        if !is_time(cx, *arg) {
            continue;
        }
        let alike = generic.iter().filter(|other| other.0 == *name);
        let alike: Vec<ExprId> = alike.map(|other| other.1).collect();
        let exact = may_be_time(cx.checker, header.decl, name)
            && alike
                .iter()
                .all(|id| is_time(cx, *id) || fixed_alternatives(cx, *id).is_some());
        for id in alike {
            match exact {
                true => _ = convert_to_ticks(cx, id),
                false => convert_to_seconds(cx, id),
            }
        }
    }
}

/// Converts the arguments of a call between ticks and seconds as the types of the ports require.
pub(crate) fn convert_time_args(
    cx: &mut Body<'_, '_>,
    header: &Header,
    args: &mut [Option<ExprId>],
) {
    unify_generic_times(cx, header, args);
    for (port, arg) in header.inputs.iter().zip(args) {
        let Some(id) = arg else {
            continue;
        };
        match &port.ty {
            Ty::Duration => *arg = Some(ticks_for_port(cx, *id)),
            wanted => convert_time_for(cx, *id, wanted),
        }
    }
}

fn prim_call(prim: PrimId, input: Option<ExprId>) -> TypedKind {
    TypedKind::Prim(Box::new(PrimCall {
        prim,
        inputs: input.into_iter().map(Some).collect(),
        params: Box::default(),
    }))
}

/// Whether a type parameter of declaration `id` may stand for exact times: its constraint allows them, and the body is
/// in RPI syntax, because Lustre has no exact times.
fn may_be_time(checker: &Checker<'_>, id: DeclId, name: &Name) -> bool {
    let is_body = matches!(
        checker.program.decl(id).kind,
        DeclKind::Node(_) | DeclKind::Fragment(_)
    );
    let params = static_params::static_params_of_decl(checker, id);
    let constraint = params.iter().find_map(|param| match param {
        StaticParamDecl::Type(of, constraint) if of.name == *name => {
            Some(parse_constraint(*constraint))
        }
        _ => None,
    });
    is_body && !checker.is_lustre(id) && constraint.is_some_and(|c| c.allows(&Ty::Duration))
}
