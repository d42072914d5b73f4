//! Composite values: arrays and structs.

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::diagnostics::report::wrong_kind_of_name;
use crate::check::diagnostics::undefined_names;
use crate::check::exprs::access::leaf_count;
use crate::check::exprs::access::unknown_member;
use crate::check::exprs::bracketed;
use crate::check::exprs::expr;
use crate::check::exprs::spatial_parts;
use crate::check::types::consts;
use crate::check::types::data;
use crate::check::types::{MAX_LEAVES, too_large};
use crate::program::{DeclKind, Lookup, NameSpace};
use crate::ty::StructTy;
use crate::ty::Substitution;
use crate::ty::Ty;
use crate::ty::check_assignable;
use crate::typed::ExprId;
use crate::typed::TypedKind;
use rpi_diag::{Code, Diagnostic, Quote, Span};
use rpi_syntax::ast::{self, Binary, FieldValue, Ident, StaticArg, StructExpr};
use std::rc::Rc;

/// Maximum number of elements of an array.
const MAX_LENGTH: i64 = MAX_LEAVES as i64;

/// Checks an array literal `[x, y]` and returns its typed expression.
pub(crate) fn array_literal<'a>(
    cx: &mut Body<'_, 'a>,
    elements: &'a [ast::Expr],
    span: Span,
) -> ExprId {
    let ids: Vec<ExprId> = elements.iter().map(|e| expr::check_expr(cx, e)).collect();
    let Some((first, rest)) = ids.split_first() else {
        let diagnostic = Diagnostic::new(Code::RPI2007, "cannot infer the type of an empty array")
            .primary(span, "no elements");
        return cx.report_error_expr(diagnostic, span);
    };
    let mut element = cx.ty_of(*first).clone();
    for id in rest {
        let common = expr::common_type(
            cx,
            *first,
            *id,
            "the elements of an array must have the same type",
        );
        if element.is_unknown() {
            element = common;
        }
    }
    let n = u32::try_from(ids.len()).unwrap_or(u32::MAX);
    add_array(cx, TypedKind::Build(ids.into()), Rc::new(element), n, span)
}

/// Adds the expression `kind`, an array of `n` elements of the type `element`, and returns it. Reports an array with
/// too many leaves (scalar parts).
pub(crate) fn add_array(
    cx: &mut Body<'_, '_>,
    kind: TypedKind,
    element: Rc<Ty>,
    n: u32,
    span: Span,
) -> ExprId {
    let ty = Ty::Array(element, n);
    match ty.leaf_count() > MAX_LEAVES {
        true => cx.report_error_expr(too_large(span), span),
        false => cx.add(kind, ty, span),
    }
}

/// Checks an array of `n` equal elements, `x ^ n`, and returns its typed expression.
pub(crate) fn array_repeat<'a>(cx: &mut Body<'_, 'a>, binary: &'a Binary, span: Span) -> ExprId {
    let element = expr::check_expr(cx, &binary.lhs);
    let Some(n) = size_value(cx, &binary.rhs, Some(binary.lhs.span)) else {
        return cx.error_expr(span);
    };
    let ty = Rc::new(cx.ty_of(element).clone());
    add_array(cx, TypedKind::Repeat(element), ty, n, span)
}

/// Checks the concatenation of arrays, `x | y`, and returns its typed expression.
pub(crate) fn array_concat<'a>(cx: &mut Body<'_, 'a>, binary: &'a Binary, span: Span) -> ExprId {
    let before = cx.diagnostics.len();
    let left = expr::check_expr(cx, &binary.lhs);
    if report::has_error_since(cx, before) {
        bracketed::hint_concat_precedence(cx, binary);
    }
    let right = expr::check_expr(cx, &binary.rhs);
    let (a, b) = (cx.ty_of(left).clone(), cx.ty_of(right).clone());
    let (Ty::Array(a, n), Ty::Array(b, m)) = (&a, &b) else {
        if a.is_unknown() || b.is_unknown() {
            return cx.error_expr(span);
        }
        let diagnostic = Diagnostic::new(Code::RPI2006, format!("`|` cannot take `{a}` and `{b}`"))
            .primary(cx.span_of(right), format!("this is `{b}`"))
            .secondary(cx.span_of(left), format!("this is `{a}`"))
            .help("`|` concatenates arrays; for Booleans write `or`");
        return cx.report_error_expr(diagnostic, span);
    };
    if let Err(misfit) = check_assignable(a, b, &mut Substitution::default()) {
        let wanted = ExpectationReason::Because(cx.span_of(left), format!("this is `{a}^{n}`"));
        let expected = (**a).clone();
        report::type_mismatch(cx, right, &expected, &misfit, &wanted);
    }
    let n = n.saturating_add(*m);
    add_array(
        cx,
        TypedKind::Build([left, right].into()),
        a.clone(),
        n,
        span,
    )
}

