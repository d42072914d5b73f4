//! Operators: the primitive for each combination of operand types, and the result type.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::prim;
use crate::check::diagnostics::precedence_hints;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::apart;
use crate::check::exprs::bracketed;
use crate::check::exprs::clocked;
use crate::check::exprs::compose;
use crate::check::exprs::expr;
use crate::check::exprs::guess::binary_guess;
use crate::check::exprs::guess::guess_from_number;
use crate::check::exprs::guess::unary_guess;
use crate::check::exprs::operand_types;
use crate::check::exprs::proof_only;
use crate::check::types::exact_time;
use crate::check::types::machine_int;
use crate::check::types::quantity;
use crate::check::types::{UNCHECKED_TYPE_PREFIXES, is_kind2_type};
use crate::ty::Ty;
use crate::typed::{ElementwiseOp, TypedKind};
use crate::typed::{ExprId, UnitKind};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::Scalar;
use rpi_net::prim;
use rpi_prims::PrimId;
use rpi_syntax::ast::{self, Binary, ExprKind};
use rpi_syntax::ops::{BinaryOp, UnaryOp};

/// Rule that gives the result type of an operator from its operand types.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum ResultRule {
    /// The operands have the same type, and the result has this type as well.
    Same,
    /// The operands have the same type; the result is a Boolean.
    Boolean,
    /// The operator is a product: the dimension of the result is the product of those of the operands.
    Product,
    /// The operator is a quotient: the dimension of the result is the quotient of those of the operands.
    Quotient,
    /// The operator is a power with a constant exponent: the dimension of the base is raised to it.
    Power,
    /// The operator multiplies or divides a twist or wrench, whose parts have units of their own, by a number without
    /// unit.
    Scale,
    /// The operator is a power of a rotation, with a number as exponent.
    RotationPower,
    /// The operator composes two poses: for `a` and `b` it computes `a * b`, where `(b in a) * (c in b)` is `(c in a)`.
    Compose,
    /// The operands are a point in time and seconds; the result is a point in time.
    TimePoint,
    /// The operands are points in time; the result is their difference in seconds.
    Seconds,
}

/// Overload of a binary operator: the primitive that computes it for operands of two given machine types.
pub(crate) struct Overload {
    pub(crate) op: BinaryOp,
    pub(crate) left: Scalar,
    pub(crate) right: Scalar,
    pub(crate) prim: PrimId,
    /// Whether the primitive takes the right operand as its first in-port, as `a > b` can be computed by `b < a`.
    pub(crate) swapped: bool,
    pub(crate) rule: ResultRule,
}

const fn overload(
    op: BinaryOp,
    (left, right): (Scalar, Scalar),
    prim: PrimId,
    swapped: bool,
    rule: ResultRule,
) -> Overload {
    Overload {
        op,
        left,
        right,
        prim,
        swapped,
        rule,
    }
}

use BinaryOp::{Add, And, Div, Ge, Gt, Implies, IntDiv, Le, Lt, Mod, Mul, Or, Pow, Sub, Xor};
use Scalar::{Bool, Int, Pose, Real, Rotation, Time, Twist, Vector, Wrench};

