//! Operators: the primitive for each combination of operand types, and the result type.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::prim;
use crate::check::diagnostics::precedence_hints;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::Wanted;
use crate::check::exprs::apart;
use crate::check::exprs::bracketed;
use crate::check::exprs::clocked;
use crate::check::exprs::compose;
use crate::check::exprs::expr;
use crate::check::exprs::guess::binary_guess;
use crate::check::exprs::guess::guess_by_number;
use crate::check::exprs::guess::unary_guess;
use crate::check::exprs::operand_types;
use crate::check::exprs::proof_only;
use crate::check::types::exact_time;
use crate::check::types::machine_int;
use crate::check::types::quantity;
use crate::check::types::{FOREIGN, is_foreign};
use crate::ty::Ty;
use crate::typed::{Each, Kind};
use crate::typed::{ExprId, UnitKind};
use rpi_diag::{Code, Finding, Span};
use rpi_image::Scalar;
use rpi_net::prim;
use rpi_prims::PrimId;
use rpi_syntax::ast::{self, Binary, ExprKind};
use rpi_syntax::ops::{BinaryOp, UnaryOp};

/// Rule that derives the result type of an operator from its operand types.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum Rule {
    /// Operands of the same type; the result has this type, too.
    Same,
    /// Operands of the same type; the result is a Boolean.
    Test,
    /// Product: the dimensions are multiplied.
    Times,
    /// Quotient: the dimensions are divided.
    Over,
    /// Power with a constant exponent.
    Power,
    /// Composition of frames, `(b in a) * (c in b)`.
    Compose,
    /// Point in time plus seconds; the result is a point in time.
    Moment,
    /// Difference of two points in time; the result is in seconds.
    Seconds,
}

/// Overload of an operator: the primitive for operands of given machine types.
pub(crate) struct Row {
    pub(crate) op: BinaryOp,
    pub(crate) left: Scalar,
    pub(crate) right: Scalar,
    pub(crate) prim: PrimId,
    /// Whether the primitive takes the right operand first.
    pub(crate) swapped: bool,
    pub(crate) rule: Rule,
}

