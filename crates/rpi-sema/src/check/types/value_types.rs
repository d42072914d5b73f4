//! Types of values. A device is not one: it is a parameter whose ports have values.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::wrong_kind_of_name;
use crate::check::types;
use crate::program::{DeclId, DeclKind, Lookup, NameSpace};
use crate::ty::Ty;
use rpi_diag::Span;
use rpi_syntax::ast::{Type, TypeKind};

/// Resolves the type of a value; reports a device.
pub(crate) fn resolve_value_type<'a>(cx: &mut Body<'_, 'a>, ty: &'a Type) -> Ty {
    // Recognised by its name alone: the declaration of the device may need this very type.
    if let Some(device) = named_device(cx, ty) {
        let declared = cx.checker.program.decl(device);
        return device_as_value(cx, &declared.name, ty.span, declared.span);
    }
    match types::resolve_type(cx, ty) {
        Ty::Device(device) => device_as_value(cx, &device.name, ty.span, Span::NONE),
        ty => ty,
    }
}

fn device_as_value(cx: &mut Body<'_, '_>, name: &str, at: Span, declared: Span) -> Ty {
    let diagnostic = wrong_kind_of_name("a type of values", name, "a device", at, declared);
    report::report_diagnostic(cx, diagnostic.help(DEVICE_HELP));
    Ty::Unknown
}

fn named_device(cx: &Body<'_, '_>, ty: &Type) -> Option<DeclId> {
    let TypeKind::Named(named) = &ty.kind else {
        return None;
    };
    let name = &named.name.name;
    match cx
        .checker
        .program
        .lookup_in(NameSpace::Type, cx.module, name)
    {
        Lookup::Found(id) if !cx.statics.contains_key(name) => {
            let kind = cx.checker.program.decl(id).kind;
            matches!(kind, DeclKind::Device(_)).then_some(id)
        }
        _ => None,
    }
}

const DEVICE_HELP: &str =
    "declare a device as a parameter of a command, fragment or node: `command C (arm: Arm)`";
