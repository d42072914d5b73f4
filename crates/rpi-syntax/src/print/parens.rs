//! Parentheses that are required for a printed tree to parse back unchanged, by the table of operators.

use crate::ast::{Expr, ExprKind};
use crate::ops::{BinaryOp, Grouping, LEVEL_IF, LEVEL_PRIMARY, LEVEL_WHEN, Level, UnaryOp};

/// Returns the precedence level of the operator at the root of an expression.
pub(super) fn level(expr: &Expr) -> Level {
    match &expr.kind {
        ExprKind::If(_) | ExprKind::Quantified(_) => LEVEL_IF,
        ExprKind::Binary(binary) => binary.op.level(),
        ExprKind::Unary(op, _) => op.level(),
        ExprKind::When(_) => LEVEL_WHEN,
        _ => LEVEL_PRIMARY,
    }
}

/// Returns whether a left operand of `op` needs parentheses.
pub(super) fn left(op: BinaryOp, lhs: &Expr) -> bool {
    let groups_left = op.grouping() == Grouping::Left;
    before(op.level(), groups_left, lhs)
}

/// Returns whether the sampled value, left of `when`, needs parentheses.
pub(super) fn sampled(value: &Expr) -> bool {
    before(LEVEL_WHEN, true, value)
}

/// Returns whether a right operand of `op` needs parentheses.
pub(super) fn right(op: BinaryOp, rhs: &Expr) -> bool {
    if is_prefix(rhs) {
        return false;
    }
    let groups_right = op.grouping() == Grouping::Right;
    level(rhs) < op.level() || level(rhs) == op.level() && !groups_right
}

/// Returns whether the operand of a unary operator needs parentheses.
pub(super) fn operand(op: UnaryOp, operand: &Expr) -> bool {
    let looks_else = match op {
        // `--` would begin a comment.
        UnaryOp::Neg => begins_with_minus(operand),
        // `current -x` would be a difference, `current [x]` an element of an array.
        UnaryOp::Current => begins_with_minus(operand) || begins_with_bracket(operand),
        _ => false,
    };
    looks_else || !is_prefix(operand) && level(operand) < op.level()
}

/// Returns whether an expression needs parentheses before `.f` or `[i]`.
pub(super) fn base(base: &Expr) -> bool {
    use ExprKind::{Bool, Merge, Number, Quantity, Str};
    let literal = matches!(
        base.kind,
        Bool(_) | Number(_) | Quantity(_) | Str(_) | Merge(_)
    );
    literal || level(base) < LEVEL_PRIMARY
}

/// Returns whether an expression before an operator of this precedence level needs parentheses.
fn before(op: Level, groups_left: bool, expr: &Expr) -> bool {
    let weaker = !is_prefix(expr) && (level(expr) < op || level(expr) == op && !groups_left);
    weaker || open_end(expr) <= op
}

/// Returns whether the root of an expression is a prefix operator or an `if`.
fn is_prefix(expr: &Expr) -> bool {
    matches!(expr.kind, ExprKind::Unary(..) | ExprKind::If(_))
}

/// Returns the lowest precedence level of an operator whose last operand ends with the expression.
///
/// Such an operand would also absorb a following operator of higher precedence.
fn open_end(expr: &Expr) -> Level {
    match &expr.kind {
        ExprKind::If(_) => LEVEL_IF,
        ExprKind::Unary(op, inner) if operand(*op, inner) => op.level(),
        ExprKind::Unary(op, inner) => op.level().min(open_end(inner)),
        ExprKind::Binary(binary) if right(binary.op, &binary.rhs) => LEVEL_PRIMARY,
        ExprKind::Binary(binary) => open_end(&binary.rhs),
        _ => LEVEL_PRIMARY,
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
        ExprKind::Bits(of) => begins_with_bracket(&of.base),
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
