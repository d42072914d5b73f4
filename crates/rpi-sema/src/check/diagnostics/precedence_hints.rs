//! Hints for operators whose meaning or precedence differs from other languages.

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::diagnostics::report;
use crate::check::exprs::ops;
use crate::check::signatures::unit;
use crate::program::Lookup;
use crate::ty::Ty;
use crate::typed::ExprId;
use crate::units::is_unit;
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};
use rpi_net::prim;
use rpi_syntax::Name;
use rpi_syntax::ast::{Binary, Expr, ExprKind};
use rpi_syntax::ops::{BinaryOp, UnaryOp};

/// Improves the error about the operands of a binary operator where another operator or parentheses were clearly meant.
/// Returns the result of the operator that was meant; `None` if the error stands.
pub(crate) fn reinterpret_operator(
    cx: &mut Body<'_, '_>,
    binary: &Binary,
    operands: [ExprId; 2],
    span: Span,
) -> Option<ExprId> {
    hint_negated_comparison(cx, binary);
    bitwise_on_booleans(cx, binary, operands, span)
}

/// Whether the index in `x[m]` is probably meant as a unit, because `x` is a number. Only literals and types can have a
/// unit in brackets.
pub(crate) fn is_unit_index(cx: &Body<'_, '_>, base: ExprId, index: &Expr) -> bool {
    unit::reads_rpi_syntax(cx)
        && matches!(cx.ty_of(base), Ty::Int | Ty::Real(_))
        && is_unit_expr(cx, index)
}

fn is_unit_expr(cx: &Body<'_, '_>, expr: &Expr) -> bool {
    let is_free = |name: &Name| {
        let space = crate::program::NameSpace::Value;
        let found = cx.checker.program.lookup_in(space, cx.module, name);
        locals::find_local(cx, name).is_none() && !matches!(found, Lookup::Found(_))
    };
    match &expr.kind {
        ExprKind::Name(name) => is_unit(name) && is_free(name),
        ExprKind::Binary(binary) if matches!(binary.op, BinaryOp::Mul | BinaryOp::Div) => {
            is_unit_expr(cx, &binary.lhs) && is_unit_expr(cx, &binary.rhs)
        }
        _ => false,
    }
}

/// Reports `x[m]`, a unit after an expression that is not a literal, and returns an expression without a value. `base`
/// is `x` and `unit` is `m`.
pub(crate) fn unit_after_flow(
    cx: &mut Body<'_, '_>,
    base: ExprId,
    unit: &Expr,
    span: Span,
) -> ExprId {
    let ty = cx.ty_of(base).clone();
    let (value, unit_text) = (Quote::operand(cx.span_of(base)), Quote::text(unit.span));
    let message = "a unit must follow a number literal or be part of a type";
    let help = match ty {
        Ty::Int => format!("convert it and multiply by one unit: `real {value} * 1[{unit_text}]`"),
        _ => format!(
            "declare it with its unit, `real[{unit_text}]`, or multiply by one unit: `{value} * 1[{unit_text}]`"
        ),
    };
    let diagnostic = Diagnostic::new(Code::RPI2006, message)
        .primary(unit.span, "not an index")
        .secondary(cx.span_of(base), format!("this is `{ty}`"));
    cx.report_error_expr(diagnostic.help(help), span)
}

/// Reports `a && b` between Booleans in Lustre, where `&&` is bitwise. Returns the logical operation in its place;
/// `None` if the operator or an operand is of another kind.
fn bitwise_on_booleans(
    cx: &mut Body<'_, '_>,
    binary: &Binary,
    operands: [ExprId; 2],
    span: Span,
) -> Option<ExprId> {
    let (word, prim) = match binary.op {
        BinaryOp::BitAnd => ("and", prim!("Core::BooleanAnd")),
        BinaryOp::BitOr => ("or", prim!("Core::BooleanOr")),
        _ => return None,
    };
    if operands.iter().any(|id| *cx.ty_of(*id) != Ty::Bool) {
        return None;
    }
    let (sign, place) = (binary.op.spelling(), binary.op_span);
    // Without spaces, as in `a&&b`, the word would join the operands.
    let space = |joined| if joined { " " } else { "" };
    let before = space(binary.lhs.span.end == place.start);
    let after = space(binary.rhs.span.start == place.end);
    let fix = Fix::maybe(format!("write `{word}`"));
    let diagnostic = bitwise_operator(sign, word, place)
        .fix(fix.replace(place, format!("{before}{word}{after}")));
    report::report_diagnostic(cx, diagnostic);
    Some(ops::logical_prim(cx, prim, &operands, span))
}

/// Reports `!a` of a Boolean in Lustre, where `!` is bitwise. Returns the logical negation in its place.
pub(crate) fn bitwise_not_on_boolean(cx: &mut Body<'_, '_>, operand: ExprId, span: Span) -> ExprId {
    let sign = Span {
        end: span.start + 1,
        ..span
    };
    let fix = Fix::maybe("write `not`").replace(sign, "not ");
    report::report_diagnostic(cx, bitwise_operator("!", "not", sign).fix(fix));
    ops::logical_prim(cx, prim!("Core::BooleanNot"), &[operand], span)
}

/// Adds a fix to the reported error about `not i = j`, where `not` binds tighter than the comparison `=`. Other
/// comparisons are treated in the same way.
fn hint_negated_comparison(cx: &mut Body<'_, '_>, binary: &Binary) {
    use BinaryOp::{Eq, Ge, Gt, Le, Lt, Ne};
    let ExprKind::Unary(UnaryOp::Not, operand) = &binary.lhs.kind else {
        return;
    };
    if !matches!(binary.op, Eq | Ge | Gt | Le | Lt | Ne) {
        return;
    }
    let place = operand.span;
    let mut latest_first = cx.diagnostics.iter_mut().rev();
    let is_about = |error: &&mut Diagnostic| error.code == Code::RPI2006 && error.span() == place;
    if let Some(error) = latest_first.find(is_about) {
        let fix = Fix::maybe("negate the comparison")
            .insert_before(place, "(")
            .insert_after(binary.rhs.span, ")");
        // The advice to compare the operand with 0 would be for another expression.
        error.help = vec![format!(
            "`not` binds tighter than comparisons: write `not ({} {} {})`",
            Quote::operand(place),
            binary.op.spelling(),
            Quote::operand(binary.rhs.span)
        )];
        error.fixes.push(fix);
    }
}

/// Returns the diagnostic for the bitwise operator `sign` between Booleans. `word` is the logical operator that was
/// meant.
fn bitwise_operator(sign: &str, word: &str, span: Span) -> Diagnostic {
    let message = format!("`{sign}` works on the bits of machine integers, not on Booleans");
    Diagnostic::new(Code::RPI2006, message).primary(span, format!("expected `{word}`"))
}
