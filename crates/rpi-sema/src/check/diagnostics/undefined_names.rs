//! Diagnostics for undefined names: misspelt, from another language, or from a module that is not used.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::foreign;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::undefined_name;
use crate::check::types;
use rpi_diag::{Applicability, Code, Diagnostic, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;
use std::collections::{BTreeMap, BTreeSet};

/// Kind of name that a unit declares for itself, as it appears in messages.
pub(crate) const FLOW_KIND: &str = "flow";

/// Label of an undefined name that would be global and resembles no other name: see [`once_for_each_name`].
const NOT_DECLARED_ANYWHERE: &str = "not declared anywhere";

/// Maximum number of further locations shown.
const MAX_LOCATIONS: usize = 3;

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
        None if what == FLOW_KIND || near.is_some() => Some(undefined_name(what, name, span, near)),
        None => {
            let message = format!("undefined {what} `{name}`");
            Some(Diagnostic::new(Code::RPI1001, message).primary(span, NOT_DECLARED_ANYWHERE))
        }
    };
    if let Some(diagnostic) = diagnostic {
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Returns the diagnostic for a name of a module that is not used. Of several only the first is kept: see
/// [`once_for_each_fix`].
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

/// Reports an undefined type.
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
    let message = format!("undefined state `{}`", target.name);
    Diagnostic::new(Code::RPI1001, message).primary(target.span, NOT_DECLARED_ANYWHERE)
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
    Diagnostic::new(Code::RPI1005, message).primary(include.span, why)
}

/// Keeps the first of several diagnostics with the same single sure fix: the others follow from the same error.
pub(crate) fn dedup_by_fix(diagnostics: &mut Vec<Diagnostic>) {
    let mut seen: BTreeSet<(Span, String)> = BTreeSet::new();
    diagnostics.retain(|diagnostic| match &diagnostic.fixes[..] {
        [
            Fix {
                applicability: Applicability::Sure,
                edits,
                ..
            },
        ] => match &edits[..] {
            [edit] if !edit.text.is_empty() => seen.insert((edit.span, edit.text.clone())),
            _ => true,
        },
        _ => true,
    });
}

/// Keeps the first of several diagnostics about one undefined global name, and adds the locations of the others.
pub(crate) fn dedup_by_name(diagnostics: &mut Vec<Diagnostic>) {
    let mut places: BTreeMap<String, Vec<Span>> = BTreeMap::new();
    diagnostics.retain(|diagnostic| match &diagnostic.labels[..] {
        [label] if label.text == NOT_DECLARED_ANYWHERE && has_no_hints(diagnostic) => {
            let known = places.entry(diagnostic.message.clone()).or_default();
            known.push(label.span);
            known.len() == 1
        }
        _ => true,
    });
    for diagnostic in diagnostics {
        let is_it =
            (diagnostic.labels.first()).is_some_and(|label| label.text == NOT_DECLARED_ANYWHERE);
        let Some([_, others @ ..]) = places.get(&diagnostic.message).map(Vec::as_slice) else {
            continue;
        };
        if !is_it || !has_no_hints(diagnostic) {
            continue;
        }
        for span in others.iter().take(MAX_LOCATIONS) {
            *diagnostic = diagnostic.clone().secondary(*span, "also used here");
        }
        match others.len().saturating_sub(MAX_LOCATIONS) {
            0 => {}
            1 => diagnostic.help.push("used in one more place".to_owned()),
            more => diagnostic.help.push(format!("used in {more} more places")),
        }
    }
}

fn has_no_hints(diagnostic: &Diagnostic) -> bool {
    diagnostic.fixes.is_empty() && diagnostic.help.is_empty()
}
