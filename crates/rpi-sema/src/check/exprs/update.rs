//! Functional updates: `(a with [2] = x; .f[i] = y)`; for Kind 2 `a[2 := x]`, `r[f := y]`.
//!
//! An index that is known only at run time is looked up in the list of all indices, so that its bounds are checked like
//! those of every other index. Each element of the result is then the new or the old one.

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::statement;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::access;
use crate::check::exprs::access::leaf_count;
use crate::check::exprs::compose;
use crate::check::exprs::expr;
use crate::check::exprs::indexing;
use crate::check::exprs::proof_only;
use crate::check::exprs::proof_only::WHY_NO_SETS;
use crate::check::exprs::spatial_parts;
use crate::check::limits::nesting;
use crate::check::types::consts;
use crate::check::types::{UNCHECKED_TYPE_PREFIXES, is_kind2_type};
use crate::ty::Ty;
use crate::typed::{ElementwiseOp, TypedKind};
use crate::typed::{ExprId, Leaf};
use rpi_diag::Span;
use rpi_syntax::Name;
use rpi_syntax::ast::{Access, Change, Expr, Ident, Update};
use std::rc::Rc;

/// Change of one part of a value: the path from the value to the part, the new value of the part, and the location of
/// the change.
struct PartUpdate<'a> {
    path: &'a [Access],
    value: ExprId,
    span: Span,
}

/// Checks an update `(base with [2] = x; .f[1] = y)` and returns the typed expression of the changed value.
pub(crate) fn check_update<'a>(cx: &mut Body<'_, 'a>, update: &'a Update, span: Span) -> ExprId {
    if update.is_keyed && is_map_literal(cx, &update.base) {
        return map_literal(cx, update, span);
    }
    let base = expr::check_expr(cx, &update.base);
    if update.is_keyed {
        let change = |base, change| keyed_update(cx, base, change, span);
        return update.changes.iter().fold(base, change);
    }
    update
        .changes
        .iter()
        .fold(base, |base, change| apply_change(cx, base, change, span))
}

/// Whether `map[1 := x]` of Kind 2 is a map literal, because `map` is neither a flow nor a static parameter here.
fn is_map_literal(cx: &Body<'_, '_>, base: &Expr) -> bool {
    let is_free =
        |name: &Name| locals::find_local(cx, name).is_none() && !cx.statics.contains_key(name);
    base.as_name()
        .is_some_and(|name| name == "map" && is_free(name))
}

fn map_literal<'a>(cx: &mut Body<'_, 'a>, update: &'a Update, span: Span) -> ExprId {
    for change in &update.changes {
        if let [Access::Index(key)] = &change.path[..] {
            expr::check_expr(cx, key);
        }
        expr::check_expr(cx, &change.value);
    }
    proof_only::not_executable(cx, "a map", WHY_NO_SETS, update.base.span);
    cx.error_expr(span)
}

/// Checks an update `base[key := value]` of Kind 2 and returns the typed expression of the changed value. For a struct,
/// the key is the name of a field.
fn keyed_update<'a>(cx: &mut Body<'_, 'a>, base: ExprId, change: &'a Change, span: Span) -> ExprId {
    let ty = cx.ty_of(base).clone();
    let field = match (&change.path[..], &ty) {
        ([Access::Index(key)], Ty::Struct(_)) if !is_kind2_type(&ty, UNCHECKED_TYPE_PREFIXES) => {
            key.as_name().map(|name| Ident {
                name: name.clone(),
                span: key.span,
            })
        }
        _ => None,
    };
    match (&change.path[..], field) {
        (_, Some(field)) => {
            let value = expr::check_expr(cx, &change.value);
            let inside = PartUpdate {
                path: &[],
                value,
                span,
            };
            let place = access::resolve_field(cx, &ty, &field);
            let new = place.and_then(|(at, inner)| replace_at_leaf(cx, base, at, inner, &inside));
            new.unwrap_or_else(|| cx.error_expr(span))
        }
        ([Access::Index(key)], None) if is_kind2_type(&ty, &["map<"]) => {
            expr::check_expr(cx, key);
            expr::check_expr(cx, &change.value);
            cx.add(TypedKind::Error, ty, span)
        }
        _ => apply_change(cx, base, change, span),
    }
}

fn apply_change<'a>(cx: &mut Body<'_, 'a>, base: ExprId, change: &'a Change, span: Span) -> ExprId {
    let part = PartUpdate {
        path: &change.path,
        value: expr::check_expr(cx, &change.value),
        span,
    };
    match cx.ty_of(base).is_unknown() {
        true => cx.error_expr(span),
        false => replace_at_path(cx, base, &part).unwrap_or_else(|| cx.error_expr(span)),
    }
}

