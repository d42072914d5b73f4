//! Indexing and slicing of arrays, tuples and maps.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::diagnostics::precedence_hints;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::access;
use crate::check::exprs::bindings::{Binding, BindingValue};
use crate::check::exprs::expr;
use crate::check::signatures::unit;
use crate::check::types::consts;
use crate::check::types::is_kind2_type;
use crate::ty::Ty;
use crate::typed::TypedKind;
use crate::typed::{ExprId, Leaf};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Index, SliceBounds, SliceExpr};
use std::rc::Rc;

/// Slice of an array with bounds that are known at compile time.
struct ArrayRange {
    /// Index of the first element.
    from: u32,
    /// Difference of the indices of two successive elements; negative in a descending slice.
    step: i32,
    /// Number of elements in the slice.
    len: u32,
}

/// Checks `base[index]` and returns its typed expression.
pub(crate) fn index_access<'a>(cx: &mut Body<'_, 'a>, index: &'a Index, span: Span) -> ExprId {
    let base = expr::check_expr(cx, &index.base);
    if precedence_hints::is_unit_index(cx, base, &index.index) {
        return precedence_hints::unit_after_flow(cx, base, &index.index, span);
    }
    let at = expr::check_expr(cx, &index.index);
    if is_kind2_type(cx.ty_of(base), &["map<"]) {
        check_map_key(cx, base, at);
        return report_not_an_array(cx, base, span);
    }
    statement::expect_type(
        cx,
        at,
        &Ty::Int,
        &ExpectationReason::Because(Span::NONE, "an index must be an integer".into()),
    );
    if let Ty::Tuple(members) = cx.ty_of(base).clone()
        && !unit::reads_rpi_syntax(cx)
        && members.iter().all(|member| member.name.is_none())
    {
        return tuple_index(cx, base, at, &members, span);
    }
    let Ty::Array(element, n) = cx.ty_of(base).clone() else {
        return report_not_an_array(cx, base, span);
    };
    match const_int(cx, at) {
        Some(k) => match checked_index(cx, k, n, cx.span_of(at)) {
            Some(k) => {
                let at = k * access::leaf_count(&element);
                cx.add(TypedKind::Part { base, at }, (*element).clone(), span)
            }
            None => cx.error_expr(span),
        },
        None => cx.add(
            TypedKind::Select { base, index: at },
            (*element).clone(),
            span,
        ),
    }
}

/// Checks `t[0]`, an element of a Kind 2 tuple, and returns its typed expression. The index must be constant, because
/// each element has a type of its own. `members` are the elements of the tuple.
fn tuple_index(
    cx: &mut Body<'_, '_>,
    base: ExprId,
    at: ExprId,
    members: &[crate::ty::Member],
    span: Span,
) -> ExprId {
    let Some(k) = consts::fold(cx, at).and_then(|leaves| leaves.first()?.as_int()) else {
        return cx.error_expr(span);
    };
    let count = u32::try_from(members.len()).unwrap_or(u32::MAX);
    let Some(k) = checked_index(cx, k, count, cx.span_of(at)) else {
        return cx.error_expr(span);
    };
    let before = &members[..k as usize];
    let from = before
        .iter()
        .map(|member| access::leaf_count(&member.ty))
        .sum();
    let ty = members[k as usize].ty.clone();
    cx.add(TypedKind::Part { base, at: from }, ty, span)
}

/// Returns the value of an integer expression if it is known at compile time; `None` otherwise.
pub(crate) fn const_int(cx: &mut Body<'_, '_>, id: ExprId) -> Option<i64> {
    match &cx.unit.expr(id).kind {
        TypedKind::Literal(value) => value.as_int(),
        TypedKind::Flow(_) if cx.unit.kind != crate::typed::UnitKind::Constant => None,
        _ => consts::fold_silently(cx, id)?
            .first()
            .and_then(Leaf::as_int),
    }
}

/// Reports a key `at` whose type is not the key type of the Kind 2 map `base`.
fn check_map_key(cx: &mut Body<'_, '_>, base: ExprId, at: ExprId) {
    let found = cx.ty_of(at).clone();
    let Ty::Struct(map) = cx.ty_of(base) else {
        return;
    };
    let args = map.name.strip_prefix("map<").unwrap_or_default();
    let wanted = map_key_type(args).to_owned();
    if !found.is_unknown() && found.to_string() != wanted {
        let message = format!("expected `{wanted}`, found `{found}`");
        let diagnostic = Diagnostic::new(Code::RPI2001, message)
            .primary(cx.span_of(at), format!("this is `{found}`"))
            .secondary(cx.span_of(base), "the map")
            .help(format!(
                "use a key of type `{wanted}`, with which the map is declared"
            ));
        report::report_diagnostic(cx, diagnostic);
    }
}

fn report_not_an_array(cx: &mut Body<'_, '_>, base: ExprId, span: Span) -> ExprId {
    let ty = cx.ty_of(base).clone();
    // No error for the element of a Kind 2 map: the map itself has been reported as not executable.
    if ty.is_unknown() || is_kind2_type(&ty, &["map<"]) {
        return cx.error_expr(span);
    }
    let diagnostic = Diagnostic::new(Code::RPI2006, "only arrays can be indexed")
        .primary(cx.span_of(base), format!("this is `{ty}`"))
        .help("an array is declared as `a: int^3`; the value of the previous cycle is `first -> pre x`");
    cx.report_error_expr(diagnostic, span)
}