/// All binary operators that are implemented by one primitive for each combination of operand types.
#[rustfmt::skip]
const BINARY: &[Overload] = &[
    overload(And,     (Bool, Bool),         prim!("Core::BooleanAnd"),        false, ResultRule::Boolean),
    overload(Or,      (Bool, Bool),         prim!("Core::BooleanOr"),         false, ResultRule::Boolean),
    overload(Xor,     (Bool, Bool),         prim!("Rpi::BooleanXor"),         false, ResultRule::Boolean),
    overload(Implies, (Bool, Bool),         prim!("Rpi::BooleanImplies"),     false, ResultRule::Boolean),
    overload(Add,     (Int, Int),           prim!("Core::IntAdd"),            false, ResultRule::Same),
    overload(Sub,     (Int, Int),           prim!("Rpi::IntSubtract"),        false, ResultRule::Same),
    overload(Mul,     (Int, Int),           prim!("Core::IntMultiply"),       false, ResultRule::Same),
    overload(Div,     (Int, Int),           prim!("Core::IntDivide"),         false, ResultRule::Same),
    overload(IntDiv,  (Int, Int),           prim!("Core::IntDivide"),         false, ResultRule::Same),
    overload(Mod,     (Int, Int),           prim!("Rpi::IntModulo"),          false, ResultRule::Same),
    overload(Pow,     (Int, Int),           prim!("Rpi::IntPower"),           false, ResultRule::Same),
    overload(Add,     (Real, Real),         prim!("Core::DoubleAdd"),         false, ResultRule::Same),
    overload(Sub,     (Real, Real),         prim!("Rpi::DoubleSubtract"),     false, ResultRule::Same),
    overload(Mul,     (Real, Real),         prim!("Core::DoubleMultiply"),    false, ResultRule::Product),
    overload(Div,     (Real, Real),         prim!("Core::DoubleDivide"),      false, ResultRule::Quotient),
    overload(Mod,     (Real, Real),         prim!("Core::DoubleModulo"),      false, ResultRule::Same),
    overload(Pow,     (Real, Real),         prim!("Core::DoublePower"),       false, ResultRule::Power),
    overload(Lt,      (Int, Int),           prim!("Core::IntGreater"),        true,  ResultRule::Boolean),
    overload(Gt,      (Int, Int),           prim!("Core::IntGreater"),        false, ResultRule::Boolean),
    overload(Le,      (Int, Int),           prim!("Rpi::IntGreaterOrEqual"),  true,  ResultRule::Boolean),
    overload(Ge,      (Int, Int),           prim!("Rpi::IntGreaterOrEqual"),  false, ResultRule::Boolean),
    overload(Lt,      (Real, Real),         prim!("Core::DoubleGreater"),     true,  ResultRule::Boolean),
    overload(Gt,      (Real, Real),         prim!("Core::DoubleGreater"),     false, ResultRule::Boolean),
    overload(Le,      (Real, Real),         prim!("Rpi::DoubleGreaterOrEqual"), true,  ResultRule::Boolean),
    overload(Ge,      (Real, Real),         prim!("Rpi::DoubleGreaterOrEqual"), false, ResultRule::Boolean),
    overload(Add,     (Vector, Vector),     prim!("World::VectorAdd"),        false, ResultRule::Same),
    overload(Sub,     (Vector, Vector),     prim!("Rpi::VectorSubtract"),     false, ResultRule::Same),
    overload(Mul,     (Vector, Real),       prim!("World::VectorScale"),      false, ResultRule::Product),
    overload(Mul,     (Real, Vector),       prim!("World::VectorScale"),      true,  ResultRule::Product),
    overload(Div,     (Vector, Real),       prim!("Rpi::VectorDivide"),       false, ResultRule::Quotient),
    overload(Add,     (Twist, Twist),       prim!("World::TwistAdd"),         false, ResultRule::Same),
    overload(Sub,     (Twist, Twist),       prim!("Rpi::TwistSubtract"),      false, ResultRule::Same),
    overload(Mul,     (Twist, Real),        prim!("Rpi::TwistScale"),         false, ResultRule::Scale),
    overload(Mul,     (Real, Twist),        prim!("Rpi::TwistScale"),         true,  ResultRule::Scale),
    overload(Div,     (Twist, Real),        prim!("Rpi::TwistDivide"),        false, ResultRule::Scale),
    overload(Add,     (Wrench, Wrench),     prim!("Rpi::WrenchAdd"),          false, ResultRule::Same),
    overload(Sub,     (Wrench, Wrench),     prim!("Rpi::WrenchSubtract"),     false, ResultRule::Same),
    overload(Mul,     (Wrench, Real),       prim!("Rpi::WrenchScale"),        false, ResultRule::Scale),
    overload(Mul,     (Real, Wrench),       prim!("Rpi::WrenchScale"),        true,  ResultRule::Scale),
    overload(Div,     (Wrench, Real),       prim!("Rpi::WrenchDivide"),       false, ResultRule::Scale),
    overload(Pow,     (Rotation, Real),     prim!("Rpi::RotationPower"),      false, ResultRule::RotationPower),
    overload(Mul,     (Rotation, Rotation), prim!("World::RotationTransform"), false, ResultRule::Compose),
    overload(Mul,     (Rotation, Vector),   prim!("World::VectorRotate"),     true,  ResultRule::Compose),
    overload(Mul,     (Pose, Pose),         prim!("World::FrameTransform"),   false, ResultRule::Compose),
    overload(Mul,     (Pose, Vector),       prim!("Rpi::FrameApply"),         false, ResultRule::Compose),
    overload(Mul,     (Rotation, Twist),    prim!("World::TwistRotate"),      true,  ResultRule::Compose),
    overload(Mul,     (Rotation, Wrench),   prim!("Rpi::WrenchRotate"),       true,  ResultRule::Compose),
    overload(Add,     (Time, Real),         prim!("Core::TimeAdd"),           false, ResultRule::TimePoint),
    overload(Sub,     (Time, Time),         prim!("Core::TimeDiff"),          false, ResultRule::Seconds),
];