/// Returns an expression for the value `base` with the part at a path replaced; `None` after an error.
fn replace_at_path<'a>(
    cx: &mut Body<'_, 'a>,
    base: ExprId,
    part: &PartUpdate<'a>,
) -> Option<ExprId> {
    let ty = cx.ty_of(base).clone();
    let Some((first, rest)) = part.path.split_first() else {
        expect_part_type(cx, part.value, &ty);
        return Some(part.value);
    };
    let inside = PartUpdate {
        path: rest,
        ..*part
    };
    if let (Access::Index(index), Ty::Array(element, n)) = (first, &ty) {
        let at = expr::check_expr(cx, index);
        let is_int = statement::expect_type(cx, at, &Ty::Int, &ExpectationReason::Unexplained);
        return match indexing::const_int(cx, at) {
            _ if !is_int => None,
            Some(k) => {
                let k = indexing::checked_index(cx, k, *n, index.span)?;
                replace_at_leaf(
                    cx,
                    base,
                    k * leaf_count(element),
                    (**element).clone(),
                    &inside,
                )
            }
            None => replace_at_index(cx, base, at, &inside),
        };
    }
    if let (Access::Index(index), Ty::Tuple(members)) = (first, &ty) {
        let count = u32::try_from(members.len()).unwrap_or(u32::MAX);
        let k = consts::const_integer(cx, index)?;
        let k = indexing::checked_index(cx, k, count, index.span)?;
        let (before, rest) = members.split_at(k as usize);
        let at = before.iter().map(|member| leaf_count(&member.ty)).sum();
        return replace_at_leaf(cx, base, at, rest.first()?.ty.clone(), &inside);
    }
    if let (Access::Field(field), Ty::Spatial(..)) = (first, &ty) {
        let old = access::member_access(cx, base, field);
        let new = replace_at_path(cx, old, &inside)?;
        return Some(spatial_parts::replace_part(cx, base, field, new, part.span));
    }
    let (at, inner) = access::resolve_path(cx, &ty, 0, std::slice::from_ref(first))?;
    replace_at_leaf(cx, base, at, inner, &inside)
}

/// Reports a new value whose type differs from `part`, the type of the part that it replaces.
fn expect_part_type(cx: &mut Body<'_, '_>, value: ExprId, part: &Ty) {
    let why = ExpectationReason::Because(Span::NONE, format!("the replaced part is `{part}`"));
    statement::expect_type(cx, value, part, &why);
}

/// Returns an expression for the value `base` with a part replaced; `None` after an error. The part has the type
/// `inner` and starts at the leaf (scalar part) with index `at`. `inside` is the change within this part.
fn replace_at_leaf<'a>(
    cx: &mut Body<'_, 'a>,
    base: ExprId,
    at: u32,
    inner: Ty,
    inside: &PartUpdate<'a>,
) -> Option<ExprId> {
    let ty = cx.ty_of(base).clone();
    let value = match inside.path {
        [] => {
            expect_part_type(cx, inside.value, &inner);
            inside.value
        }
        _ => {
            let old = cx.add(TypedKind::Part { base, at }, inner, inside.span);
            replace_at_path(cx, old, inside)?
        }
    };
    Some(cx.add(TypedKind::Replace { base, at, value }, ty, inside.span))
}

/// Returns an expression for the array `base` with the element at an index that is known only at run time replaced;
/// `None` after an error. `inside` is the change within the element.
fn replace_at_index<'a>(
    cx: &mut Body<'_, 'a>,
    base: ExprId,
    at: ExprId,
    inside: &PartUpdate<'a>,
) -> Option<ExprId> {
    let span = inside.span;
    let Ty::Array(element, n) = cx.ty_of(base).clone() else {
        return None;
    };
    // An empty array has no element to replace, whatever the index.
    indexing::checked_index(cx, 0, n, span)?;
    let numbers: Vec<ExprId> = (0..n).map(|k| index_literal(cx, k, span)).collect();
    let all = compose::add_array(
        cx,
        TypedKind::Build(numbers.clone().into()),
        Rc::new(Ty::Int),
        n,
        span,
    );
    let index = cx.add(
        TypedKind::Select {
            base: all,
            index: at,
        },
        Ty::Int,
        span,
    );
    let old = cx.add(TypedKind::Select { base, index }, (*element).clone(), span);
    let new = replace_at_path(cx, old, inside)?;
    let mut elements = Vec::with_capacity(numbers.len());
    for (k, number) in (0..n).zip(numbers) {
        if !nesting::may_expand(cx, span) {
            return None;
        }
        let at = k * leaf_count(&element);
        let old = cx.add(TypedKind::Part { base, at }, (*element).clone(), span);
        elements.push(select_if_equal(cx, [index, number], [old, new], span));
    }
    Some(compose::add_array(
        cx,
        TypedKind::Build(elements.into()),
        element,
        n,
        span,
    ))
}

/// Returns an expression that selects the second of two values if the two operands are equal integers, else the first.
/// Both values are computed in every cycle; an `if` would compute the new value separately for each element.
fn select_if_equal(
    cx: &mut Body<'_, '_>,
    operands: [ExprId; 2],
    values: [ExprId; 2],
    span: Span,
) -> ExprId {
    let negated = false;
    let is_it = cx.add(TypedKind::Equal { operands, negated }, Ty::Bool, span);
    let [one, zero] = [1, 0].map(|k| index_literal(cx, k, span));
    let which = TypedKind::Each(ElementwiseOp::If, [is_it, one, zero].into());
    let index = cx.add(which, Ty::Int, span);
    let ty = cx.ty_of(values[0]).clone();
    let base = compose::add_array(
        cx,
        TypedKind::Build(values.into()),
        Rc::new(ty.clone()),
        2,
        span,
    );
    cx.add(TypedKind::Select { base, index }, ty, span)
}

fn index_literal(cx: &mut Body<'_, '_>, k: u32, span: Span) -> ExprId {
    cx.add(TypedKind::Literal(Leaf::int(i64::from(k))), Ty::Int, span)
}
