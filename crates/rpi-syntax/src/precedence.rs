//! Groups a flat chain of operators and operands by operator precedence.
//!
//! The grammar delivers `a + b * c` piece by piece. Operators whose right operand is incomplete wait on a stack. They
//! are applied when an operator of lower precedence follows (operator-precedence parsing).

use crate::actions::calls;
use crate::ast::{
    Binary, Clock, Expr, ExprKind, Ident, IfExpr, Quantified, StaticArg, VarDecl, WhenExpr,
};
use crate::context::ParseContext;
use crate::ops::{Associativity, BinaryOp, PRECEDENCE_IF, PRECEDENCE_WHEN, Precedence, UnaryOp};
use rpi_diag::Span;

/// Prefix of an operand: unary operator, conversion, `if ... else` or quantifier.
pub(crate) enum Prefix {
    Unary(UnaryOp),
    /// `int8 x`: the type of the result and its static arguments (the width of `sint@<25>`).
    Conversion(Ident, Vec<StaticArg>),
    /// `if c then x else`: true if it is written `with` (evaluated at compile time), then the condition and the value
    /// if it is true.
    If(Box<(bool, Expr, Expr)>),
    /// `forall (x: int)`: true for `forall`, false for `exists`; and the bound variables.
    Quantifier(bool, Vec<VarDecl>),
}

/// Operand with its prefixes, outermost last, each with the byte offset of its start.
pub(crate) struct Term {
    prefixes: Vec<(Prefix, u32)>,
    operand: Expr,
}

impl Term {
    pub(crate) fn from_operand(operand: Expr) -> Term {
        Term {
            prefixes: Vec::new(),
            operand,
        }
    }

    /// Adds a prefix around the operand and its present prefixes. The prefix begins at the byte offset `start`.
    pub(crate) fn with_prefix(mut self, prefix: Prefix, start: u32) -> Term {
        self.prefixes.push((prefix, start));
        self
    }
}

/// Expression that is being built from operands and operators by operator precedence.
pub(crate) struct Chain {
    pending: Vec<PendingOperator>,
    last_operand: Expr,
}

/// Operator whose right operand may still grow.
enum PendingOperator {
    Binary { lhs: Expr, op: BinaryOp, span: Span },
    Prefix(Prefix, u32),
}

impl PendingOperator {
    fn level(&self) -> Precedence {
        match self {
            PendingOperator::Binary { op, .. } => op.precedence(),
            PendingOperator::Prefix(Prefix::Unary(op), _) => op.precedence(),
            PendingOperator::Prefix(Prefix::Conversion(..), _) => UnaryOp::ToInt.precedence(),
            PendingOperator::Prefix(Prefix::If(_) | Prefix::Quantifier(..), _) => PRECEDENCE_IF,
        }
    }
}

impl Chain {
    pub(crate) fn new(term: Term) -> Chain {
        let chain = Chain {
            pending: Vec::new(),
            last_operand: term.operand,
        };
        chain.push_prefixes(term.prefixes)
    }

    /// Appends an operator and its right operand. `span` is the place of the operator.
    pub(crate) fn push(
        mut self,
        cx: &ParseContext<'_>,
        op: BinaryOp,
        span: Span,
        term: Term,
    ) -> Chain {
        if let ExprKind::When(_) = self.last_operand.kind {
            cx.warn_sampled_operand(self.last_operand.span);
        }
        self.apply_stronger_than(cx, op, span);
        let lhs = std::mem::replace(&mut self.last_operand, term.operand);
        self.pending.push(PendingOperator::Binary { lhs, op, span });
        self.push_prefixes(term.prefixes)
    }