/// Operators that compare by size. Their result is a Boolean.
pub(crate) const ORDERINGS: &[BinaryOp] = &[Lt, Le, Gt, Ge];

/// Division primitives, which are undefined for a right operand of 0.
const DIVISIONS: &[PrimId] = &[prim!("Core::IntDivide"), prim!("Rpi::IntModulo")];

/// All unary operators that are implemented by one primitive for each operand type.
#[rustfmt::skip]
const UNARY: &[(UnaryOp, Scalar, PrimId)] = &[
    (UnaryOp::Not,    Bool,   prim!("Core::BooleanNot")),
    (UnaryOp::Neg,    Int,    prim!("Rpi::IntNegate")),
    (UnaryOp::Neg,    Real,   prim!("Rpi::DoubleNegate")),
    (UnaryOp::Neg,    Vector, prim!("Rpi::VectorNegate")),
    (UnaryOp::Neg,    Twist,  prim!("Rpi::TwistNegate")),
    (UnaryOp::Neg,    Wrench, prim!("Rpi::WrenchNegate")),
    (UnaryOp::ToInt,  Real,   prim!("Core::IntFromDouble")),
    (UnaryOp::ToReal, Int,    prim!("Core::DoubleFromInt")),
];

/// Checks a unary operation `op operand` and returns its typed expression.
pub(crate) fn unary<'a>(
    cx: &mut Body<'_, 'a>,
    op: UnaryOp,
    operand: &'a ast::Expr,
    span: Span,
) -> ExprId {
    if let (UnaryOp::Neg, ExprKind::Number(number)) = (op, &operand.kind) {
        cx.inference.number_literals.insert(span);
        return expr::number_literal(cx, number, true, span);
    }
    match op {
        UnaryOp::Pre => pre(cx, operand, span),
        UnaryOp::Last => clocked::last_expr(cx, operand, span),
        UnaryOp::Current => clocked::current_expr(cx, operand, span),
        _ => {
            let operand = expr::check_expr(cx, operand);
            unary_prim(cx, op, operand, span)
        }
    }
}

/// Checks a unary operator on an operand that has been checked, and returns its typed expression.
pub(crate) fn unary_prim(
    cx: &mut Body<'_, '_>,
    op: UnaryOp,
    operand: ExprId,
    span: Span,
) -> ExprId {
    if matches!(op, UnaryOp::ToReal | UnaryOp::ToInt) {
        exact_time::convert_to_seconds(cx, operand);
    }
    let ty = cx.ty_of(operand).clone();
    if ty.is_unknown() {
        return cx.add(TypedKind::Error, unary_guess(op), span);
    }
    if (op, &ty) == (UnaryOp::BitNot, &Ty::Bool) {
        return precedence_hints::bitwise_not_on_boolean(cx, operand, span);
    }
    if matches!(
        (op, &ty),
        (UnaryOp::ToInt, Ty::Int) | (UnaryOp::ToReal, Ty::Real(_))
    ) {
        return operand;
    }
    if op == UnaryOp::ToInt && matches!(ty, Ty::Real(_)) {
        let wanted = ExpectationReason::Because(Span::NONE, "an integer has no unit".into());
        statement::expect_type(cx, operand, &Ty::REAL, &wanted);
    }
    if let Ty::Machine(of) = ty
        && let Some(value) = machine_int::machine_unary(cx, op, operand, of, span)
    {
        return value;
    }
    if is_kind2_type(&ty, UNCHECKED_TYPE_PREFIXES)
        && matches!(op, UnaryOp::Neg | UnaryOp::BitNot | UnaryOp::ToInt)
    {
        let ty = if op == UnaryOp::ToInt { Ty::Int } else { ty };
        return cx.add(TypedKind::Arbitrary, ty, span);
    }
    let kind = match &ty {
        Ty::Duration => Some(Int),
        ty => operand_types::operand_scalar(ty),
    };
    let row = UNARY.iter().find(|row| row.0 == op && Some(row.1) == kind);
    match row {
        Some((_, _, prim)) => {
            let ty = match op {
                UnaryOp::Neg => ty,
                _ => unary_guess(op),
            };
            prim::add_prim(cx, *prim, &[operand], ty, span)
        }
        None => {
            let diagnostic = unsupported_operand(cx, op, operand, &ty);
            cx.report_error_expr(diagnostic, span)
        }
    }
}

