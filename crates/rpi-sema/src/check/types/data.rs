//! Types with parameters, and datatypes: alternatives with parts, which are constructed, tested and matched.
//!
//! A value of a datatype is a struct: the tag of its alternative, then the parts of all alternatives. The parts of the
//! other alternatives are 0, so that equal values have equal structs. The size is fixed, so that a datatype cannot
//! contain itself.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::diagnostics::report::join_names;
use crate::check::diagnostics::report::undefined_name;
use crate::check::exprs::compose;
use crate::check::exprs::expr;
use crate::check::exprs::ops;
use crate::check::signatures::static_args;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::check::signatures::static_params::static_params;
use crate::check::types::exact_time;
use crate::check::types::type_args;
use crate::check::types::type_decls;
use crate::program::{DeclId, DeclKind, Lookup, NameSpace};
use crate::ty::EnumTy;
use crate::ty::Member;
use crate::ty::StructTy;
use crate::ty::Substitution;
use crate::ty::Ty;
use crate::ty::check_assignable;
use crate::typed::TypedKind;
use crate::typed::{ExprId, Leaf};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{
    Constructor, ConstructorTest, FieldValue, Ident, StaticArg, StructExpr, TypeDef, TypeKind,
};
use std::rc::Rc;

/// Name of the struct field with the index of the alternative that a value of a `datatype` has.
pub(crate) const TAG: &str = "tag";

/// Returns the declared type `id` for these type arguments. Reports a wrong number of arguments.
pub(crate) fn type_instance_for<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    args: &'a [StaticArg],
    span: Span,
) -> Ty {
    let names = type_params(cx, id);
    if cx.checker.temporal_types.contains(&id) {
        cx.record_state(span);
    }
    if names.len() != args.len() {
        let decl = cx.checker.program.decl(id);
        let message = format!(
            "`{}` takes {}, found {}",
            decl.name,
            rpi_diag::with_noun(names.len(), "type argument"),
            args.len()
        );
        let diagnostic = Diagnostic::new(Code::RPI1010, message)
            .primary(span, "wrong number of type arguments")
            .secondary(decl.span, "declared here")
            .help(type_args::type_args_help(cx, &decl.name, names.len()));
        report::report_diagnostic(cx, diagnostic);
        return Ty::Unknown;
    }
    let mut statics = StaticBindings::new();
    for (name, arg) in names.into_iter().zip(args) {
        let Some(ty) = static_args::static_type(cx, arg) else {
            return Ty::Unknown;
        };
        statics.insert(name, StaticBinding::Type(ty));
    }
    let ty = type_decls::type_instance(cx.checker, id, Rc::new(statics));
    if cx.checker.temporal_types.contains(&id) {
        cx.record_state(span);
    }
    ty
}

/// Returns the names of the type parameters of a declared type.
fn type_params(cx: &Body<'_, '_>, id: DeclId) -> Vec<Name> {
    let DeclKind::Type(def) = cx.checker.program.decl(id).kind else {
        return Vec::new();
    };
    let params = static_params(&def.statics).into_iter();
    params
        .filter(|p| matches!(p, StaticParamDecl::Type(..)))
        .map(|p| p.name().name.clone())
        .collect()
}

/// Returns a declared type in which its type parameters are still unknown.
fn open_type(cx: &mut Body<'_, '_>, id: DeclId) -> Ty {
    let names = type_params(cx, id).into_iter();
    let statics = names.map(|name| (name.clone(), StaticBinding::Type(Ty::Generic(name))));
    type_decls::type_instance(cx.checker, id, Rc::new(statics.collect()))
}

/// Returns a declared type with the type arguments in `subst`; `None` if some are not inferred.
fn inferred_type(cx: &mut Body<'_, '_>, id: DeclId, subst: &Substitution) -> Option<Ty> {
    let mut statics = StaticBindings::new();
    for name in type_params(cx, id) {
        let ty = subst.types.get(&name)?.clone();
        statics.insert(name, StaticBinding::Type(ty));
    }
    Some(type_decls::type_instance(cx.checker, id, Rc::new(statics)))
}

