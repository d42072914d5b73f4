//! Diagnostics for undefined names: misspelt, from another language, or from a module that is not used.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::foreign;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::unknown;
use crate::check::types;
use rpi_diag::{Applicability, Code, Finding, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;
use std::collections::{BTreeMap, BTreeSet};

/// Kind of name that a unit declares for itself, as it appears in messages.
pub(crate) const FLOW: &str = "flow";

/// Label of an undefined name that would be global and resembles no other name: see [`once_for_each_name`].
const NOWHERE: &str = "not declared anywhere";

/// Maximum number of further locations shown.
const MAX_PLACES: usize = 3;

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
    let finding = match declaring {
        _ if lacks_use && near.is_none() => None,
        Some(module) => Some(name_of_unused_module(what, name, module, span)),
        None if what == FLOW || near.is_some() => Some(unknown(what, name, span, near)),
        None => {
            let message = format!("undefined {what} `{name}`");
            Some(Finding::new(Code::RPI1001, message).at(span, NOWHERE))
        }
    };
    if let Some(finding) = finding {
        report::report_diagnostic(cx, finding);
    }
}

/// Returns the diagnostic for a name of a module that is not used. Of several only the first is kept: see
/// [`once_for_each_fix`].
fn name_of_unused_module(what: &str, name: &str, module: &'static str, span: Span) -> Finding {
    let start = Span {
        start: 0,
        end: 0,
        ..span
    };
    let fix =
        Fix::sure(format!("use the module `{module}`")).replace(start, format!("use {module};\n"));
    Finding::new(Code::RPI1001, format!("undefined {what} `{name}`"))
        .at(
            span,
            format!("declared in the module `{module}`, which is not used"),
        )
        .fix(fix)
}

/// Reports an undefined type.
pub(crate) fn report_undefined_type(cx: &mut Body<'_, '_>, name: &Name, span: Span) {
    if let Some(here) = foreign::type_here(name) {
        return report_foreign_name(cx, "type", name, span, here);
    }
    if let Some(help) = foreign::no_type(name) {
        let message = format!("undefined type `{name}`");
        let finding = Finding::new(Code::RPI1001, message).at(span, "a type of another language");
        return report::report_diagnostic(cx, finding.help(help));
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
    let fix = match foreign::differs_by_name(name, here) {
        true => Fix::sure(title),
        false => Fix::maybe(title),
    };
    let finding = Finding::new(Code::RPI1001, format!("undefined {what} `{name}`"))
        .at(span, format!("here it is called `{here}`"))
        .fix(fix.replace(span, here));
    report::report_diagnostic(cx, finding);
}

/// Returns the diagnostic for a state that no automaton around a transition has; `near` is the most similar state.
pub(crate) fn unknown_state(target: &Ident, near: Option<String>) -> Finding {
    if near.is_some() {
        return unknown("state", &target.name, target.span, near);
    }
    let message = format!("undefined state `{}`", target.name);
    Finding::new(Code::RPI1001, message).at(target.span, NOWHERE)
}

/// Returns the diagnostic for a transition to a state of another automaton.
pub(crate) fn state_elsewhere(target: &Ident, declared: Span) -> Finding {
    let name = &target.name;
    let message = format!("`{name}` is a state of another automaton");
    Finding::new(Code::RPI1001, message)
        .at(
            target.span,
            "a transition must lead to a state of the same automaton",
        )
        .also(declared, "declared here")
}

/// Returns the diagnostic for a module that does not exist; `known` are the names of the existing modules.
pub(crate) fn no_module<'n>(
    name: &str,
    span: Span,
    known: impl Iterator<Item = &'n str>,
) -> Finding {
    Finding::new(Code::RPI1005, format!("cannot find module `{name}`"))
        .at(
            span,
            "neither in the standard library nor next to this file",
        )
        .did_you_mean(span, rpi_diag::suggest(name, known))
}

/// Returns the diagnostic for an included file that does not exist. `is_alone` says that the program has no files next
/// to it.
#[must_use]
pub fn no_file(include: &Ident, is_alone: bool) -> Finding {
    let why = match is_alone {
        true => "this program has no files next to it",
        false => "no such text file next to this file",
    };
    let message = format!("cannot find file `{}`", include.name);
    Finding::new(Code::RPI1005, message).at(include.span, why)
}

/// Keeps the first of several diagnostics with the same single sure fix: the others follow from the same error.
pub(crate) fn once_for_each_fix(findings: &mut Vec<Finding>) {
    let mut seen: BTreeSet<(Span, String)> = BTreeSet::new();
    findings.retain(|finding| match &finding.fixes[..] {
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
pub(crate) fn once_for_each_name(findings: &mut Vec<Finding>) {
    let mut places: BTreeMap<String, Vec<Span>> = BTreeMap::new();
    findings.retain(|finding| match &finding.labels[..] {
        [label] if label.text == NOWHERE && says_no_more(finding) => {
            let known = places.entry(finding.message.clone()).or_default();
            known.push(label.span);
            known.len() == 1
        }
        _ => true,
    });
    for finding in findings {
        let is_it = (finding.labels.first()).is_some_and(|label| label.text == NOWHERE);
        let Some([_, others @ ..]) = places.get(&finding.message).map(Vec::as_slice) else {
            continue;
        };
        if !is_it || !says_no_more(finding) {
            continue;
        }
        for span in others.iter().take(MAX_PLACES) {
            *finding = finding.clone().also(*span, "also used here");
        }
        match others.len().saturating_sub(MAX_PLACES) {
            0 => {}
            1 => finding.help.push("used in one more place".to_owned()),
            more => finding.help.push(format!("used in {more} more places")),
        }
    }
}

fn says_no_more(finding: &Finding) -> bool {
    finding.fixes.is_empty() && finding.help.is_empty()
}
