//! Types of values. A device is not one: it is a parameter whose ports have values.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::wrong_kind_of_name;
use crate::check::types;
use crate::program::{DeclId, DeclKind, Lookup, NameSpace};
use crate::ty::Ty;
use rpi_diag::{Code, Diagnostic, Quote, Span};
use rpi_syntax::ast::{Type, TypeKind};

/// Returns the type of a value. Reports a device type, because a device is not a value.
pub(crate) fn resolve_value_type<'a>(cx: &mut Body<'_, 'a>, ty: &'a Type) -> Ty {
    // Recognised by its name alone: the declaration of the device may need this very type.
    if let Some(device) = named_device(cx, ty) {
        let declared = cx.checker.program.decl(device);
        return device_as_value(cx, &declared.name, ty.span, declared.span);
    }
    match types::resolve_type(cx, ty) {
        Ty::Device(device) => {
            let message = format!("`{}` is a device, not a type of values", device.name);
            let diagnostic = Diagnostic::new(Code::RPI1003, message).primary(
                ty.span,
                format!(
                    "`{}` is another name of `{}`",
                    Quote::text(ty.span),
                    device.name
                ),
            );
            report::report_diagnostic(cx, diagnostic.help(DEVICE_HELP));
            Ty::Unknown
        }
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
    "use a type of values here; a device is declared as a parameter of a command, fragment or node";
