//! Types of operands and results of binary operators.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::expr;
use crate::check::exprs::ops::Overload;
use crate::check::exprs::ops::ResultRule;
use crate::check::types::consts;
use crate::check::types::exact_time;
use crate::check::types::frames;
use crate::check::types::quantity;
use crate::ty::{Geometry, Ty, TypeMismatchError, join};
use crate::typed::TypedKind;
use crate::typed::{ExprId, Leaf, Unit};
use crate::units::{Dimension, Ratio};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::Scalar;
use rpi_syntax::Name;
use rpi_syntax::ast::{Binary, ExprKind};
use rpi_syntax::ops::{Associativity, BinaryOp};
use std::rc::Rc;

/// Whether an expression is the integer 0, written as a literal or as one operation on literals. Named constants do not
/// count.
pub(crate) fn is_zero(cx: &mut Body<'_, '_>, id: ExprId) -> bool {
    let literal = |unit: &Unit, id: ExprId| matches!(unit.expr(id).kind, TypedKind::Literal(_));
    let known = match &cx.unit.expr(id).kind {
        TypedKind::Literal(_) => true,
        TypedKind::Prim(call) => {
            let mut inputs = call.inputs.iter().flatten();
            inputs.all(|input| literal(&cx.unit, *input))
        }
        _ => false,
    };
    let value = known.then(|| consts::try_fold(cx, id).ok()).flatten();
    value.is_some_and(|leaves| leaves.first().and_then(Leaf::as_int) == Some(0))
}

/// Reports a division whose divisor is the constant 0, unless the division is in a branch that is never taken.
pub(crate) fn division_by_zero(cx: &mut Body<'_, '_>, op: BinaryOp, divisor: ExprId) {
    if expr::is_in_untaken_branch(cx) {
        return;
    }
    let message = format!("`{}` by zero is undefined", op.spelling());
    let diagnostic = Diagnostic::new(Code::RPI2012, message)
        .primary(cx.span_of(divisor), "this is 0 in every cycle")
        .help("use a divisor other than 0");
    report::report_diagnostic(cx, diagnostic);
}

/// Extends the fix that writes the first integer literal of `x * 2 + 1` as a real to the other integer literals of the
/// expression. `left` and `right` are the operands of an operator, one of which has a reported error.
pub(crate) fn extend_real_fix(cx: &mut Body<'_, '_>, left: ExprId, right: ExprId) {
    let is_int =
        |body: &Body, id| report::is_number_literal(body, id) && *body.ty_of(id) == Ty::Int;
    let (faulty, int) = match (is_int(cx, left), is_int(cx, right)) {
        (false, true) => (cx.span_of(left), cx.span_of(right)),
        (true, false) => (cx.span_of(right), cx.span_of(left)),
        _ => return,
    };
    let Some(diagnostic) = cx
        .inference
        .real_fix_index
        .and_then(|at| cx.diagnostics.get_mut(at))
    else {
        return;
    };
    let place = diagnostic.span();
    let is_inside = place.start >= faulty.start && place.end <= faulty.end;
    if let Some(fix) = diagnostic.fixes.first_mut().filter(|_| is_inside) {
        *fix = fix.clone().insert_after(int, ".0");
    }
}

pub(crate) fn result_type(
    cx: &mut Body<'_, '_>,
    row: &Overload,
    left: ExprId,
    right: ExprId,
) -> Ty {
    let (a, b) = (cx.ty_of(left).clone(), cx.ty_of(right).clone());
    match row.rule {
        ResultRule::Same => common_operand_type(cx, row.op, left, right),
        ResultRule::Boolean => {
            common_operand_type(cx, row.op, left, right);
            Ty::Bool
        }
        ResultRule::Product => scaled_type(cx, &a, &b, Dimension::times, left),
        ResultRule::Quotient => scaled_type(cx, &a, &b, Dimension::divided_by, left),
        ResultRule::Power => power_type(cx, &a, left, right),
        ResultRule::Scale => match matches!(a, Ty::Real(_)) {
            true => unitless_multiple(cx, right, left),
            false => unitless_multiple(cx, left, right),
        },
        ResultRule::RotationPower => rotation_power_type(cx, left, right),
        ResultRule::Compose => frames::composed_pose_type(cx, left, right),
        ResultRule::TimePoint => {
            statement::expect_type(
                cx,
                right,
                &Ty::Real(Dimension::TIME),
                &ExpectationReason::Unexplained,
            );
            Ty::Time
        }
        ResultRule::Seconds => Ty::Real(Dimension::TIME),
    }
}

