//! Prints chains of operators and conditionals, which may be broken over several lines.

use super::layout::{Doc, concat, word};
use super::list;
use super::{Printer, parens};
use crate::ast::*;
use crate::ops::{Associativity, BinaryOp};
use crate::print::expr;

/// Prints a chain of operators of one precedence level: `a and b and c`. The line breaks before all operators or before
/// none.
pub(crate) fn chain(printer: &Printer<'_>, binary: &Binary) -> Doc {
    if binary.op == BinaryOp::Repeat {
        return expr::array_repeat(printer, binary);
    }
    let links = links(binary);
    list::print_phrases(printer, &links, |p, _, link| {
        let operand = expr::wrapped(p, link.operand, link.parens);
        match link.op {
            Some(op) => concat([word(op.spelling()), word(" "), operand]),
            None => operand,
        }
    })
}

/// Prints a chain of conditional expressions: `if a then x else if b then y else z`. The line breaks before all
/// branches after the first, or before none.
pub(crate) fn print_conditional(printer: &Printer<'_>, conditional: &IfExpr) -> Doc {
    let branches = branches(conditional);
    list::print_phrases(printer, &branches, |p, _, branch| match branch {
        ConditionalBranch::If {
            head,
            condition,
            yes,
        } => concat([
            word(head),
            expr::print_expr(p, condition),
            word(" then "),
            expr::print_expr(p, yes),
        ]),
        ConditionalBranch::Else(no) => concat([word("else "), expr::print_expr(p, no)]),
    })
}

/// Operand in a chain of operators, with the operator before it (`None` for the first operand) and whether it needs
/// parentheses.
struct ChainOperand<'e> {
    op: Option<BinaryOp>,
    operand: &'e Expr,
    parens: bool,
}

/// Returns the operands, from left to right, of the chain of operators of one precedence level that begins at `binary`.
fn links(binary: &Binary) -> Vec<ChainOperand<'_>> {
    match binary.op.associativity() {
        Associativity::Right => links_to_right(binary),
        Associativity::Left | Associativity::None => links_to_left(binary),
    }
}

fn links_to_left(mut binary: &Binary) -> Vec<ChainOperand<'_>> {
    let mut links = Vec::new();
    loop {
        let (op, lhs) = (binary.op, &binary.lhs);
        links.push(ChainOperand {
            op: Some(op),
            operand: &binary.rhs,
            parens: parens::right(op, &binary.rhs),
        });
        match &lhs.kind {
            ExprKind::Binary(inner)
                if inner.op.precedence() == op.precedence() && !parens::left(op, lhs) =>
            {
                binary = inner
            }
            _ => {
                let parens = parens::left(op, lhs);
                links.push(ChainOperand {
                    op: None,
                    operand: lhs,
                    parens,
                });
                links.reverse();
                return links;
            }
        }
    }
}

fn links_to_right(mut binary: &Binary) -> Vec<ChainOperand<'_>> {
    let mut links = Vec::new();
    let mut before = None;
    loop {
        let (op, rhs) = (binary.op, &binary.rhs);
        let parens = parens::left(op, &binary.lhs);
        links.push(ChainOperand {
            op: before,
            operand: &binary.lhs,
            parens,
        });
        before = Some(op);
        match &rhs.kind {
            ExprKind::Binary(inner) if inner.op.precedence() == op.precedence() => binary = inner,
            _ => {
                let parens = parens::right(op, rhs);
                links.push(ChainOperand {
                    op: before,
                    operand: rhs,
                    parens,
                });
                return links;
            }
        }
    }
}

/// Branch in a chain of conditional expressions: `if c then x` or `else if c then x`, or the final `else y`.
enum ConditionalBranch<'e> {
    If {
        head: &'static str,
        condition: &'e Expr,
        yes: &'e Expr,
    },
    Else(&'e Expr),
}

fn branches(mut conditional: &IfExpr) -> Vec<ConditionalBranch<'_>> {
    let mut branches = Vec::new();
    loop {
        branches.push(ConditionalBranch::If {
            head: match (branches.is_empty(), conditional.is_static) {
                (true, false) => "if ",
                (true, true) => "with ",
                (false, false) => "else if ",
                (false, true) => "else with ",
            },
            condition: &conditional.condition,
            yes: &conditional.then_value,
        });
        match &conditional.else_value.kind {
            ExprKind::If(inner) => conditional = inner,
            _ => {
                branches.push(ConditionalBranch::Else(&conditional.else_value));
                return branches;
            }
        }
    }
}
