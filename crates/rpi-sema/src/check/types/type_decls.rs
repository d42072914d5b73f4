//! Type declarations: structures, fields, instances of generic types.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::limits::nesting;
use crate::check::limits::nesting::is_within_size_limits;
use crate::check::reuse;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::types;
use crate::check::types::{consts, data, device, value_types};
use crate::check::{Checker, Lazy};
use crate::program::{DeclId, DeclKind};
use crate::ty::{EnumTy, Member, StructTy, Ty};
use crate::typed::Leaf;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Ident, TypeDef, TypeKind, VarDecl};
use std::rc::Rc;

/// Checks the declaration of a type or device type on its own. Type parameters stand for unknown types.
pub(crate) fn check_type(checker: &mut Checker<'_>, id: DeclId) {
    match checker.program.decl(id).kind {
        DeclKind::Type(def) => {
            let params =
                crate::check::signatures::static_params::static_params(&def.statics).into_iter();
            let open = params.map(|param| {
                let name = param.name().name.clone();
                (name.clone(), StaticBinding::Type(Ty::Generic(name)))
            });
            type_instance(checker, id, Rc::new(open.collect()));
        }
        DeclKind::Device(device) => device::check_device(checker, id, device),
        _ => {}
    }
}

/// Returns the type that a declaration without static parameters declares.
pub(crate) fn type_decl(checker: &mut Checker<'_>, id: DeclId) -> Ty {
    type_instance(checker, id, Rc::default())
}

/// Returns the type that the declaration `id` declares for these static arguments, and checks it on first use.
pub(crate) fn type_instance(
    checker: &mut Checker<'_>,
    id: DeclId,
    statics: Rc<StaticBindings>,
) -> Ty {
    let key = crate::check::signatures::instance::instance_key(id, &statics);
    match checker.types.get(&key) {
        Some(Lazy::Done(ty)) => return ty.clone().unwrap_or(Ty::Unknown),
        Some(Lazy::InProgress) => {
            report_dependency_cycle(checker, "type", id);
            return Ty::Unknown;
        }
        None => {}
    }
    if !nesting::may_nest(checker, "type", checker.program.decl(id).span) {
        return Ty::Unknown;
    }
    // In progress before it is resolved, so that a type that depends on itself is detected.
    checker.types.insert(key.clone(), Lazy::InProgress);
    checker.in_progress.push(id);
    let before = checker.diagnostics.len();
    let ty = nesting::check_nested(checker, |checker| type_def(checker, id, statics));
    if checker.diagnostics.len() > before {
        reuse::taint(checker);
    }
    checker.in_progress.pop();
    checker.types.insert(key, Lazy::Done(Some(ty.clone())));
    ty
}

fn type_def(checker: &mut Checker<'_>, id: DeclId, statics: Rc<StaticBindings>) -> Ty {
    let DeclKind::Type(def) = checker.program.decl(id).kind else {
        return Ty::Unknown;
    };
    let mut body = Body::for_top_level(checker, id);
    body.statics = statics;
    let ty = resolve_type_def(&mut body, def);
    let is_temporal = body.first_state_span.is_some();
    body.finish();
    if is_temporal {
        checker.temporal_types.insert(id);
    }
    ty
}

/// Reports declarations that depend on one another, such as a struct that contains itself. `what` is the kind of
/// declaration.
pub(crate) fn report_dependency_cycle(checker: &mut Checker<'_>, what: &str, id: DeclId) {
    let from = checker
        .in_progress
        .iter()
        .position(|open| *open == id)
        .unwrap_or(0);
    let ring: Vec<_> = checker.in_progress[from..]
        .iter()
        .map(|id| checker.program.decl(*id))
        .collect();
    let name = &checker.program.decl(id).name;
    let way: Vec<String> = ring
        .iter()
        .map(|decl| format!("`{}` -> ", decl.name))
        .collect();
    let message = match ring.len() {
        0 | 1 => format!("the {what} `{name}` depends on itself"),
        _ => format!(
            "the {what} `{name}` depends on itself: {}`{name}`",
            way.concat()
        ),
    };
    let mut diagnostic = Diagnostic::new(Code::RPI1007, message);
    if ring.is_empty() {
        diagnostic = with_alias_labels(checker, diagnostic, id);
    }
    for (k, decl) in ring.iter().enumerate() {
        let next = &ring[(k + 1) % ring.len()].name;
        let text = format!("`{}` depends on `{next}`", decl.name);
        diagnostic = match k {
            0 => diagnostic.primary(decl.span, text),
            _ => diagnostic.secondary(decl.span, text),
        };
        diagnostic = match field_of_type(decl.kind, next) {
            Some(span) => diagnostic.secondary(span, format!("a part of type `{next}`")),
            None => diagnostic,
        };
    }
    let help = match what {
        "constant" => "give one of these constants a value of its own",
        "type" => {
            "a type has a fixed size, so that no part of it can have the same type: delete this part, or declare an array of a fixed size, such as `int^8`, and a number of used elements"
        }
        _ => "break the dependency cycle: let one of these names stand for a node with a body",
    };
    checker.diagnostics.push(diagnostic.help(help));
}

