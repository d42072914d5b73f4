//! Groups a flat chain of operators and operands by operator precedence.
//!
//! The grammar delivers `a + b * c` piece by piece. Operators whose right operand is incomplete wait on a stack. They
//! are applied when an operator of lower precedence follows (operator-precedence parsing).

use crate::ast::{Binary, Clock, Expr, ExprKind, Ident, If, Quantified, StaticArg, VarDecl, When};
use crate::context::Context;
use crate::ops::{BinaryOp, Grouping, LEVEL_IF, LEVEL_WHEN, Level, UnaryOp};
use rpi_diag::Span;

/// Prefix of an operand: unary operator, conversion, conditional or quantifier.
pub(crate) enum Prefix {
    Unary(UnaryOp),
    /// `int8 x`: the target type and its static arguments (the width of `sint@<25>`).
    Convert(Ident, Vec<StaticArg>),
    /// `if c then x else`: whether it is static (`with`), the condition, and the first branch.
    If(Box<(bool, Expr, Expr)>),
    /// `forall (x: int)`: whether it is `forall` (not `exists`), and the bound variables.
    Quantifier(bool, Vec<VarDecl>),
}

/// Operand with its prefixes and their start offsets, outermost last.
pub(crate) struct Term {
    prefixes: Vec<(Prefix, u32)>,
    operand: Expr,
}

impl Term {
    pub(crate) fn operand(operand: Expr) -> Term {
        Term {
            prefixes: Vec::new(),
            operand,
        }
    }

    /// Adds an outer prefix that begins at the byte offset `start`.
    pub(crate) fn prefixed(mut self, prefix: Prefix, start: u32) -> Term {
        self.prefixes.push((prefix, start));
        self
    }
}

/// Expression under construction, whose end has not been reached.
pub(crate) struct Chain {
    waiting: Vec<Waiting>,
    last: Expr,
}

/// Operator whose right operand is incomplete.
enum Waiting {
    Binary { lhs: Expr, op: BinaryOp, span: Span },
    Prefix(Prefix, u32),
}

impl Waiting {
    fn level(&self) -> Level {
        match self {
            Waiting::Binary { op, .. } => op.level(),
            Waiting::Prefix(Prefix::Unary(op), _) => op.level(),
            Waiting::Prefix(Prefix::Convert(..), _) => UnaryOp::ToInt.level(),
            Waiting::Prefix(Prefix::If(_) | Prefix::Quantifier(..), _) => LEVEL_IF,
        }
    }
}

impl Chain {
    pub(crate) fn new(term: Term) -> Chain {
        let chain = Chain {
            waiting: Vec::new(),
            last: term.operand,
        };
        chain.open(term.prefixes)
    }

    /// Appends `op term`. `span` is the place of the operator.
    pub(crate) fn push(mut self, cx: &Context<'_>, op: BinaryOp, span: Span, term: Term) -> Chain {
        if let ExprKind::When(_) = self.last.kind {
            cx.note_sampled_part(self.last.span);
        }
        self.apply_stronger_than(cx, op, span);
        let lhs = std::mem::replace(&mut self.last, term.operand);
        self.waiting.push(Waiting::Binary { lhs, op, span });
        self.open(term.prefixes)
    }

    /// Appends `when clock`.
    pub(crate) fn when(mut self, cx: &Context<'_>, clock: Clock) -> Chain {
        self.apply_while(cx, |waiting| waiting.level() > LEVEL_WHEN);
        let span = self.last.span.merge(clock.span);
        let value = std::mem::replace(&mut self.last, Expr::bool(false));
        let kind = ExprKind::When(Box::new(When { value, clock }));
        self.last = Expr { kind, span };
        if !self.waiting.is_empty() {
            cx.note_sampled_part(span);
        }
        self
    }

    /// Applies all waiting operators and returns the expression.
    pub(crate) fn finish(mut self, cx: &Context<'_>) -> Expr {
        self.apply_while(cx, |_| true);
        self.last
    }

    fn open(mut self, prefixes: Vec<(Prefix, u32)>) -> Chain {
        let outermost_first = prefixes.into_iter().rev();
        self.waiting
            .extend(outermost_first.map(|(prefix, start)| Waiting::Prefix(prefix, start)));
        self
    }

    /// Applies the waiting operators of higher precedence than `op`, and those of equal precedence unless `op` is
    /// right-associative. Reports chained comparisons.
    fn apply_stronger_than(&mut self, cx: &Context<'_>, op: BinaryOp, span: Span) {
        self.apply_while(cx, |waiting| waiting.level() > op.level());
        if let (
            Grouping::None,
            Some(Waiting::Binary {
                op: other,
                span: at,
                ..
            }),
        ) = (op.grouping(), self.waiting.last())
            && other.level() == op.level()
        {
            // Only `a < b < c` has an obvious correction, `a < b and b < c`; `a = b = c` has none.
            let is_order = other.is_order() && op.is_order();
            cx.comparisons_in_a_row([*at, span], is_order.then_some(self.last.span));
        }
        if op.grouping() != Grouping::Right {
            self.apply_while(cx, |waiting| waiting.level() == op.level());
        }
    }

    fn apply_while(&mut self, cx: &Context<'_>, holds: impl Fn(&Waiting) -> bool) {
        while let Some(waiting) = self.waiting.pop_if(|waiting| holds(waiting)) {
            let rhs = std::mem::replace(&mut self.last, Expr::bool(false));
            self.last = applied(cx, waiting, rhs);
        }
    }
}

/// Applies a waiting operator to its right operand.
fn applied(cx: &Context<'_>, waiting: Waiting, rhs: Expr) -> Expr {
    match waiting {
        Waiting::Binary { lhs, op, span } => {
            let whole = lhs.span.merge(rhs.span);
            if op == BinaryOp::Pow && matches!(lhs.kind, ExprKind::Unary(UnaryOp::Neg, _)) {
                cx.note_signed_base(lhs.span, rhs.span);
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
        Waiting::Prefix(prefix, start) => prefixed(cx, prefix, start, rhs),
    }
}

fn prefixed(cx: &Context<'_>, prefix: Prefix, start: u32, operand: Expr) -> Expr {
    let span = cx.span(start, operand.span.end);
    let kind = match prefix {
        Prefix::Convert(to, bits) => return cx.converted(start, to, bits, operand),
        Prefix::Unary(op) => ExprKind::Unary(op, Box::new(operand)),
        Prefix::Quantifier(for_all, vars) => ExprKind::Quantified(Box::new(Quantified {
            for_all,
            vars,
            condition: operand,
        })),
        Prefix::If(parts) => {
            let (is_static, condition, yes) = *parts;
            ExprKind::If(Box::new(If {
                is_static,
                condition,
                yes,
                no: operand,
            }))
        }
    };
    Expr { kind, span }
}