fn unsupported_operand(cx: &Body<'_, '_>, op: UnaryOp, operand: ExprId, ty: &Ty) -> Diagnostic {
    let message = format!("`{}` cannot take `{ty}`", op.spelling());
    let diagnostic = Diagnostic::new(Code::RPI2006, message)
        .primary(cx.span_of(operand), format!("this is `{ty}`"));
    quantity::with_operand_hint(diagnostic, op, ty, cx.span_of(operand))
}

fn pre<'a>(cx: &mut Body<'_, 'a>, operand: &'a ast::Expr, span: Span) -> ExprId {
    cx.record_state(span);
    cx.bindings.pre_depth += 1;
    let operand = expr::check_expr(cx, operand);
    cx.bindings.pre_depth -= 1;
    let ty = cx.ty_of(operand).clone();
    cx.add(
        TypedKind::Each(ElementwiseOp::Pre, [operand].into()),
        ty,
        span,
    )
}

/// Checks a binary operation `lhs op rhs` and returns its typed expression.
pub(crate) fn check_binary<'a>(cx: &mut Body<'_, 'a>, binary: &'a Binary, span: Span) -> ExprId {
    match binary.op {
        BinaryOp::Concat => compose::array_concat(cx, binary, span),
        BinaryOp::Append => machine_int::bit_concat(cx, binary, span),
        BinaryOp::Repeat => compose::array_repeat(cx, binary, span),
        BinaryOp::Coalesce => {
            bracketed::elementwise_binary(cx, ElementwiseOp::Coalesce, binary, span)
        }
        BinaryOp::Arrow => {
            cx.record_state(span);
            bracketed::elementwise_binary(cx, ElementwiseOp::Arrow, binary, span)
        }
        BinaryOp::Fby => fby(cx, binary, span),
        BinaryOp::In => proof_only::membership(cx, &binary.lhs, &binary.rhs, span),
        op => {
            let (left, right) = (
                expr::check_expr(cx, &binary.lhs),
                expr::check_expr(cx, &binary.rhs),
            );
            if ORDERINGS.contains(&op) && is_invalid_sample(cx, &binary.lhs, left) {
                return cx.error_expr(span);
            }
            if operand_types::is_chained_comparison(binary) {
                return cx.add(TypedKind::Error, Ty::Bool, span);
            }
            if let Some(meant) =
                precedence_hints::reinterpret_operator(cx, binary, [left, right], span)
            {
                return meant;
            }
            binary_prim(cx, op, left, right, span)
        }
    }
}

/// Whether the left operand of a comparison is a sampled flow with a reported error, as in `x when x > 0.0`, which is
/// parsed as `(x when x) > 0.0`. The comparison then reports no further error.
fn is_invalid_sample(cx: &Body<'_, '_>, lhs: &ast::Expr, left: ExprId) -> bool {
    matches!(lhs.kind, ExprKind::When(_)) && matches!(cx.unit.expr(left).kind, TypedKind::Error)
}