fn common_operand_type(cx: &mut Body<'_, '_>, op: BinaryOp, left: ExprId, right: ExprId) -> Ty {
    exact_time::unify_times(cx, left, right);
    let (a, b) = (cx.ty_of(left).clone(), cx.ty_of(right).clone());
    match (join(&a, &b), &a, &b) {
        (Ok(ty), ..) => {
            expr::check_angle_unit(cx, left, &ty);
            expr::check_angle_unit(cx, right, &ty);
            ty
        }
        (Err(_), Ty::Real(_), Ty::Real(_)) => {
            let sides = (
                report::measured_value(cx, left),
                report::measured_value(cx, right),
            );
            report::report_diagnostic(
                cx,
                quantity::incompatible_dimensions(op.spelling(), sides.0, sides.1),
            );
            Ty::Unknown
        }
        (Err(misfit), ..) => {
            let wanted = ExpectationReason::Because(cx.span_of(left), format!("this is `{a}`"));
            report::type_mismatch(cx, right, &a, &misfit, &wanted);
            if let TypeMismatchError::Frame { expected, found } = &misfit {
                hint_one_frame(cx, (left, expected), (right, found));
            }
            Ty::Unknown
        }
    }
}

/// Replaces the help of the reported frame mismatch of two operands: either may be in the wrong frame. A misspelt frame
/// has a help of its own.
fn hint_one_frame(cx: &mut Body<'_, '_>, left: (ExprId, &Name), right: (ExprId, &Name)) {
    let (help, place) = (frames::one_frame_help(cx, left, right), cx.span_of(right.0));
    if rpi_diag::suggest(right.1, std::iter::once(left.1.as_str())).is_some() {
        return;
    }
    let reported = cx.diagnostics.last_mut();
    let is_it = |it: &&mut Diagnostic| it.code == Code::RPI2005 && it.span() == place;
    if let Some(diagnostic) = reported.filter(is_it) {
        diagnostic.help = vec![help];
    }
}

/// Returns the type of a twist or wrench that is multiplied or divided by a number. The number must have no unit: the
/// parts of a twist or wrench have different units, and there is no type for their products with a unit.
fn unitless_multiple(cx: &mut Body<'_, '_>, value: ExprId, number: ExprId) -> Ty {
    let ty = cx.ty_of(value).clone();
    let reason = format!("a `{ty}` is scaled by a number without unit");
    let expected = ExpectationReason::Because(cx.span_of(value), reason);
    match statement::expect_type(cx, number, &Ty::REAL, &expected) {
        true => ty,
        false => Ty::Unknown,
    }
}

/// Returns the type of a power of a rotation. The result is a rotation within the frame in which `rotation` is given;
/// it is no longer the orientation of a particular frame. Reports an exponent with a unit.
fn rotation_power_type(cx: &mut Body<'_, '_>, rotation: ExprId, exponent: ExprId) -> Ty {
    let expected = ExpectationReason::Because(Span::NONE, "an exponent has no unit".into());
    if !statement::expect_type(cx, exponent, &Ty::REAL, &expected) {
        return Ty::Unknown;
    }
    match cx.ty_of(rotation) {
        Ty::Spatial(scalar, geometry) => {
            let within = Geometry {
                of: None,
                ..(**geometry).clone()
            };
            Ty::Spatial(*scalar, Rc::new(within))
        }
        other => other.clone(),
    }
}

