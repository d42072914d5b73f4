//! Operators on two operands of one type, and the hint for `a ?? b = c`, which is parsed as `a ?? (b = c)`.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::exprs::expr;
use crate::check::exprs::ops::ORDERINGS;
use crate::typed::ExprId;
use crate::typed::{ElementwiseOp, TypedKind};
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};
use rpi_syntax::ast::{Binary, ExprKind};
use rpi_syntax::ops::BinaryOp;

/// Checks a binary operator that is applied separately to each leaf (scalar part) of two operands of one type, and
/// returns its typed expression.
pub(crate) fn elementwise_binary<'a>(
    cx: &mut Body<'_, 'a>,
    each: ElementwiseOp,
    binary: &'a Binary,
    span: Span,
) -> ExprId {
    let (left, right) = (
        expr::check_expr(cx, &binary.lhs),
        expr::check_expr(cx, &binary.rhs),
    );
    let before = cx.diagnostics.len();
    let ty = expr::common_type(cx, left, right, "both sides must have the same type");
    if report::has_error_since(cx, before) && hint_comparison_precedence(cx, binary) {
        return cx.error_expr(span);
    }
    cx.add(TypedKind::Each(each, [left, right].into()), ty, span)
}

/// Adds a fix with the missing parentheses to the diagnostic that has just been reported about `a ?? b = c`, which is
/// parsed as `a ?? (b = c)`. Returns whether the expression has this form.
fn hint_comparison_precedence(cx: &mut Body<'_, '_>, binary: &Binary) -> bool {
    let ExprKind::Binary(compared) = &binary.rhs.kind else {
        return false;
    };
    let is_open = compared.lhs.span.start == binary.rhs.span.start;
    let is_test =
        matches!(compared.op, BinaryOp::Eq | BinaryOp::Ne) || ORDERINGS.contains(&compared.op);
    if !is_test || !is_open {
        return false;
    }
    let (op, test) = (binary.op.spelling(), compared.op.spelling());
    // The caller has just reported the type mismatch, so that it is the last diagnostic.
    if let Some(diagnostic) = cx.diagnostics.last_mut() {
        let help = format!(
            "`{test}` binds tighter than `{op}`: write `({} {op} {}) {test} {}`",
            Quote::operand(binary.lhs.span),
            Quote::operand(compared.lhs.span),
            Quote::operand(compared.rhs.span)
        );
        advise_parentheses(diagnostic, help, (binary.lhs.span, compared.lhs.span));
    }
    true
}

/// Replaces the help and the fixes of a diagnostic by the advice to write parentheses from the first to the last of two
/// expressions.
fn advise_parentheses(diagnostic: &mut Diagnostic, help: String, (first, last): (Span, Span)) {
    diagnostic.help = vec![help];
    diagnostic.fixes = vec![
        Fix::maybe("add parentheses")
            .insert_before(first, "(")
            .insert_after(last, ")"),
    ];
}

/// Adds the missing parentheses to the reported size mismatch of `a -> b | c`, which is parsed as `(a -> b) | c`.
pub(crate) fn hint_concat_precedence(cx: &mut Body<'_, '_>, concat: &Binary) {
    let ExprKind::Binary(inner) = &concat.lhs.kind else {
        return;
    };
    let is_delay = matches!(inner.op, BinaryOp::Arrow | BinaryOp::Fby);
    // The check of the left side has just reported the mismatch, so that it is the last diagnostic.
    let mismatch = cx.diagnostics.last_mut();
    let is_about = |diagnostic: &&mut Diagnostic| {
        diagnostic.code == Code::RPI2009 && diagnostic.span() == inner.rhs.span
    };
    if let Some(diagnostic) = mismatch.filter(|it| is_delay && is_about(it)) {
        let op = inner.op.spelling();
        let help = format!(
            "`{op}` binds tighter than `|`: write `{} {op} ({} | {})`",
            Quote::text(inner.lhs.span),
            Quote::text(inner.rhs.span),
            Quote::text(concat.rhs.span)
        );
        advise_parentheses(diagnostic, help, (inner.rhs.span, concat.rhs.span));
    }
}