/// Returns the generic struct of a literal without type arguments; `None` for other literals.
pub(crate) fn generic_struct(cx: &mut Body<'_, '_>, value: &StructExpr) -> Option<DeclId> {
    if !value.statics.is_empty() {
        return None;
    }
    let found = cx
        .checker
        .program
        .lookup_in(NameSpace::Type, cx.module, &value.ty.name);
    let Lookup::Found(id) = found else {
        return None;
    };
    (!type_params(cx, id).is_empty()).then_some(id)
}

/// Checks a literal of a generic struct, infers its type arguments from the fields, and returns it.
pub(crate) fn inferred_struct<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    value: &'a StructExpr,
    span: Span,
) -> ExprId {
    let Ty::Struct(open) = open_type(cx, id) else {
        return cx.error_expr(span);
    };
    let mut subst = Substitution::default();
    let values: Vec<(&FieldValue, ExprId)> = value
        .fields
        .iter()
        .map(|field| (field, expr::check_expr(cx, &field.value)))
        .collect();
    for (at, (field, given)) in values.iter().enumerate() {
        let wanted = open
            .fields
            .iter()
            .find(|f| f.name.as_ref() == Some(&field.field.name));
        if let Some(wanted) = wanted {
            exact_time::convert_time_for(cx, *given, &wanted.ty);
        }
        let found = cx.ty_of(*given).clone();
        if let Some(wanted) = wanted
            && let Err(misfit) = check_assignable(&wanted.ty, &found, &mut subst)
        {
            let expected = wanted.ty.substituted(&subst);
            let reason = type_args::same_type_reason(cx, &open, &values[..at], &wanted.ty);
            report::type_mismatch(cx, *given, &expected, &misfit, &reason);
            return cx.error_expr(span);
        }
    }
    match inferred_type(cx, id, &subst) {
        Some(Ty::Struct(ty)) => {
            let given = compose::match_fields(cx, &ty, &values);
            let parts = given.and_then(|given| compose::fill_fields(cx, &ty, &given, None, span));
            match parts {
                Some(parts) => cx.add(TypedKind::Build(parts.into()), Ty::Struct(ty), span),
                None => cx.add(TypedKind::Error, Ty::Struct(ty), span),
            }
        }
        _ => report_uninferred_params(cx, &value.ty, span),
    }
}

/// Reports that the type arguments of `name` cannot be inferred. Returns an expression without a value.
fn report_uninferred_params(cx: &mut Body<'_, '_>, name: &Ident, span: Span) -> ExprId {
    let message = format!("cannot infer the type arguments of `{}`", name.name);
    let diagnostic = Diagnostic::new(Code::RPI2007, message)
        .primary(name.span, "no given field has the type of a type parameter")
        .help(type_args::struct_args_help(cx, &name.name, span));
    cx.report_error_expr(diagnostic, span)
}

/// Returns the type that a `datatype` defines: an enum if no alternative has parts, else a struct.
pub(crate) fn resolve_datatype<'a>(
    cx: &mut Body<'_, 'a>,
    def: &'a TypeDef,
    name: Name,
    all: &'a [Constructor],
) -> Ty {
    let values = all.iter().map(|c| c.name.name.clone()).collect();
    let tag = Ty::Enum(Rc::new(EnumTy::new(name.clone(), values)));
    if def.statics.is_empty() && all.iter().all(|c| c.fields.is_empty()) {
        return tag;
    }
    let mut fields = vec![Member {
        name: Some(TAG.into()),
        ty: tag,
    }];
    let mut seen: Vec<&Ident> = Vec::new();
    for constructor in all {
        fields.extend(type_decls::check_fields(cx, &constructor.fields));
        for name in constructor.fields.iter().flat_map(|field| &field.names) {
            match seen.iter().find(|first| first.name == name.name) {
                Some(first)
                    if constructor
                        .fields
                        .iter()
                        .all(|f| !f.names.iter().any(|n| n.span == first.span)) =>
                {
                    let diagnostic =
                        crate::program::duplicate_name_error(&name.name, name.span, first.span);
                    report::report_diagnostic(cx, diagnostic);
                }
                Some(_) => {}
                None => seen.push(name),
            }
        }
    }
    let defaults = vec![None; fields.len()];
    Ty::Struct(Rc::new(StructTy {
        name,
        fields,
        defaults,
    }))
}

