//! Parentheses that are required for a printed tree to parse back unchanged, by the table of operators.

use crate::ast::{Expr, ExprKind};
use crate::ops::{
    Associativity, BinaryOp, PRECEDENCE_IF, PRECEDENCE_PRIMARY, PRECEDENCE_WHEN, Precedence,
    UnaryOp,
};

/// Returns the precedence level of the outermost operator of an expression.
pub(super) fn level(expr: &Expr) -> Precedence {
    match &expr.kind {
        ExprKind::If(_) | ExprKind::Quantified(_) => PRECEDENCE_IF,
        ExprKind::Binary(binary) => binary.op.precedence(),
        ExprKind::Unary(op, _) => op.precedence(),
        ExprKind::When(_) => PRECEDENCE_WHEN,
        _ => PRECEDENCE_PRIMARY,
    }
}

/// Returns whether an expression needs parentheses as the left operand of `op`.
pub(super) fn left(op: BinaryOp, lhs: &Expr) -> bool {
    let groups_left = op.associativity() == Associativity::Left;
    before(op.precedence(), groups_left, lhs)
}

/// Returns whether an expression needs parentheses as the sampled value, left of `when`.
pub(super) fn sampled(value: &Expr) -> bool {
    before(PRECEDENCE_WHEN, true, value)
}

/// Returns whether an expression needs parentheses as the right operand of `op`.
pub(super) fn right(op: BinaryOp, rhs: &Expr) -> bool {
    if is_prefix(rhs) {
        return false;
    }
    let groups_right = op.associativity() == Associativity::Right;
    level(rhs) < op.precedence() || level(rhs) == op.precedence() && !groups_right
}

/// Returns whether an expression needs parentheses as the operand of a unary operator.
pub(super) fn operand(op: UnaryOp, operand: &Expr) -> bool {
    let looks_else = match op {
        // `--` would begin a comment.
        UnaryOp::Neg => begins_with_minus(operand),
        // `current -x` would be a difference, `current [x]` an element of an array.
        UnaryOp::Current => begins_with_minus(operand) || begins_with_bracket(operand),
        _ => false,
    };
    looks_else || !is_prefix(operand) && level(operand) < op.precedence()
}

/// Returns whether an expression needs parentheses before `.f` or `[i]`.
pub(super) fn base(base: &Expr) -> bool {
    use ExprKind::{Bool, Merge, Number, Quantity, Str};
    let literal = matches!(
        base.kind,
        Bool(_) | Number(_) | Quantity(_) | Str(_) | Merge(_)
    );
    literal || level(base) < PRECEDENCE_PRIMARY
}

/// Returns whether an expression before an operator of this precedence level needs parentheses.
fn before(op: Precedence, groups_left: bool, expr: &Expr) -> bool {
    let weaker = !is_prefix(expr) && (level(expr) < op || level(expr) == op && !groups_left);
    weaker || trailing_level(expr) <= op
}

/// Returns whether the root of an expression is a prefix operator or an `if`.
fn is_prefix(expr: &Expr) -> bool {
    matches!(expr.kind, ExprKind::Unary(..) | ExprKind::If(_))
}

/// Returns the lowest precedence level of an operator whose last operand ends with the expression.
///
/// Such an operand would also absorb a following operator of higher precedence.
fn trailing_level(expr: &Expr) -> Precedence {
    match &expr.kind {
        ExprKind::If(_) => PRECEDENCE_IF,
        ExprKind::Unary(op, inner) if operand(*op, inner) => op.precedence(),
        ExprKind::Unary(op, inner) => op.precedence().min(trailing_level(inner)),
        ExprKind::Binary(binary) if right(binary.op, &binary.rhs) => PRECEDENCE_PRIMARY,
        ExprKind::Binary(binary) => trailing_level(&binary.rhs),
        _ => PRECEDENCE_PRIMARY,
    }
}

fn begins_with_minus(expr: &Expr) -> bool {
    matches!(first(expr).kind, ExprKind::Unary(UnaryOp::Neg, _))
}

fn begins_with_bracket(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Array(_) | ExprKind::EmptySet(_) => true,
        ExprKind::Index(index) => begins_with_bracket(&index.base),
        ExprKind::Slice(slice) => begins_with_bracket(&slice.base),
        ExprKind::Field(field) => begins_with_bracket(&field.base),
        ExprKind::BitRange(of) => begins_with_bracket(&of.base),
        ExprKind::Update(update) => update.is_keyed && begins_with_bracket(&update.base),
        _ => false,
    }
}

/// Returns whether the expression begins with a string literal, which would be a label after `assert`.
pub(super) fn begins_with_text(expr: &Expr) -> bool {
    matches!(first(expr).kind, ExprKind::Str(_))
}

/// Returns the subexpression with the first token of the printed expression.
fn first(expr: &Expr) -> &Expr {
    match &expr.kind {
        ExprKind::Binary(binary) if !left(binary.op, &binary.lhs) => first(&binary.lhs),
        ExprKind::When(when) if !sampled(&when.value) => first(&when.value),
        _ => expr,
    }
}