/// Returns the value of an array size, which must be a constant non-negative integer. Reports any other expression and
/// returns `None`.
pub(crate) fn const_size<'a>(cx: &mut Body<'_, 'a>, size: &'a ast::Expr) -> Option<u32> {
    size_value(cx, size, None)
}

/// Returns the value of an array size as [`const_size`] does. `repeated` is the location of `x` in `x ^ n`, for the
/// help text of an error; `None` for other sizes.
fn size_value<'a>(
    cx: &mut Body<'_, 'a>,
    size: &'a ast::Expr,
    repeated: Option<Span>,
) -> Option<u32> {
    let before = cx.diagnostics.len();
    let id = expr::check_expr(cx, size);
    let leaves = consts::const_value_of(cx, id, &Ty::Int);
    let Some(value) = leaves.and_then(|leaves| leaves.first()?.as_int()) else {
        // A conversion cannot be applied to a size, so that the fixes are replaced by a hint.
        let help = match (cx.ty_of(id), repeated) {
            (Ty::Bool, Some(base)) => format!(
                "exclusive or is `{} xor {}`; `^` makes an array of equal elements",
                Quote::operand(base),
                Quote::operand(size.span)
            ),
            (_, Some(base)) => format!(
                "`{0} ^ n` is an array of `n` times `{0}`; a power is written `{0} ** {1}`",
                Quote::operand(base),
                Quote::operand(size.span)
            ),
            (_, None) => "the size of an array must be a constant integer".to_owned(),
        };
        for diagnostic in cx.diagnostics.iter_mut().skip(before) {
            if diagnostic.code == Code::RPI2001 && diagnostic.span() == size.span {
                diagnostic.fixes.clear();
                diagnostic.help = vec![help.clone()];
                diagnostic.labels[0]
                    .text
                    .push_str("; it is read as the size of an array");
            }
        }
        return None;
    };
    if (0..=MAX_LENGTH).contains(&value) {
        return u32::try_from(value).ok();
    }
    let diagnostic = Diagnostic::new(Code::RPI2009, format!("invalid array size {value}"))
        .primary(size.span, format!("expected a size from 0 to {MAX_LENGTH}"))
        .help("use a smaller array, or several");
    report::report_diagnostic(cx, diagnostic);
    None
}

/// Checks a struct literal `T{x = 1; y = 2}`, or an update `T{s with x = 1}` of a struct, and returns its typed
/// expression.
pub(crate) fn struct_literal<'a>(
    cx: &mut Body<'_, 'a>,
    value: &'a StructExpr,
    span: Span,
) -> ExprId {
    if let Some(spatial) = spatial_parts::spatial_struct_type(cx, value) {
        return spatial_parts::spatial_value(cx, spatial, value, span);
    }
    if let Some(generic) = data::generic_struct(cx, value) {
        return data::inferred_struct(cx, generic, value, span);
    }
    let Some(ty) = resolve_struct_type(cx, &value.ty, &value.statics) else {
        for field in &value.fields {
            expr::check_expr(cx, &field.value);
        }
        return cx.error_expr(span);
    };
    let base = value.base.as_ref().map(|base| {
        let base = expr::check_expr(cx, base);
        let whole = Ty::Struct(ty.clone());
        statement::expect_type(cx, base, &whole, &ExpectationReason::Unexplained);
        base
    });
    let given = check_field_values(cx, &ty, &value.fields);
    let parts = given.and_then(|given| fill_fields(cx, &ty, &given, base, span));
    match parts {
        Some(parts) => cx.add(TypedKind::Build(parts.into()), Ty::Struct(ty), span),
        None => cx.add(TypedKind::Error, Ty::Struct(ty), span),
    }
}

