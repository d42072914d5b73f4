//! Hints for operators whose meaning or precedence differs from other languages.

use super::body::Body;
use crate::program::Lookup;
use crate::ty::Ty;
use crate::typed::ExprId;
use crate::units::is_unit;
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_net::prim;
use rpi_syntax::Name;
use rpi_syntax::ast::{Binary, Expr, ExprKind};
use rpi_syntax::ops::{BinaryOp, UnaryOp};

impl Body<'_, '_> {
    /// Handles operands for which another operator was clearly meant; returns the result of that operator if there is
    /// one.
    pub(super) fn misread(
        &mut self,
        binary: &Binary,
        operands: [ExprId; 2],
        span: Span,
    ) -> Option<ExprId> {
        self.negated_operand(binary);
        self.bits_of_booleans(binary, operands, span)
    }

    /// Whether `x[m]` is probably meant to give a number a unit. Only literals and types have units.
    pub(super) fn is_meant_as_unit(&self, base: ExprId, index: &Expr) -> bool {
        self.is_rpi()
            && matches!(self.ty_of(base), Ty::Int | Ty::Real(_))
            && self.is_of_units(index)
    }

    fn is_of_units(&self, expr: &Expr) -> bool {
        let is_free = |name: &Name| {
            let space = crate::program::Space::Value;
            let found = self.c.program.lookup_in(space, self.module, name);
            self.find_local(name).is_none() && !matches!(found, Lookup::Found(_))
        };
        match &expr.kind {
            ExprKind::Name(name) => is_unit(name) && is_free(name),
            ExprKind::Binary(binary) if matches!(binary.op, BinaryOp::Mul | BinaryOp::Div) => {
                self.is_of_units(&binary.lhs) && self.is_of_units(&binary.rhs)
            }
            _ => false,
        }
    }

    /// Reports `x[m]`, a unit after an expression that is not a literal.
    pub(super) fn unit_behind_a_flow(&mut self, base: ExprId, unit: &Expr, span: Span) -> ExprId {
        let ty = self.ty_of(base).clone();
        let message = "a unit must follow a number literal or be part of a type";
        let help = match ty {
            Ty::Int => "convert it and multiply by one unit: `real x * 1[m]`",
            _ => {
                "declare the flow with its unit, `x: real[m]`, or multiply by one unit: `x * 1[m]`"
            }
        };
        let finding = Finding::new(Code::RPI2006, message)
            .at(unit.span, "not an index")
            .also(self.span_of(base), format!("this is `{ty}`"));
        self.fault_with(finding.help(help), span)
    }

    /// Reports `a && b` between Booleans in Lustre, where the operator is bitwise; returns the logical operation
    /// instead.
    fn bits_of_booleans(
        &mut self,
        binary: &Binary,
        operands: [ExprId; 2],
        span: Span,
    ) -> Option<ExprId> {
        let (word, prim) = match binary.op {
            BinaryOp::BitAnd => ("and", prim!("Core::BooleanAnd")),
            BinaryOp::BitOr => ("or", prim!("Core::BooleanOr")),
            _ => return None,
        };
        if operands.iter().any(|id| *self.ty_of(*id) != Ty::Bool) {
            return None;
        }
        let (sign, place) = (binary.op.spelling(), binary.op_span);
        // Without spaces, as in `a&&b`, the word would join the operands.
        let space = |joined| if joined { " " } else { "" };
        let before = space(binary.lhs.span.end == place.start);
        let after = space(binary.rhs.span.start == place.end);
        let fix = Fix::maybe(format!("write `{word}`"));
        let finding =
            of_bits(sign, word, place).fix(fix.replace(place, format!("{before}{word}{after}")));
        self.report(finding);
        Some(self.logic(prim, &operands, span))
    }

    /// Reports `!a` of a Boolean in Lustre, where the operator is bitwise; returns the logical negation instead.
    pub(super) fn bits_of_boolean(&mut self, operand: ExprId, span: Span) -> ExprId {
        let sign = Span {
            end: span.start + 1,
            ..span
        };
        let fix = Fix::maybe("write `not`").replace(sign, "not ");
        self.report(of_bits("!", "not", sign).fix(fix));
        self.logic(prim!("Core::BooleanNot"), &[operand], span)
    }

    /// Adds a fix to the error of `not i = j`, where `not` binds tighter than the comparison.
    fn negated_operand(&mut self, binary: &Binary) {
        use BinaryOp::{Eq, Ge, Gt, Le, Lt, Ne};
        let ExprKind::Unary(UnaryOp::Not, operand) = &binary.lhs.kind else {
            return;
        };
        if !matches!(binary.op, Eq | Ge | Gt | Le | Lt | Ne) {
            return;
        }
        let place = operand.span;
        let mut told = self.findings.iter_mut().rev();
        let told = told.find(|told| told.code == Code::RPI2006 && told.span() == place);
        if let Some(told) = told {
            let fix = Fix::maybe("negate the comparison")
                .insert_before(place, "(")
                .insert_after(binary.rhs.span, ")");
            *told = told
                .clone()
                .help("`not` binds tighter than comparisons: write `not (a = b)`")
                .fix(fix);
        }
    }
}

/// Returns the diagnostic for a bitwise operator between Booleans.
fn of_bits(sign: &str, word: &str, span: Span) -> Finding {
    let message = format!("expected `{word}` between Booleans, found `{sign}`");
    Finding::new(Code::RPI2006, message).at(span, "bitwise operator of machine integers")
}
