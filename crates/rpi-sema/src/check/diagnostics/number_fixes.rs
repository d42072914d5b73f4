//! Fixes that write a number as another type: `3.0` for `3`, `3` for `3.0`, or a conversion.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::ty::Ty;
use crate::typed::ExprId;
use crate::typed::TypedKind;
use rpi_diag::{Diagnostic, Fix};

/// Returns the fix that writes an integer literal as a real: `3.0` for `3`, and the decimal number for `0x1F`.
fn real_literal_fix(cx: &Body<'_, '_>, id: ExprId) -> Fix {
    let (span, fix) = (cx.span_of(id), Fix::sure("write a real"));
    let value = match &cx.unit.expr(id).kind {
        TypedKind::Literal(leaf) => leaf.as_int(),
        _ => None,
    };
    let text = value.map(|value| value.to_string());
    match text.filter(|text| text.len() as u32 != span.end - span.start) {
        Some(text) => fix.replace(span, format!("{text}.0")),
        None => fix.insert_after(span, ".0"),
    }
}

/// Returns the fix that writes the literal of a whole real as an integer: `3` for `3.0`; `None` for any other literal.
pub(crate) fn integer_literal_fix(cx: &Body<'_, '_>, id: ExprId) -> Option<Fix> {
    let TypedKind::Literal(leaf) = &cx.unit.expr(id).kind else {
        return None;
    };
    let value = leaf.as_real()?;
    let is_whole = value.fract() == 0.0 && value.abs() < 1e15 && *cx.ty_of(id) == Ty::REAL;
    let fix = Fix::maybe("write an integer");
    is_whole.then(|| fix.replace(cx.span_of(id), format!("{value:.0}")))
}

/// Returns the fix that turns an integer into a real: another literal, or a conversion.
pub(crate) fn to_real_fix(cx: &Body<'_, '_>, id: ExprId) -> Fix {
    match report::is_number_literal(cx, id) {
        true => real_literal_fix(cx, id),
        false => conversion_fix(cx, id, "real"),
    }
}

/// Returns the fix that converts a value with the keyword of a type.
pub(crate) fn conversion_fix(cx: &Body<'_, '_>, id: ExprId, word: &str) -> Fix {
    let (span, title) = (cx.span_of(id), format!("convert with `{word}`"));
    match &cx.unit.expr(id).kind {
        TypedKind::Flow(_)
        | TypedKind::Literal(_)
        | TypedKind::Const(_)
        | TypedKind::Call(_)
        | TypedKind::Part { .. } => Fix::maybe(title).insert_before(span, format!("{word} ")),
        _ => Fix::maybe(title)
            .insert_before(span, format!("{word} ("))
            .insert_after(span, ")"),
    }
}

/// Replaces the fix of the reported mismatch of an integer and a real literal, which are the alternatives of `value`, if an
/// integer is expected: the real literal is the wrong one.
pub(crate) fn prefer_integers(cx: &mut Body<'_, '_>, value: ExprId, expected: &Ty) {
    let Some((index, fix)) = cx.inference.integer_fix.take() else {
        return;
    };
    let mut alternatives = Vec::new();
    if let TypedKind::Each(_, operands) = &cx.unit.expr(value).kind {
        alternatives.extend(operands.iter().map(|id| cx.span_of(*id)));
    }
    let reported = cx.diagnostics.get_mut(index);
    let is_alternative = |it: &&mut Diagnostic| alternatives.contains(&it.span());
    if let (Some(diagnostic), Ty::Int) = (reported.filter(is_alternative), expected) {
        diagnostic.help = vec!["to use reals, declare the flow as `real`".to_owned()];
        diagnostic.fixes = vec![fix];
    }
}