/// Returns the type of a product or quotient of values of the types `a` and `b`. `combine` multiplies or divides their
/// dimensions and returns `None` if an exponent is out of range, which is reported at `at`.
fn scaled_type(
    cx: &mut Body<'_, '_>,
    a: &Ty,
    b: &Ty,
    combine: fn(Dimension, Dimension) -> Option<Dimension>,
    at: ExprId,
) -> Ty {
    let dims = (dim_of(a), dim_of(b));
    let dim = match dims {
        (Some(a), Some(b)) => combine(a, b),
        _ => None,
    };
    let spatial = [a, b].into_iter().find_map(|ty| match ty {
        Ty::Spatial(scalar, geometry) => Some((*scalar, geometry)),
        _ => None,
    });
    match (spatial, dim) {
        (Some((scalar, geometry)), dim) => {
            let geometry = Geometry {
                dim,
                ..(**geometry).clone()
            };
            Ty::Spatial(scalar, Rc::new(geometry))
        }
        (None, Some(dim)) => Ty::Real(dim),
        (None, None) => {
            let diagnostic = Diagnostic::new(Code::RPI2002, "exponent of a dimension out of range")
                .primary(cx.span_of(at), "too many factors");
            report::report_diagnostic(cx, diagnostic);
            Ty::Unknown
        }
    }
}

fn power_type(cx: &mut Body<'_, '_>, base: &Ty, left: ExprId, right: ExprId) -> Ty {
    statement::expect_type(
        cx,
        right,
        &Ty::REAL,
        &ExpectationReason::Because(Span::NONE, "an exponent has no unit".into()),
    );
    let dim = dim_of(base).unwrap_or(Dimension::ONE);
    if dim.is_dimensionless() {
        return Ty::REAL;
    }
    let exponent = consts::fold_silently(cx, right).and_then(|leaves| leaves.first()?.as_real());
    let power = exponent
        .and_then(Ratio::from_real)
        .and_then(|e| dim.power(e));
    power.map_or_else(
        || {
            let diagnostic = Diagnostic::new(
                Code::RPI2002,
                format!("cannot infer the dimension of a power of `{dim}`"),
            )
            .primary(
                cx.span_of(right),
                "the exponent must be a constant small fraction",
            )
            .secondary(cx.span_of(left), format!("this is in `{dim}`"));
            report::report_diagnostic(cx, diagnostic);
            Ty::Unknown
        },
        Ty::Real,
    )
}

pub(crate) fn equality(
    cx: &mut Body<'_, '_>,
    op: BinaryOp,
    left: ExprId,
    right: ExprId,
    span: Span,
) -> ExprId {
    let ty = common_operand_type(cx, op, left, right);
    if matches!(ty, Ty::Device(_) | Ty::Text) {
        let diagnostic = Diagnostic::new(
            Code::RPI2006,
            format!("`{}` cannot take `{ty}`", op.spelling()),
        )
        .primary(cx.span_of(left), format!("this is `{ty}`"));
        return cx.report_error_expr(diagnostic, span);
    }
    let negated = op == BinaryOp::Ne;
    let operands = [left, right];
    cx.add(TypedKind::Equal { operands, negated }, Ty::Bool, span)
}

/// Whether a comparison is part of a chained comparison `a < b < c`, which the parser has reported.
pub(crate) fn is_chained_comparison(binary: &Binary) -> bool {
    let single = |op: BinaryOp| op.associativity() == Associativity::None;
    match &binary.lhs.kind {
        ExprKind::Binary(inner) => single(binary.op) && single(inner.op),
        _ => false,
    }
}

/// Returns the machine type by which the overloads of an operator are looked up; `None` for enums, results of commands,
/// machine integers and durations, which have rules of their own.
pub(crate) fn operand_scalar(ty: &Ty) -> Option<Scalar> {
    match ty {
        Ty::Enum(_) | Ty::Result | Ty::Machine(_) | Ty::Duration => None,
        other => other.scalar(),
    }
}

/// Returns the physical dimension of a factor, dividend or divisor; `None` if its type has no single dimension.
fn dim_of(ty: &Ty) -> Option<Dimension> {
    match ty {
        Ty::Real(dim) => Some(*dim),
        Ty::Spatial(_, geometry) => geometry.dim,
        Ty::Int => Some(Dimension::ONE),
        _ => None,
    }
}
