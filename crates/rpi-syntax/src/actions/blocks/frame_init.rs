//! Desugaring of `last x` in a `frame` block.
//!
//! `last x` is the value of the previous cycle. In the first cycle, it is the value that the frame gives before `let`.
//! A flow that no branch defines is `last` of itself.

use super::definitions::{Definition, Definitions};
use super::desugar::arrow_expr;
use super::frame_arrays::base_flow;
use crate::ast::*;
use crate::ops::UnaryOp;
use rpi_diag::Span;
use std::collections::BTreeSet;

/// Replaces each `last x` of a flow in `names` by `i -> pre x`, where `i` is the initial value of `x`. Without an
/// initial value, the replacement is `pre x`.
///
/// If one call gives the initial values of several flows, the tuple cannot be split. The whole definition then begins
/// with that call.
pub(super) fn insert_initial_values(
    definition: &mut Definition,
    initial: &Definitions,
    names: &BTreeSet<&Name>,
) {
    let value = &mut definition.value;
    push_index(value);
    let mut is_open = false;
    value.for_each_mut(&mut |part| {
        if let Some(first) = common_initial_value(part, initial) {
            return begin_with(part, first);
        }
        let ExprKind::Unary(op @ UnaryOp::Last, inner) = &mut part.kind else {
            return;
        };
        if base_flow(inner).is_none_or(|name| !names.contains(name)) {
            return;
        }
        *op = UnaryOp::Pre;
        match initial_value(inner, initial) {
            Some(first) => begin_with(part, first),
            None => is_open = true,
        }
    });
    if let Some(first) = initial.value_of(&definition.targets).filter(|_| is_open) {
        begin_with(&mut definition.value, first);
    }
}

/// Moves the index of an indexed conditional into its branches: `(if c then x else last A)[k]` becomes `if c then x[k]
/// else last A[k]`.
// Initial values may be given by element, so `last` must apply to elements.
fn push_index(expr: &mut Expr) {
    let ExprKind::Index(of) = &mut expr.kind else {
        return;
    };
    push_index(&mut of.base);
    let index = of.index.clone();
    let within = |part: Expr| Expr {
        span: part.span,
        kind: ExprKind::Index(Box::new(Index {
            base: part,
            index: index.clone(),
        })),
    };
    let base = std::mem::replace(&mut of.base, placeholder());
    expr.kind = match base.unparen().kind.clone() {
        ExprKind::If(mut choice) if !choice.is_static => {
            for branch in [&mut choice.then_value, &mut choice.else_value] {
                *branch = within(std::mem::replace(branch, placeholder()));
                push_index(branch);
            }
            ExprKind::If(choice)
        }
        ExprKind::Unary(UnaryOp::Last, inner) => {
            ExprKind::Unary(UnaryOp::Last, Box::new(within(*inner)))
        }
        _ => within(base).kind,
    };
}

/// Returns the initial value of the flow, or part of a flow, that the expression `place` denotes; `None` if it has
/// none.
fn initial_value(place: &Expr, initial: &Definitions) -> Option<Expr> {
    let name = base_flow(place)?;
    let alone = |d: &&Definition| matches!(&d.targets[..], [one] if denotes_target(one, place));
    let found = initial.defining(name).find(alone).map(|d| d.value.clone());
    found
        .or_else(|| initial_value_in_group(place, initial))
        .or_else(|| {
            let whole = match &place.unparen().kind {
                ExprKind::Field(field) => &field.base,
                ExprKind::Index(index) => &index.base,
                _ => return None,
            };
            let base = initial_value(whole, initial)?;
            let mut part = place.unparen().clone();
            match &mut part.kind {
                ExprKind::Field(field) => field.base = base,
                ExprKind::Index(index) => index.base = base,
                _ => {}
            }
            Some(part)
        })
}

/// Returns the initial value of the flow `place` from a definition of several flows by a tuple, such as
/// `x, y = (1, 2)`; `None` if there is no such definition.
fn initial_value_in_group(place: &Expr, initial: &Definitions) -> Option<Expr> {
    let mut groups = initial.defining(base_flow(place)?);
    groups.find_map(|d| {
        let at = d
            .targets
            .iter()
            .position(|target| denotes_target(target, place))?;
        match &d.value.unparen().kind {
            ExprKind::Tuple(values) if values.len() == d.targets.len() => values.get(at).cloned(),
            _ => None,
        }
    })
}

/// Replaces the expression `expr` by `first -> expr`.
fn begin_with(expr: &mut Expr, first: Expr) {
    let then = std::mem::replace(expr, placeholder());
    *expr = arrow_expr(first, then);
}

/// Returns whether the expression `place` denotes the target of an equation or a part of that target.
fn denotes_target(target: &Target, place: &Expr) -> bool {
    let mut place = place.unparen();
    for access in target.path.iter().rev() {
        place = match (&place.kind, access) {
            (ExprKind::Field(at), Access::Field(field)) if at.field.name == field.name => {
                at.base.unparen()
            }
            (ExprKind::Index(at), Access::Index(index))
                if at.index.unparen().kind == index.unparen().kind =>
            {
                at.base.unparen()
            }
            _ => return false,
        };
    }
    place.as_name() == Some(&target.name.name)
}

/// Returns the initial value of a tuple `(pre x, pre y)` if one equation defines the initial values of exactly these
/// flows; `None` otherwise. `part` is the tuple.
fn common_initial_value(part: &Expr, initial: &Definitions) -> Option<Expr> {
    let ExprKind::Tuple(values) = &part.kind else {
        return None;
    };
    let delayed = |value: &Expr| match &value.unparen().kind {
        ExprKind::Unary(UnaryOp::Pre, inner) => inner.as_name().cloned(),
        _ => None,
    };
    let names: Option<Vec<Name>> = values.iter().map(delayed).collect();
    let names = names?;
    let is_group = |d: &&Definition| {
        let targets = d.targets.iter().map(|target| &target.name.name);
        d.targets.len() > 1 && targets.eq(&names)
    };
    let found = initial.defining(names.first()?).find(is_group);
    found.map(|d| d.value.clone())
}

/// Returns a dummy expression that fills a place in the tree while its contents are moved.
fn placeholder() -> Expr {
    Expr {
        kind: ExprKind::Bool(false),
        span: Span::NONE,
    }
}
