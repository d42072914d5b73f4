//! Operators on two operands of one type, and the hint for `a ?? b = c`, which is parsed as `a ?? (b = c)`.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::exprs::expr;
use crate::check::exprs::ops::ORDERINGS;
use crate::typed::ExprId;
use crate::typed::{ElementwiseOp, TypedKind};
use rpi_diag::{Fix, Span};
use rpi_syntax::ast::{Binary, ExprKind};
use rpi_syntax::ops::BinaryOp;

/// Checks an operator that is applied separately to each leaf (scalar part) of two operands of one type.
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

/// Adds the missing parentheses to the reported diagnostic about `a ?? b = c`; returns `false` for any other
/// expression.
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
        diagnostic.help = vec![format!(
            "`{test}` binds tighter than `{op}`: write `(a {op} b) {test} c`"
        )];
        diagnostic.fixes = vec![
            Fix::maybe("add parentheses")
                .insert_before(binary.lhs.span, "(")
                .insert_after(compared.lhs.span, ")"),
        ];
    }
    true
}