/// Returns the struct type of a struct literal with its static arguments. Reports a name that is not a struct and
/// returns `None`.
fn resolve_struct_type<'a>(
    cx: &mut Body<'_, 'a>,
    name: &Ident,
    statics: &'a [StaticArg],
) -> Option<Rc<StructTy>> {
    let Lookup::Found(id) = cx
        .checker
        .program
        .lookup_in(NameSpace::Type, cx.module, &name.name)
    else {
        let near = {
            let is_type = |id| matches!(cx.checker.program.decl(id).kind, DeclKind::Type(_));
            let names = cx.checker.program.visible_names(cx.module, is_type);
            cx.checker.suggest(&name.name, names)
        };
        undefined_names::report_undefined(cx, "type", &name.name, name.span, near);
        return None;
    };
    let decl = cx.checker.program.decl(id).clone();
    if let DeclKind::Type(_) = decl.kind {
        match data::type_instance_for(cx, id, statics, name.span) {
            Ty::Struct(ty) => return Some(ty),
            Ty::Unknown => return None,
            _ => {}
        }
    }
    let diagnostic = wrong_kind_of_name(
        "a struct",
        &name.name,
        decl.kind.description(),
        name.span,
        decl.span,
    );
    report::report_diagnostic(cx, diagnostic);
    None
}

/// Checks the values in a struct literal. Returns the value of each field of the struct, or `None` for a field without
/// a value. Returns `None` for the whole after an unknown field.
fn check_field_values<'a>(
    cx: &mut Body<'_, 'a>,
    ty: &Rc<StructTy>,
    fields: &'a [FieldValue],
) -> Option<Vec<Option<ExprId>>> {
    let values = fields
        .iter()
        .map(|field| (field, expr::check_expr(cx, &field.value)));
    let values: Vec<(&FieldValue, ExprId)> = values.collect();
    match_fields(cx, ty, &values)
}

/// Returns the value of each field of a struct, or `None` for a field without a value. Reports an unknown field and
/// returns `None` for the whole, because the unknown field may be a missing one, misspelt.
pub(crate) fn match_fields<'a>(
    cx: &mut Body<'_, 'a>,
    ty: &Rc<StructTy>,
    fields: &[(&'a FieldValue, ExprId)],
) -> Option<Vec<Option<ExprId>>> {
    let mut given = vec![None; ty.fields.len()];
    let mut sound = true;
    for (value, id) in fields.iter().copied() {
        let name = &value.field.name;
        let Some(k) = ty.fields.iter().position(|f| f.name.as_ref() == Some(name)) else {
            let of = format!("the struct `{}`", ty.name);
            report::report_diagnostic(
                cx,
                unknown_member(&Ty::Struct(ty.clone()), &of, &value.field),
            );
            sound = false;
            continue;
        };
        let expected = &ty.fields[k].ty;
        let why = format!("the field `{name}` of `{}` is `{expected}`", ty.name);
        let why = ExpectationReason::Because(Span::NONE, why);
        statement::expect_type(cx, id, expected, &why);
        if let Some(first) = given[k].replace(id) {
            let diagnostic =
                crate::program::duplicate_name_error(name, value.field.span, cx.span_of(first));
            report::report_diagnostic(cx, diagnostic);
        }
    }
    sound.then_some(given)
}

/// Returns the values of all fields of a struct. Fields without a value in `given` are taken from the struct `base` or
/// from their defaults. Reports missing fields and returns `None`.
pub(crate) fn fill_fields(
    cx: &mut Body<'_, '_>,
    ty: &Rc<StructTy>,
    given: &[Option<ExprId>],
    base: Option<ExprId>,
    span: Span,
) -> Option<Vec<ExprId>> {
    let mut parts = Vec::new();
    let mut at = 0;
    let mut left_out = Vec::new();
    for (k, field) in ty.fields.iter().enumerate() {
        let part = match (given[k], base, ty.defaults.get(k)) {
            (Some(id), ..) => Some(id),
            (None, Some(base), _) => {
                Some(cx.add(TypedKind::Part { base, at }, field.ty.clone(), span))
            }
            (None, None, Some(Some(default))) if default.is_empty() => {
                Some(cx.add(TypedKind::Error, field.ty.clone(), span))
            }
            (None, None, Some(Some(default))) => {
                Some(cx.add(TypedKind::Const(default.clone()), field.ty.clone(), span))
            }
            _ => None,
        };
        match part {
            Some(part) => parts.push(part),
            None => left_out.extend(field.name.as_deref()),
        }
        at += leaf_count(&field.ty);
    }
    if left_out.is_empty() {
        return Some(parts);
    }
    let example = format!("{} = ...", left_out.first().copied().unwrap_or("x"));
    let diagnostic = Diagnostic::new(
        Code::RPI1010,
        format!(
            "missing {} of `{}`",
            crate::check::diagnostics::report::join_names(left_out),
            ty.name
        ),
    )
    .primary(span, "all fields without a default are required")
    .help(format!("add it: `{}{{...; {example}}}`", ty.name));
    report::report_diagnostic(cx, diagnostic);
    None
}