/// Labels the aliases of nodes on a dependency cycle, which begins with the declaration `id`.
fn with_alias_labels(checker: &Checker<'_>, diagnostic: Diagnostic, id: DeclId) -> Diagnostic {
    let from = checker.aliases.iter().position(|open| *open == id);
    let alone = [id];
    let ring = from.map_or(&alone[..], |from| &checker.aliases[from..]);
    let mut diagnostic = diagnostic;
    for (k, alias) in ring.iter().enumerate() {
        let (decl, next) = (
            checker.program.decl(*alias),
            checker.program.decl(ring[(k + 1) % ring.len()]),
        );
        let text = format!("`{}` is another name of `{}`", decl.name, next.name);
        diagnostic = match k {
            0 => diagnostic.primary(decl.span, text),
            _ => diagnostic.secondary(decl.span, text),
        };
    }
    diagnostic
}

/// Returns the place of the first field or part of a declared type whose own type is the type `name`.
fn field_of_type(kind: DeclKind<'_>, name: &Name) -> Option<Span> {
    let DeclKind::Type(def) = kind else {
        return None;
    };
    let fields: Vec<&VarDecl> = match &def.ty.as_ref()?.kind {
        TypeKind::Struct(fields) => fields.iter().collect(),
        TypeKind::Datatype(all) => all.iter().flat_map(|one| &one.fields).collect(),
        _ => return None,
    };
    let is_named = |ty: &rpi_syntax::ast::Type| match &ty.kind {
        TypeKind::Named(named) => named.name.name == *name,
        TypeKind::Array(array) => {
            matches!(&array.element.kind, TypeKind::Named(named) if named.name.name == *name)
        }
        _ => false,
    };
    let mut fields = fields.into_iter();
    fields
        .find(|field| is_named(&field.ty))
        .map(|field| field.ty.span)
}

fn resolve_type_def<'a>(cx: &mut Body<'_, 'a>, def: &'a TypeDef) -> Ty {
    let name = type_name(cx, def);
    match def.ty.as_ref().map(|ty| (&ty.kind, ty)) {
        None => Ty::Struct(Rc::new(StructTy {
            name,
            fields: Vec::new(),
            defaults: Vec::new(),
        })),
        Some((TypeKind::Enum(values), _)) => {
            let values = values.iter().map(|v| v.name.name.clone()).collect();
            Ty::Enum(Rc::new(EnumTy::new(name, values)))
        }
        Some((TypeKind::Datatype(all), _)) => data::resolve_datatype(cx, def, name, all),
        Some((TypeKind::Struct(fields), _)) => resolve_struct(cx, def, name, fields),
        Some((_, ty)) => types::resolve_type(cx, ty),
    }
}

/// Returns the name of a declared type with its static arguments, for messages.
fn type_name(cx: &Body<'_, '_>, def: &TypeDef) -> Name {
    let params = crate::check::signatures::static_params::static_params(&def.statics);
    crate::check::signatures::instance::instance_name(
        cx.checker.program,
        &def.name.name,
        &params,
        &cx.statics,
    )
}

fn resolve_struct<'a>(
    cx: &mut Body<'_, 'a>,
    def: &'a TypeDef,
    name: Name,
    fields: &'a [VarDecl],
) -> Ty {
    let known = check_fields(cx, fields);
    if !is_within_size_limits(&known) {
        let diagnostic = Diagnostic::new(Code::RPI2009, "the struct is too large").primary(
            def.name.span,
            "too many parts, or structs nested too deeply",
        );
        report::report_diagnostic(cx, diagnostic);
        return Ty::Unknown;
    }
    Ty::Struct(Rc::new(StructTy {
        name,
        fields: known,
        defaults: field_defaults(cx, fields),
    }))
}

pub(crate) fn check_fields<'a>(cx: &mut Body<'_, 'a>, decls: &'a [VarDecl]) -> Vec<Member> {
    let mut fields: Vec<Member> = Vec::new();
    let names = || decls.iter().flat_map(|decl| &decl.names);
    for decl in decls {
        let ty = value_types::resolve_value_type(cx, &decl.ty);
        for name in &decl.names {
            let first = names().take(fields.len()).find(|n| n.name == name.name);
            if let Some(first) = first {
                let diagnostic =
                    crate::program::duplicate_name_error(&name.name, name.span, first.span);
                report::report_diagnostic(cx, diagnostic);
            }
            fields.push(Member {
                name: Some(name.name.clone()),
                ty: ty.clone(),
            });
        }
    }
    fields
}

fn field_defaults<'a>(cx: &mut Body<'_, 'a>, decls: &'a [VarDecl]) -> Vec<Option<Rc<[Leaf]>>> {
    let mut defaults = Vec::new();
    for decl in decls {
        let default = decl.default.as_ref().map(|value| {
            let ty = types::resolve_type(cx, &decl.ty);
            // An invalid default, which has been reported, is empty.
            consts::const_value(cx, value, &ty).unwrap_or_default()
        });
        defaults.extend(decl.names.iter().map(|_| default.clone()));
    }
    defaults
}

/// Returns the diagnostic for a type parameter `name` in a unit whose type `ty` is not a type of reals.
pub(crate) fn not_a_quantity(name: &Ident, ty: &Ty) -> Diagnostic {
    let message = match ty.to_string() == name.name.as_str() {
        // The body is checked for all types of this parameter.
        true => format!("`{ty}` may be a type without unit"),
        false => format!("`{}` is `{ty}` here, which has no unit", name.name),
    };
    Diagnostic::new(Code::RPI2003, message).primary(name.span, "expected a type of reals")
}
