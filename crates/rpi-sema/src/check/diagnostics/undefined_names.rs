//! Diagnostics for undefined names: misspelt, from another language, or from a module that is not used.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::foreign;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::undefined_name;
use crate::check::signatures::unit;
use crate::check::types;
use rpi_diag::{Code, Diagnostic, Fix, Span, Subject};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;

/// Kind of the names of flows, as it appears in messages about undefined names.
pub(crate) const FLOW_KIND: &str = "flow";

/// Returns the diagnostic for an undefined name that resembles no other name. `what` is the kind of name. Only one
/// diagnostic is shown for each such name.
fn not_declared_anywhere(what: &str, name: &str, span: Span) -> Diagnostic {
    let message = format!("undefined {what} `{name}`");
    Diagnostic::new(Code::RPI1001, message)
        .primary(span, "not declared anywhere")
        .about(Subject::UndefinedName(format!("{what} {name}")))
}

/// Reports an undefined name. `what` is its kind, such as "flow", and `near` is the most similar defined name.
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
        Some(module) => {
            let start = cx.checker.program.start_of_file(span);
            Some(name_of_unused_module(what, name, module, (span, start)))
        }
        None if what == FLOW_KIND || near.is_some() => {
            let help = near.is_none().then(|| declaration_help(cx, name));
            let mut diagnostic = undefined_name(what, name, span, near);
            diagnostic.help.extend(help);
            Some(diagnostic)
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

/// Returns the advice to declare a flow. In RPI an equation declares it.
pub(crate) fn declaration_help(cx: &Body<'_, '_>, name: &str) -> String {
    match unit::reads_rpi_syntax(cx) {
        true => format!(
            "define it by an equation, `{name} = ...;`, or declare it as a port or a constant"
        ),
        false => format!("declare `{name}` as a port, as a constant, or by `var` before `let`"),
    }
}

/// Reports the read of an undefined flow, and records the diagnostic so that an equation for the same name can add a
/// help text to it.
pub(crate) fn report_undefined_flow(cx: &mut Body<'_, '_>, name: &Name, diagnostic: Diagnostic) {
    let index = cx.diagnostics.len();
    report::report_diagnostic(cx, diagnostic);
    if cx.diagnostics.len() > index {
        cx.reported.undefined_flows.record(name, index);
    }
}

/// Returns the diagnostic for a name that is declared in the standard module `module`, which the file does not use. The
/// fix adds the `use` at the location `start`. `what` is the kind of name.
fn name_of_unused_module(
    what: &str,
    name: &str,
    module: &'static str,
    (span, start): (Span, Span),
) -> Diagnostic {
    let fix =
        Fix::sure(format!("use the module `{module}`")).replace(start, format!("use {module};\n"));
    Diagnostic::new(Code::RPI1001, format!("undefined {what} `{name}`"))
        .primary(
            span,
            format!("declared in the module `{module}`, which is not used"),
        )
        .fix(fix)
}

/// Reports an undefined type name, with its equivalent if it is a type of another language.
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

/// Name of the absent value.
const NONE: &str = "none";

/// Reports a name from another language. `what` is the kind of name, and `here` is the equivalent in RPI.
pub(crate) fn report_foreign_name(
    cx: &mut Body<'_, '_>,
    what: &str,
    name: &str,
    span: Span,
    here: &str,
) {
    if here == NONE && !name.eq_ignore_ascii_case(NONE) {
        let diagnostic = Diagnostic::new(Code::RPI1001, format!("undefined {what} `{name}`"))
            .primary(span, "here an absent value is called `none`")
            .help("only an optional flow, of a type such as `real?`, can be absent: test one by `present(x)`, and give it a default by `x ?? 0.0`")
            .help("a flow of any other type has a value in every cycle, so that it needs no test");
        return report::report_diagnostic(cx, diagnostic);
    }
    let title = format!("write `{here}`");
    let fix = match foreign::is_exact_equivalent(name, here) {
        true => Fix::sure(title),
        false => Fix::maybe(title),
    };
    let diagnostic = Diagnostic::new(Code::RPI1001, format!("undefined {what} `{name}`"))
        .primary(span, format!("here it is called `{here}`"))
        .fix(fix.replace(span, here));
    let diagnostic = match foreign::usage(here) {
        Some(usage) => diagnostic.help(format!("it is called with these arguments: `{usage}`")),
        None => diagnostic,
    };
    report::report_diagnostic(cx, diagnostic);
}

/// Returns the diagnostic for a state that no automaton around a transition has; `near` is the most similar of its
/// `states`.
pub(crate) fn undefined_state<'n>(
    target: &Ident,
    near: Option<String>,
    states: impl Iterator<Item = &'n str>,
) -> Diagnostic {
    if near.is_some() {
        return undefined_name("state", &target.name, target.span, near);
    }
    let listed: Vec<&str> = states.take(MAX_LISTED_STATES).collect();
    let label = match &listed[..] {
        [only] => format!("the only state of this automaton is `{only}`"),
        all if all.len() < MAX_LISTED_STATES => format!(
            "the states of this automaton are {}",
            report::join_names(listed)
        ),
        _ => "not a state of this automaton".to_owned(),
    };
    let mut diagnostic = not_declared_anywhere("state", &target.name, target.span);
    diagnostic.labels[0].text = label;
    diagnostic
}

/// Number of states from which a diagnostic does not list them.
const MAX_LISTED_STATES: usize = 9;

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

/// Returns the diagnostic for a module that does not exist. `known` are the names of the existing modules, for a
/// suggestion.
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

/// Returns the diagnostic for an included file that does not exist. `is_alone` is whether the program is a single text
/// without files next to it.
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