const fn row(
    op: BinaryOp,
    (left, right): (Scalar, Scalar),
    prim: PrimId,
    swapped: bool,
    rule: Rule,
) -> Row {
    Row {
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

/// All binary operators that map to one primitive.
#[rustfmt::skip]
const BINARY: &[Row] = &[
    row(And,     (Bool, Bool),         prim!("Core::BooleanAnd"),        false, Rule::Test),
    row(Or,      (Bool, Bool),         prim!("Core::BooleanOr"),         false, Rule::Test),
    row(Xor,     (Bool, Bool),         prim!("Rpi::BooleanXor"),         false, Rule::Test),
    row(Implies, (Bool, Bool),         prim!("Rpi::BooleanImplies"),     false, Rule::Test),
    row(Add,     (Int, Int),           prim!("Core::IntAdd"),            false, Rule::Same),
    row(Sub,     (Int, Int),           prim!("Rpi::IntSubtract"),        false, Rule::Same),
    row(Mul,     (Int, Int),           prim!("Core::IntMultiply"),       false, Rule::Same),
    row(Div,     (Int, Int),           prim!("Core::IntDivide"),         false, Rule::Same),
    row(IntDiv,  (Int, Int),           prim!("Core::IntDivide"),         false, Rule::Same),
    row(Mod,     (Int, Int),           prim!("Rpi::IntModulo"),          false, Rule::Same),
    row(Pow,     (Int, Int),           prim!("Rpi::IntPower"),           false, Rule::Same),
    row(Add,     (Real, Real),         prim!("Core::DoubleAdd"),         false, Rule::Same),
    row(Sub,     (Real, Real),         prim!("Rpi::DoubleSubtract"),     false, Rule::Same),
    row(Mul,     (Real, Real),         prim!("Core::DoubleMultiply"),    false, Rule::Times),
    row(Div,     (Real, Real),         prim!("Core::DoubleDivide"),      false, Rule::Over),
    row(Mod,     (Real, Real),         prim!("Core::DoubleModulo"),      false, Rule::Same),
    row(Pow,     (Real, Real),         prim!("Core::DoublePower"),       false, Rule::Power),
    row(Lt,      (Int, Int),           prim!("Core::IntGreater"),        true,  Rule::Test),
    row(Gt,      (Int, Int),           prim!("Core::IntGreater"),        false, Rule::Test),
    row(Le,      (Int, Int),           prim!("Rpi::IntGreaterOrEqual"),  true,  Rule::Test),
    row(Ge,      (Int, Int),           prim!("Rpi::IntGreaterOrEqual"),  false, Rule::Test),
    row(Lt,      (Real, Real),         prim!("Core::DoubleGreater"),     true,  Rule::Test),
    row(Gt,      (Real, Real),         prim!("Core::DoubleGreater"),     false, Rule::Test),
    row(Le,      (Real, Real),         prim!("Rpi::DoubleGreaterOrEqual"), true,  Rule::Test),
    row(Ge,      (Real, Real),         prim!("Rpi::DoubleGreaterOrEqual"), false, Rule::Test),
    row(Add,     (Vector, Vector),     prim!("World::VectorAdd"),        false, Rule::Same),
    row(Sub,     (Vector, Vector),     prim!("Rpi::VectorSubtract"),     false, Rule::Same),
    row(Mul,     (Vector, Real),       prim!("World::VectorScale"),      false, Rule::Times),
    row(Mul,     (Real, Vector),       prim!("World::VectorScale"),      true,  Rule::Times),
    row(Add,     (Twist, Twist),       prim!("World::TwistAdd"),         false, Rule::Same),
    row(Add,     (Wrench, Wrench),     prim!("Rpi::WrenchAdd"),          false, Rule::Same),
    row(Mul,     (Rotation, Rotation), prim!("World::RotationTransform"), false, Rule::Compose),
    row(Mul,     (Rotation, Vector),   prim!("World::VectorRotate"),     true,  Rule::Compose),
    row(Mul,     (Pose, Pose),         prim!("World::FrameTransform"),   false, Rule::Compose),
    row(Mul,     (Pose, Vector),       prim!("Rpi::FrameApply"),         false, Rule::Compose),
    row(Mul,     (Rotation, Twist),    prim!("World::TwistRotate"),      true,  Rule::Compose),
    row(Add,     (Time, Real),         prim!("Core::TimeAdd"),           false, Rule::Moment),
    row(Sub,     (Time, Time),         prim!("Core::TimeDiff"),          false, Rule::Seconds),
];

/// Ordering operators; their result is a Boolean.
pub(crate) const TESTS: &[BinaryOp] = &[Lt, Le, Gt, Ge];

/// Division primitives, which are undefined for a right operand of 0.
const DIVISIONS: &[PrimId] = &[prim!("Core::IntDivide"), prim!("Rpi::IntModulo")];

/// All unary operators that map to one primitive.
#[rustfmt::skip]
const UNARY: &[(UnaryOp, Scalar, PrimId)] = &[
    (UnaryOp::Not,    Bool,   prim!("Core::BooleanNot")),
    (UnaryOp::Neg,    Int,    prim!("Rpi::IntNegate")),
    (UnaryOp::Neg,    Real,   prim!("Rpi::DoubleNegate")),
    (UnaryOp::Neg,    Vector, prim!("Rpi::VectorNegate")),
    (UnaryOp::ToInt,  Real,   prim!("Core::IntFromDouble")),
    (UnaryOp::ToReal, Int,    prim!("Core::DoubleFromInt")),
];

/// Checks a unary operation `op operand`.
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

/// Checks a unary operator on a checked operand.
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
        return cx.add(Kind::Fault, unary_guess(op), span);
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
        let wanted = Wanted::By(Span::NONE, "an integer has no unit".into());
        statement::expect_type(cx, operand, &Ty::REAL, &wanted);
    }
    if let Ty::Machine(of) = ty
        && let Some(value) = machine_int::machine_unary(cx, op, operand, of, span)
    {
        return value;
    }
    if is_foreign(&ty, FOREIGN) && matches!(op, UnaryOp::Neg | UnaryOp::BitNot | UnaryOp::ToInt) {
        let ty = if op == UnaryOp::ToInt { Ty::Int } else { ty };
        return cx.add(Kind::Outside, ty, span);
    }
    let kind = match &ty {
        Ty::Duration => Some(Int),
        ty => operand_types::operand_kind(ty),
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
            let finding = Finding::new(
                Code::RPI2006,
                format!("`{}` cannot take `{ty}`", op.spelling()),
            )
            .at(cx.span_of(operand), format!("this is `{ty}`"));
            let finding = quantity::operand_apart(finding, op, &ty);
            cx.fault_with(finding, span)
        }
    }
}

fn pre<'a>(cx: &mut Body<'_, 'a>, operand: &'a ast::Expr, span: Span) -> ExprId {
    cx.has_state(span);
    cx.bindings.pre_depth += 1;
    let operand = expr::check_expr(cx, operand);
    cx.bindings.pre_depth -= 1;
    let ty = cx.ty_of(operand).clone();
    cx.add(Kind::Each(Each::Pre, [operand].into()), ty, span)
}