/// Returns the array index `k` as `u32`. Reports an index that is negative or not less than the size `n`, and returns
/// `None`.
pub(crate) fn checked_index(cx: &mut Body<'_, '_>, k: i64, n: u32, span: Span) -> Option<u32> {
    let index = u32::try_from(k).ok().filter(|k| *k < n);
    if index.is_none() {
        let diagnostic = Diagnostic::new(Code::RPI2009, format!("index {k} is out of bounds"))
            .primary(
                span,
                format!(
                    "the array has {}, counted from 0",
                    rpi_diag::with_noun(n, "element")
                ),
            )
            .help(match (n, current_index(cx)) {
                (0, _) => "an array without elements cannot be indexed".to_owned(),
                (_, Some((name, value))) => {
                    let sign = if k < 0 { '>' } else { '<' };
                    format!(
                        "for `{name}` = {value} this is element {k}: give such elements a value of their own by `if {name} {sign} {value} then ... else ...`"
                    )
                }
                (n, None) => format!("use an index from 0 to {}", n - 1),
            });
        report::report_diagnostic(cx, diagnostic);
    }
    index
}

/// Returns the index variable of the element equation being checked with its value, if there is exactly one.
fn current_index(cx: &Body<'_, '_>) -> Option<(Name, i64)> {
    let index = |binding: &Binding| match binding.value {
        BindingValue::Index(value) => Some((binding.name.clone(), value)),
        _ => None,
    };
    let all: Vec<(Name, i64)> = cx.bindings.bound_names.iter().filter_map(index).collect();
    let (name, value) = all.last()?;
    // The index variable is bound again wherever the equation is entered.
    let is_only = all.iter().all(|(other, _)| other == name);
    is_only.then(|| (name.clone(), *value))
}

/// Checks `base[from..to step s]` and returns its typed expression.
pub(crate) fn slice_access<'a>(cx: &mut Body<'_, 'a>, slice: &'a SliceExpr, span: Span) -> ExprId {
    let base = expr::check_expr(cx, &slice.base);
    let Ty::Array(element, n) = cx.ty_of(base).clone() else {
        return report_not_an_array(cx, base, span);
    };
    let Some(range) = slice_range(cx, &slice.slice, n, span) else {
        return cx.error_expr(span);
    };
    let ty = Ty::Array(element, range.len);
    let (from, step) = (range.from, range.step);
    cx.add(TypedKind::Slice { base, from, step }, ty, span)
}

fn slice_range<'a>(
    cx: &mut Body<'_, 'a>,
    slice: &'a SliceBounds,
    n: u32,
    span: Span,
) -> Option<ArrayRange> {
    let (from, to) = (
        consts::const_integer(cx, &slice.from)?,
        consts::const_integer(cx, &slice.to)?,
    );
    let step = match &slice.step {
        Some(step) => consts::const_integer(cx, step)?,
        None => 1,
    };
    let (first, last) = (
        checked_index(cx, from, n, slice.from.span)?,
        checked_index(cx, to, n, slice.to.span)?,
    );
    let distance = i64::from(last) - i64::from(first);
    if step == 0 || (distance != 0 && distance.signum() != step.signum()) {
        let diagnostic = Diagnostic::new(Code::RPI2009, "the slice never reaches its end")
            .primary(span, format!("from {from} to {to} in steps of {step}"));
        report::report_diagnostic(cx, diagnostic);
        return None;
    }
    Some(ArrayRange {
        from: first,
        step: i32::try_from(step).ok()?,
        len: u32::try_from(distance / step + 1).ok()?,
    })
}

pub(crate) fn resolve_slice<'a>(
    cx: &mut Body<'_, 'a>,
    element: &Rc<Ty>,
    n: u32,
    slice: &'a SliceBounds,
) -> Option<(u32, Ty)> {
    let span = slice.from.span.merge(slice.to.span);
    let range = slice_range(cx, slice, n, span)?;
    if range.step != 1 {
        let diagnostic = Diagnostic::new(
            Code::RPI2009,
            "only adjacent elements can be defined together",
        )
        .primary(span, format!("a step of {}", range.step));
        report::report_diagnostic(cx, diagnostic);
        return None;
    }
    Some((
        range.from * access::leaf_count(element),
        Ty::Array(element.clone(), range.len),
    ))
}

pub(crate) fn not_indexable(cx: &mut Body<'_, '_>, ty: &Ty, span: Span) -> Option<(u32, Ty)> {
    let diagnostic = Diagnostic::new(Code::RPI2006, "only arrays can be indexed")
        .primary(span, format!("this indexes `{ty}`"));
    report::report_diagnostic(cx, diagnostic);
    None
}

/// Returns the key type in `args`, the text after `map<` in the name of a Kind 2 map type. Commas inside of brackets
/// belong to a type.
fn map_key_type(args: &str) -> &str {
    let mut depth = 0;
    let end = args.find(|c| {
        depth += match c {
            '<' | '(' | '[' => 1,
            '>' | ')' | ']' => -1,
            _ => 0,
        };
        c == ',' && depth == 0
    });
    end.map_or(args, |end| &args[..end])
}