/// Returns the alternatives of a type declared as a `datatype`; empty for any other declaration.
fn constructors<'a>(cx: &Body<'_, 'a>, id: DeclId) -> &'a [Constructor] {
    match cx.checker.program.decl(id).kind {
        DeclKind::Type(def) => match def.ty.as_ref().map(|ty| &ty.kind) {
            Some(TypeKind::Datatype(all)) => all,
            _ => &[],
        },
        _ => &[],
    }
}

/// Returns whether a type is declared as a `datatype`.
pub(crate) fn is_datatype(cx: &Body<'_, '_>, id: DeclId) -> bool {
    !constructors(cx, id).is_empty()
}

/// Returns the index of the alternative's first field in the datatype's struct, and the number of its fields.
pub(crate) fn constructor_field_range(cx: &Body<'_, '_>, ty: DeclId, index: u32) -> (usize, usize) {
    let count = |c: &Constructor| {
        c.fields
            .iter()
            .map(|field| field.names.len())
            .sum::<usize>()
    };
    let all = constructors(cx, ty);
    let index = (index as usize).min(all.len());
    let before: usize = all[..index].iter().map(count).sum();
    (1 + before, all.get(index).map_or(0, count))
}

/// Checks `A(x, y)` or `A@<int>`, a value of a `datatype`, and returns its typed expression.
pub(crate) fn constructor_value<'a>(
    cx: &mut Body<'_, 'a>,
    (id, index): (DeclId, u32),
    types: &'a [StaticArg],
    values: &[ExprId],
    span: Span,
) -> ExprId {
    let (from, count) = constructor_field_range(cx, id, index);
    let name = &constructors(cx, id)[index as usize].name;
    if count != values.len() {
        let parts = constructors(cx, id)[index as usize].fields.iter();
        let parts = parts.flat_map(|field| &field.names);
        let parts: Vec<&str> = parts.map(|part| part.name.as_str()).collect();
        return report_part_count(cx, name, &parts, values.len(), span);
    }
    let output = (!types.is_empty()).then(|| type_instance_for(cx, id, types, span));
    let open = output.clone().unwrap_or_else(|| open_type(cx, id));
    let Ty::Struct(open) = open else {
        return cx.error_expr(span);
    };
    let mut subst = Substitution::default();
    for (field, value) in open.fields[from..].iter().zip(values) {
        exact_time::convert_time_for(cx, *value, &field.ty);
        let found = cx.ty_of(*value).clone();
        if let Err(misfit) = check_assignable(&field.ty, &found, &mut subst) {
            let expected = field.ty.substituted(&subst);
            report::type_mismatch(
                cx,
                *value,
                &expected,
                &misfit,
                &ExpectationReason::Unexplained,
            );
            return cx.error_expr(span);
        }
    }
    let Some(Ty::Struct(ty)) = output.or_else(|| inferred_type(cx, id, &subst)) else {
        return report_uninferred_params(cx, name, span);
    };
    let mut parts = Vec::with_capacity(ty.fields.len());
    for (k, field) in ty.fields.iter().enumerate() {
        parts.push(match k.checked_sub(from).and_then(|k| values.get(k)) {
            Some(value) => *value,
            None if k == 0 => cx.add(
                TypedKind::Literal(Leaf::int(index.into())),
                field.ty.clone(),
                span,
            ),
            None => cx.add(
                TypedKind::Const(filler_value(&field.ty)),
                field.ty.clone(),
                span,
            ),
        });
    }
    cx.add(TypedKind::Build(parts.into()), Ty::Struct(ty), span)
}

/// Reports an alternative that takes `count` parts but is used with `given` parts.
pub(crate) fn report_part_count(
    cx: &mut Body<'_, '_>,
    name: &Ident,
    parts: &[&str],
    given: usize,
    span: Span,
) -> ExprId {
    let count = parts.len();
    let message = format!(
        "`{}` takes {}, found {given}",
        name.name,
        rpi_diag::with_noun(count, "part")
    );
    let diagnostic = Diagnostic::new(Code::RPI1010, message)
        .primary(span, "wrong number of parts")
        .secondary(name.span, "declared here")
        .help(match count {
            0 => format!("write only its name: `{}`", name.name),
            _ => format!(
                "write {}: `{}({})`",
                ["one value for each part", "one value"][usize::from(count == 1)],
                name.name,
                parts.join(", ")
            ),
        });
    cx.report_error_expr(diagnostic, span)
}