/// Checks a binary operator on operands that have been checked, and returns its typed expression.
pub(crate) fn binary_prim(
    cx: &mut Body<'_, '_>,
    op: BinaryOp,
    left: ExprId,
    right: ExprId,
    span: Span,
) -> ExprId {
    if matches!(op, BinaryOp::Eq | BinaryOp::Ne) {
        return operand_types::equality(cx, op, left, right, span);
    }
    let (a, b) = (cx.ty_of(left).clone(), cx.ty_of(right).clone());
    if a.is_unknown() || b.is_unknown() {
        operand_types::extend_real_fix(cx, left, right);
        let guess = guess_from_number(cx.inference.guess_policy, op, &a, &b);
        let guess = guess.unwrap_or_else(|| binary_guess(op, &a, &b));
        // After errors on both sides, of arrays for instance, the result type cannot be guessed.
        let faulty = !cx.inference.is_running && a.is_unknown() && b.is_unknown();
        let guess = if faulty { Ty::Unknown } else { guess };
        return cx.add(TypedKind::Error, guess, span);
    }
    if let Some(value) = machine_int::machine_binary(cx, op, [left, right], span) {
        return value;
    }
    let shifts = matches!(op, BinaryOp::ShiftLeft | BinaryOp::ShiftRight) && b == Ty::Int;
    if is_kind2_type(&a, UNCHECKED_TYPE_PREFIXES) && (a == b || shifts) {
        let ty = if ORDERINGS.contains(&op) { Ty::Bool } else { a };
        return cx.add(TypedKind::Arbitrary, ty, span);
    }
    if let Some(of_times) = exact_time::time_operator(cx, op, left, right, span) {
        return of_times;
    }
    let (a, b) = (cx.ty_of(left).clone(), cx.ty_of(right).clone());
    let kinds = (
        operand_types::operand_scalar(&a),
        operand_types::operand_scalar(&b),
    );
    let fits = |row: &&Overload| row.op == op && (Some(row.left), Some(row.right)) == kinds;
    let Some(row) = BINARY.iter().find(fits) else {
        return unsupported_operands(cx, op, left, right, span);
    };
    // The evaluation of a constant reports the division by zero itself.
    let is_run = cx.unit.kind != UnitKind::Constant;
    if is_run && DIVISIONS.contains(&row.prim) && operand_types::is_zero(cx, right) {
        operand_types::division_by_zero(cx, op, right);
    }
    let ty = operand_types::result_type(cx, row, left, right);
    if ty.is_unknown() {
        return cx.error_expr(span);
    }
    let operands = if row.swapped {
        [right, left]
    } else {
        [left, right]
    };
    prim::add_prim(cx, row.prim, &operands, ty, span)
}

/// Adds a logical operation on Booleans that have been checked, and returns it.
pub(crate) fn logical_prim(
    cx: &mut Body<'_, '_>,
    prim: PrimId,
    operands: &[ExprId],
    span: Span,
) -> ExprId {
    prim::add_prim(cx, prim, operands, Ty::Bool, span)
}

/// Checks `a fby b`, which means `a -> pre b`, and returns its typed expression.
fn fby<'a>(cx: &mut Body<'_, 'a>, binary: &'a Binary, span: Span) -> ExprId {
    cx.record_state(span);
    let left = expr::check_expr(cx, &binary.lhs);
    cx.bindings.pre_depth += 1;
    let right = expr::check_expr(cx, &binary.rhs);
    cx.bindings.pre_depth -= 1;
    let ty = expr::common_type(cx, left, right, "both sides must have the same type");
    let delayed = cx.add(
        TypedKind::Each(ElementwiseOp::Pre, [right].into()),
        ty.clone(),
        span,
    );
    cx.add(
        TypedKind::Each(ElementwiseOp::Arrow, [left, delayed].into()),
        ty,
        span,
    )
}

pub(crate) fn unsupported_operands(
    cx: &mut Body<'_, '_>,
    op: BinaryOp,
    left: ExprId,
    right: ExprId,
    span: Span,
) -> ExprId {
    let (a, b) = (cx.ty_of(left).clone(), cx.ty_of(right).clone());
    let text = op.spelling();
    let diagnostic = Diagnostic::new(
        Code::RPI2006,
        format!("`{text}` cannot take `{a}` and `{b}`"),
    )
    .primary(cx.span_of(right), format!("this is `{b}`"))
    .secondary(cx.span_of(left), format!("this is `{a}`"));
    let diagnostic = apart::with_operand_hints(cx, diagnostic, op, (left, &a), (right, &b));
    let is_int_number = |id| report::is_number_literal(cx, id) && *cx.ty_of(id) == Ty::Int;
    let with_number = [left, right].into_iter().any(is_int_number);
    cx.inference.real_fix_index =
        (with_number && diagnostic.fixes.len() == 1).then_some(cx.diagnostics.len());
    cx.report_error_expr(diagnostic, span)
}
