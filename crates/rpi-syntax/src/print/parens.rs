//! Parentheses that are required for a printed tree to parse back unchanged, by the table of operators.

use crate::ast::{Expr, ExprKind};
use crate::ops::{
    Associativity, BinaryOp, PRECEDENCE_IF, PRECEDENCE_PRIMARY, PRECEDENCE_WHEN, Precedence,
    UnaryOp,
};

/// Returns the precedence level of the outermost operator of an expression; the highest level if there is no operator.
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

/// Returns whether an expression needs parentheses on the left of the sampling operator `when`.
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

/// Returns whether an expression needs parentheses as the operand of the unary operator `op`.
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

/// Returns whether an expression needs parentheses before a field access `.f` or an index `[i]`.
pub(super) fn base(base: &Expr) -> bool {
    use ExprKind::{Bool, Merge, Number, Quantity, Str};
    let literal = matches!(
        base.kind,
        Bool(_) | Number(_) | Quantity(_) | Str(_) | Merge(_)
    );
    literal || level(base) < PRECEDENCE_PRIMARY
}

/// Returns whether an expression needs parentheses before an operator of the precedence level `op`. `groups_left` is
/// true if that operator is left-associative.
fn before(op: Precedence, groups_left: bool, expr: &Expr) -> bool {
    let weaker = !is_prefix(expr) && (level(expr) < op || level(expr) == op && !groups_left);
    weaker || trailing_level(expr) <= op
}

/// Returns whether the outermost operator of an expression is a prefix: a unary operator or an `if`.
fn is_prefix(expr: &Expr) -> bool {
    matches!(expr.kind, ExprKind::Unary(..) | ExprKind::If(_))
}

/// Returns the lowest precedence level among the operators whose last operand ends where the expression ends.
///
/// The last operand of such an operator would also absorb a following operator of higher precedence.
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

/// Returns whether the printed expression begins with a string literal, which would be read as a label after `assert`.
pub(super) fn begins_with_text(expr: &Expr) -> bool {
    matches!(first(expr).kind, ExprKind::Str(_))
}

/// Returns whether a static argument needs parentheses. Without them, `real [x]` at its start would be read as a type
/// with a unit.
pub(super) fn static_argument(value: &Expr) -> bool {
    match &first(value).kind {
        ExprKind::Unary(UnaryOp::ToReal, converted) => {
            !operand(UnaryOp::ToReal, converted) && begins_with_bracket(first(converted))
        }
        _ => false,
    }
}

/// Returns the subexpression with which the printed text of an expression begins.
fn first(expr: &Expr) -> &Expr {
    match &expr.kind {
        ExprKind::Binary(binary) if !left(binary.op, &binary.lhs) => first(&binary.lhs),
        ExprKind::When(when) if !sampled(&when.value) => first(&when.value),
        _ => expr,
    }
}