/// Checks a binary operation `lhs op rhs`.
pub(crate) fn check_binary<'a>(cx: &mut Body<'_, 'a>, binary: &'a Binary, span: Span) -> ExprId {
    match binary.op {
        BinaryOp::Concat => compose::array_concat(cx, binary, span),
        BinaryOp::Append => machine_int::bit_concat(cx, binary, span),
        BinaryOp::Repeat => compose::array_repeat(cx, binary, span),
        BinaryOp::Coalesce => bracketed::elementwise_binary(cx, Each::Coalesce, binary, span),
        BinaryOp::Arrow => {
            cx.has_state(span);
            bracketed::elementwise_binary(cx, Each::Arrow, binary, span)
        }
        BinaryOp::Fby => fby(cx, binary, span),
        BinaryOp::In => proof_only::membership(cx, &binary.lhs, &binary.rhs, span),
        op => {
            let (left, right) = (
                expr::check_expr(cx, &binary.lhs),
                expr::check_expr(cx, &binary.rhs),
            );
            if TESTS.contains(&op) && is_invalid_sample(cx, &binary.lhs, left) {
                return cx.fault(span);
            }
            if operand_types::is_chained(binary) {
                return cx.add(Kind::Fault, Ty::Bool, span);
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

/// Whether the left side is an invalid sampled flow, as in `x when x > 0.0`. The comparison then reports no further
/// error.
fn is_invalid_sample(cx: &Body<'_, '_>, lhs: &ast::Expr, left: ExprId) -> bool {
    matches!(lhs.kind, ExprKind::When(_)) && matches!(cx.unit.expr(left).kind, Kind::Fault)
}

/// Checks a binary operator on checked operands.
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
        let guess = guess_by_number(cx.inference.guess_policy, op, &a, &b);
        let guess = guess.unwrap_or_else(|| binary_guess(op, &a, &b));
        // After errors on both sides, of arrays for instance, the result type cannot be guessed.
        let faulty = !cx.inference.is_running && a.is_unknown() && b.is_unknown();
        let guess = if faulty { Ty::Unknown } else { guess };
        return cx.add(Kind::Fault, guess, span);
    }
    if let Some(value) = machine_int::machine_binary(cx, op, [left, right], span) {
        return value;
    }
    let shifts = matches!(op, BinaryOp::ShiftLeft | BinaryOp::ShiftRight) && b == Ty::Int;
    if is_foreign(&a, FOREIGN) && (a == b || shifts) {
        let ty = if TESTS.contains(&op) { Ty::Bool } else { a };
        return cx.add(Kind::Outside, ty, span);
    }
    if let Some(of_times) = exact_time::time_operator(cx, op, left, right, span) {
        return of_times;
    }
    let (a, b) = (cx.ty_of(left).clone(), cx.ty_of(right).clone());
    let kinds = (
        operand_types::operand_kind(&a),
        operand_types::operand_kind(&b),
    );
    let fits = |row: &&Row| row.op == op && (Some(row.left), Some(row.right)) == kinds;
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
        return cx.fault(span);
    }
    let operands = if row.swapped {
        [right, left]
    } else {
        [left, right]
    };
    prim::add_prim(cx, row.prim, &operands, ty, span)
}

/// Adds a logical operation on checked Booleans.
pub(crate) fn logical_prim(
    cx: &mut Body<'_, '_>,
    prim: PrimId,
    operands: &[ExprId],
    span: Span,
) -> ExprId {
    prim::add_prim(cx, prim, operands, Ty::Bool, span)
}

/// Checks `a fby b`, which is `a -> pre b`.
fn fby<'a>(cx: &mut Body<'_, 'a>, binary: &'a Binary, span: Span) -> ExprId {
    cx.has_state(span);
    let left = expr::check_expr(cx, &binary.lhs);
    cx.bindings.pre_depth += 1;
    let right = expr::check_expr(cx, &binary.rhs);
    cx.bindings.pre_depth -= 1;
    let ty = expr::common_type(cx, left, right, "both sides must have the same type");
    let delayed = cx.add(Kind::Each(Each::Pre, [right].into()), ty.clone(), span);
    cx.add(Kind::Each(Each::Arrow, [left, delayed].into()), ty, span)
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
    let finding = Finding::new(
        Code::RPI2006,
        format!("`{text}` cannot take `{a}` and `{b}`"),
    )
    .at(cx.span_of(right), format!("this is `{b}`"))
    .also(cx.span_of(left), format!("this is `{a}`"));
    let finding = apart::with_operand_hints(cx, finding, op, (left, &a), (right, &b));
    let is_int_number = |id| report::is_number_literal(cx, id) && *cx.ty_of(id) == Ty::Int;
    let with_number = [left, right].into_iter().any(is_int_number);
    cx.inference.real_fix_index =
        (with_number && finding.fixes.len() == 1).then_some(cx.findings.len());
    cx.fault_with(finding, span)
}
