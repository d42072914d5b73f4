//! Diagnostics for undefined names: misspelt, from another language, or from a module that is not used.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::foreign;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::undefined_name;
use crate::check::types;
use rpi_diag::{Code, Diagnostic, Fix, Span, Subject};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;

/// Kind of name that a unit declares for itself, as it appears in messages.
pub(crate) const FLOW_KIND: &str = "flow";

/// Returns the diagnostic for an undefined global name that resembles no other name. It is reported once for each name.
fn not_declared_anywhere(what: &str, name: &str, span: Span) -> Diagnostic {
    let message = format!("undefined {what} `{name}`");
    Diagnostic::new(Code::RPI1001, message)
        .primary(span, "not declared anywhere")
        .about(Subject::UndefinedName(format!("{what} {name}")))
}

/// Reports an undefined name; `what` is its kind, `near` the most similar defined name.
pub(crate) fn report_undefined(
    cx: &mut Body<'_, '_>,
    what: &str,
    name: &Name,
    span: Span,
    near: Option<String>,
) {
    let lacks_use = cx.checker.program.module(cx.module).lacks_use;
    let declaring = (cx.checker.program.library.declaring)(name);
    let declaring = declaring.filter(|module| !cx.checker.program.is_hidden(module, name));
    let diagnostic = match declaring {
        _ if lacks_use && near.is_none() => None,
        Some(module) => Some(name_of_unused_module(what, name, module, span)),
        None if what == FLOW_KIND || near.is_some() => {
            Some(undefined_name_with_help(what, name, span, near))
        }
        None => Some(not_declared_anywhere(what, name, span)),
    };
    if let Some(diagnostic) = diagnostic {
        match what == FLOW_KIND {
            true => report_undefined_flow(cx, name, diagnostic),
            false => report::report_diagnostic(cx, diagnostic),
        }
    }
}

/// Returns the diagnostic for an undefined name, with the places of its declaration if no name is similar.
fn undefined_name_with_help(
    what: &str,
    name: &Name,
    span: Span,
    near: Option<String>,
) -> Diagnostic {
    let help = near.is_none().then(|| declaration_help(name));
    let diagnostic = undefined_name(what, name, span, near);
    match help {
        Some(help) => diagnostic.help(help),
        None => diagnostic,
    }
}

/// Returns the advice to declare a flow.
pub(crate) fn declaration_help(name: &str) -> String {
    format!("declare `{name}` as a port, as a constant, or by `var` before `let`")
}

/// Reports an undefined flow, and records its diagnostic: an equation of that name adds a help text to it.
pub(crate) fn report_undefined_flow(cx: &mut Body<'_, '_>, name: &Name, diagnostic: Diagnostic) {
    let index = cx.diagnostics.len();
    report::report_diagnostic(cx, diagnostic);
    if cx.diagnostics.len() > index {
        cx.reported.undefined_flows.record(name, index);
    }
}

/// Returns the diagnostic for a name of a module that is not used. Of several only the first is
/// reported, because their fixes are the same.
fn name_of_unused_module(what: &str, name: &str, module: &'static str, span: Span) -> Diagnostic {
    let start = Span {
        start: 0,
        end: 0,
        ..span
    };
    let fix =
        Fix::sure(format!("use the module `{module}`")).replace(start, format!("use {module};\n"));
    Diagnostic::new(Code::RPI1001, format!("undefined {what} `{name}`"))
        .primary(
            span,
            format!("declared in the module `{module}`, which is not used"),
        )
        .fix(fix)
}

/// Reports the name of a type that is not declared, with its equivalent if it is a type of another language.
pub(crate) fn report_undefined_type(cx: &mut Body<'_, '_>, name: &Name, span: Span) {
    if let Some(here) = foreign::type_equivalent(name) {
        return report_foreign_name(cx, "type", name, span, here);
    }
    if let Some(help) = foreign::foreign_type_help(name) {
        let message = format!("undefined type `{name}`");
        let diagnostic =
            Diagnostic::new(Code::RPI1001, message).primary(span, "a type of another language");
        return report::report_diagnostic(cx, diagnostic.help(help));
    }
    let near = types::similar_type(cx, name);
    report_undefined(cx, "type", name, span, near);
}

/// Reports a name from another language; `here` is the name in this one.
pub(crate) fn report_foreign_name(
    cx: &mut Body<'_, '_>,
    what: &str,
    name: &str,
    span: Span,
    here: &str,
) {
    let title = format!("write `{here}`");
    let fix = match foreign::is_exact_equivalent(name, here) {
        true => Fix::sure(title),
        false => Fix::maybe(title),
    };
    let diagnostic = Diagnostic::new(Code::RPI1001, format!("undefined {what} `{name}`"))
        .primary(span, format!("here it is called `{here}`"))
        .fix(fix.replace(span, here));
    report::report_diagnostic(cx, diagnostic);
}

/// Returns the diagnostic for a state that no automaton around a transition has; `near` is the most similar state.
pub(crate) fn undefined_state(target: &Ident, near: Option<String>) -> Diagnostic {
    if near.is_some() {
        return undefined_name("state", &target.name, target.span, near);
    }
    not_declared_anywhere("state", &target.name, target.span)
}

/// Returns the diagnostic for a transition to a state of another automaton.
pub(crate) fn state_in_other_automaton(target: &Ident, declared: Span) -> Diagnostic {
    let name = &target.name;
    let message = format!("`{name}` is a state of another automaton");
    Diagnostic::new(Code::RPI1001, message)
        .primary(
            target.span,
            "a transition must lead to a state of the same automaton",
        )
        .secondary(declared, "declared here")
        .help("name a state of this automaton, or move the state into it")
}

/// Returns the diagnostic for a module that does not exist; `known` are the names of the existing modules.
pub(crate) fn module_not_found<'n>(
    name: &str,
    span: Span,
    known: impl Iterator<Item = &'n str>,
) -> Diagnostic {
    Diagnostic::new(Code::RPI1005, format!("cannot find module `{name}`"))
        .primary(
            span,
            "neither in the standard library nor next to this file",
        )
        .did_you_mean(span, rpi_diag::suggest(name, known))
}

/// Returns the diagnostic for an included file that does not exist. `is_alone` says that the program has no files next
/// to it.
#[must_use]
pub fn file_not_found(include: &Ident, is_alone: bool) -> Diagnostic {
    let why = match is_alone {
        true => "this program has no files next to it",
        false => "no such text file next to this file",
    };
    let message = format!("cannot find file `{}`", include.name);
    Diagnostic::new(Code::RPI1005, message)
        .primary(include.span, why)
        .help("correct the path, which is relative to the folder of this file, or add the file")
}
