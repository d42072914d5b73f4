//! Operators on two operands of one type, and the hint for `a ?? b = c`, which is parsed as `a ?? (b = c)`.

use super::body::Body;
use super::ops::TESTS;
use crate::typed::{Each, ExprId, Kind};
use rpi_diag::{Fix, Span};
use rpi_syntax::ast::{Binary, ExprKind};
use rpi_syntax::ops::BinaryOp;

impl<'a> Body<'_, 'a> {
    /// Checks an operator that works leaf by leaf on two operands of one type.
    pub(super) fn each_of_two(&mut self, each: Each, binary: &'a Binary, span: Span) -> ExprId {
        let (left, right) = (self.expr(&binary.lhs), self.expr(&binary.rhs));
        let before = self.findings.len();
        let ty = self.common_type(left, right, "both sides must have the same type");
        if self.has_error_since(before) && self.compares_too_early(binary) {
            return self.fault(span);
        }
        self.add(Kind::Each(each, [left, right].into()), ty, span)
    }

    /// Adds the missing parentheses to the reported diagnostic about `a ?? b = c`; returns `false` for any other
    /// expression.
    fn compares_too_early(&mut self, binary: &Binary) -> bool {
        let ExprKind::Binary(compared) = &binary.rhs.kind else {
            return false;
        };
        let is_open = compared.lhs.span.start == binary.rhs.span.start;
        let is_test =
            matches!(compared.op, BinaryOp::Eq | BinaryOp::Ne) || TESTS.contains(&compared.op);
        if !is_test || !is_open {
            return false;
        }
        let (op, test) = (binary.op.spelling(), compared.op.spelling());
        // The caller has just reported the type mismatch, so that it is the last diagnostic.
        if let Some(told) = self.findings.last_mut() {
            told.help = vec![format!(
                "`{test}` binds tighter than `{op}`: write `(a {op} b) {test} c`"
            )];
            told.fixes = vec![
                Fix::maybe("add parentheses")
                    .insert_before(binary.lhs.span, "(")
                    .insert_after(compared.lhs.span, ")"),
            ];
        }
        true
    }
}