    /// Appends a sampling operator: `when clock`.
    pub(crate) fn push_when(mut self, cx: &ParseContext<'_>, clock: Clock) -> Chain {
        self.apply_while(cx, |waiting| waiting.level() > PRECEDENCE_WHEN);
        let span = self.last_operand.span.merge(clock.span);
        let value = std::mem::replace(&mut self.last_operand, Expr::bool(false));
        let kind = ExprKind::When(Box::new(WhenExpr { value, clock }));
        self.last_operand = Expr { kind, span };
        if !self.pending.is_empty() {
            cx.warn_sampled_operand(span);
        }
        self
    }

    /// Applies all pending operators and returns the whole expression.
    pub(crate) fn finish(mut self, cx: &ParseContext<'_>) -> Expr {
        self.apply_while(cx, |_| true);
        self.last_operand
    }

    fn push_prefixes(mut self, prefixes: Vec<(Prefix, u32)>) -> Chain {
        let outermost_first = prefixes.into_iter().rev();
        self.pending
            .extend(outermost_first.map(|(prefix, start)| PendingOperator::Prefix(prefix, start)));
        self
    }

    /// Applies the pending operators of higher precedence than `op`, and those of equal precedence unless `op` is
    /// right-associative. Reports chained comparisons such as `a < b < c`. `span` is the place of `op`.
    fn apply_stronger_than(&mut self, cx: &ParseContext<'_>, op: BinaryOp, span: Span) {
        self.apply_while(cx, |waiting| waiting.level() > op.precedence());
        if let (
            Associativity::None,
            Some(PendingOperator::Binary {
                op: other,
                span: at,
                ..
            }),
        ) = (op.associativity(), self.pending.last())
            && other.precedence() == op.precedence()
        {
            // Only `a < b < c` has an obvious correction, `a < b and b < c`; `a = b = c` has none.
            let is_order = other.is_ordering() && op.is_ordering();
            cx.report_chained_comparison([*at, span], is_order.then_some(self.last_operand.span));
        }
        if op.associativity() != Associativity::Right {
            self.apply_while(cx, |waiting| waiting.level() == op.precedence());
        }
    }

    fn apply_while(&mut self, cx: &ParseContext<'_>, holds: impl Fn(&PendingOperator) -> bool) {
        while let Some(waiting) = self.pending.pop_if(|waiting| holds(waiting)) {
            let rhs = std::mem::replace(&mut self.last_operand, Expr::bool(false));
            self.last_operand = apply_operator(cx, waiting, rhs);
        }
    }
}

/// Returns the expression of a pending operator with its right operand.
fn apply_operator(cx: &ParseContext<'_>, waiting: PendingOperator, rhs: Expr) -> Expr {
    match waiting {
        PendingOperator::Binary { lhs, op, span } => {
            let whole = lhs.span.merge(rhs.span);
            if op == BinaryOp::Pow && matches!(lhs.kind, ExprKind::Unary(UnaryOp::Neg, _)) {
                cx.warn_sign_before_power(lhs.span, rhs.span);
            }
            let binary = Binary {
                op,
                op_span: span,
                lhs,
                rhs,
            };
            Expr {
                kind: ExprKind::Binary(Box::new(binary)),
                span: whole,
            }
        }
        PendingOperator::Prefix(prefix, start) => prefixed(cx, prefix, start, rhs),
    }
}

fn prefixed(cx: &ParseContext<'_>, prefix: Prefix, start: u32, operand: Expr) -> Expr {
    let span = cx.span(start, operand.span.end);
    let kind = match prefix {
        Prefix::Conversion(to, bits) => return calls::conversion(cx, start, to, bits, operand),
        Prefix::Unary(op) => ExprKind::Unary(op, Box::new(operand)),
        Prefix::Quantifier(for_all, vars) => ExprKind::Quantified(Box::new(Quantified {
            is_forall: for_all,
            vars,
            condition: operand,
        })),
        Prefix::If(parts) => {
            let (is_static, condition, yes) = *parts;
            ExprKind::If(Box::new(IfExpr {
                is_static,
                condition,
                then_value: yes,
                else_value: operand,
            }))
        }
    };
    Expr { kind, span }
}