/// Returns the alternatives of a value's type and an expression with the index of its alternative. Reports other types.
pub(crate) fn alternatives(cx: &mut Body<'_, '_>, value: ExprId) -> Option<(Rc<EnumTy>, ExprId)> {
    let span = cx.span_of(value);
    let tag = match cx.ty_of(value).clone() {
        Ty::Enum(all) => return Some((all, value)),
        Ty::Struct(ty) => ty.fields.first().map(|field| field.ty.clone()),
        _ => None,
    };
    if let Some(Ty::Enum(all)) = tag {
        let tag = cx.add(
            TypedKind::Part { base: value, at: 0 },
            Ty::Enum(all.clone()),
            span,
        );
        return Some((all, tag));
    }
    let ty = cx.ty_of(value).clone();
    if !ty.is_unknown() {
        let name = report::operand_name(cx, value);
        let message = format!("expected a datatype, found `{ty}`");
        let diagnostic = Diagnostic::new(Code::RPI2001, message)
            .primary(span, format!("this is `{ty}`"))
            .help(format!(
                "give `{name}` the datatype to which the cases belong, or choose by `if {name} = {} then ... else ...`",
                ty.zero_or_dots()
            ));
        report::report_diagnostic(cx, diagnostic);
    }
    None
}

/// Adds a test whether `tag`, the index of an alternative of a datatype, is `index`, and returns it.
pub(crate) fn tag_test(
    cx: &mut Body<'_, '_>,
    all: &Rc<EnumTy>,
    tag: ExprId,
    index: usize,
    span: Span,
) -> ExprId {
    let index = cx.add(
        TypedKind::Literal(Leaf::int(index as i64)),
        Ty::Enum(all.clone()),
        span,
    );
    ops::binary_prim(cx, rpi_syntax::ops::BinaryOp::Eq, tag, index, span)
}

/// Reports a name in a `match` or a test that is not an alternative of the datatype `all`.
pub(crate) fn report_unknown_alternative(cx: &mut Body<'_, '_>, all: &EnumTy, name: &Ident) {
    let near = rpi_diag::suggest(&name.name, all.values.iter().map(Name::as_str));
    let diagnostic = undefined_name("alternative", &name.name, name.span, near);
    let names = join_names(all.values.iter().map(Name::as_str));
    report::report_diagnostic(
        cx,
        diagnostic.help(format!("the alternatives of `{}` are {names}", all.name)),
    );
}

/// Checks the test `A?(x)`, whether a value has the alternative `A`, and returns its typed expression.
pub(crate) fn constructor_test<'a>(
    cx: &mut Body<'_, 'a>,
    of: &'a ConstructorTest,
    span: Span,
) -> ExprId {
    let value = expr::check_expr(cx, &of.value);
    let Some((all, tag)) = alternatives(cx, value) else {
        return cx.add(TypedKind::Error, Ty::Bool, span);
    };
    match all
        .values
        .iter()
        .position(|name| *name == of.constructor.name)
    {
        Some(index) => tag_test(cx, &all, tag, index, span),
        None => {
            report_unknown_alternative(cx, &all, &of.constructor);
            cx.add(TypedKind::Error, Ty::Bool, span)
        }
    }
}

/// Returns the leaves (scalar parts) of the value 0 or false of a type.
fn zero_value(ty: &Ty) -> Rc<[Leaf]> {
    let mut leaves = Vec::with_capacity(ty.leaf_count());
    ty.for_each_leaf(&mut |_, ty| {
        leaves.push(match ty {
            Ty::Bool => Leaf::bool(false),
            Ty::Real(_) | Ty::Duration => Leaf::real(0.0),
            _ => Leaf::int(0),
        });
    });
    leaves.into()
}

/// Returns the value of fields that belong to other alternatives: zeros, or the nearest value in a subrange.
fn filler_value(ty: &Ty) -> Rc<[Leaf]> {
    let mut leaves = zero_value(ty).to_vec();
    for (at, range) in ty.subranges(true) {
        leaves[at] = Leaf::int(range.clamp(0));
    }
    leaves.into()
}
