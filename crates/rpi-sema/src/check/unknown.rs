//! A name that nothing declares: misspelt, of another language, or of a module that is not used.

use super::body::Body;
use super::foreign;
use super::report::unknown;
use rpi_diag::{Applicability, Code, Finding, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;
use std::collections::{BTreeMap, BTreeSet};

/// What a unit declares for itself.
pub(super) const FLOW: &str = "flow";

/// What is said at a name that has a meaning for all units and that nothing resembles: see [`once_for_each_name`].
const NOWHERE: &str = "declared nowhere";

/// The most further places that are shown.
const MAX_PLACES: usize = 3;

impl Body<'_, '_> {
    /// Reports that no `what` has this name; `near` is the nearest that one has.
    pub(super) fn unknown_name(
        &mut self,
        what: &str,
        name: &Name,
        span: Span,
        near: Option<String>,
    ) {
        let lacks_use = self.c.program.module(self.module).lacks_use;
        let declaring = (self.c.program.library.declaring)(name);
        let declaring = declaring.filter(|module| !self.c.program.is_hidden(module, name));
        let finding = match declaring {
            _ if lacks_use && near.is_none() => None,
            Some(module) => Some(self.of_module_not_used(what, name, module, span)),
            None if what == FLOW || near.is_some() => Some(unknown(what, name, span, near)),
            None => {
                let message = format!("there is no {what} `{name}`");
                Some(Finding::new(Code::RPI1001, message).at(span, NOWHERE))
            }
        };
        if let Some(finding) = finding {
            self.report(finding);
        }
    }

    /// A name of a module that is there and not used. Of several the first is kept: see [`once_for_each_fix`].
    fn of_module_not_used(
        &self,
        what: &str,
        name: &str,
        module: &'static str,
        span: Span,
    ) -> Finding {
        let start = Span {
            start: 0,
            end: 0,
            ..span
        };
        let fix = Fix::sure(format!("use the module `{module}`"))
            .replace(start, format!("use {module};\n"));
        Finding::new(Code::RPI1001, format!("there is no {what} `{name}` here"))
            .at(
                span,
                format!("the module `{module}` declares it, and is not used"),
            )
            .fix(fix)
    }

    /// Reports an unknown type.
    pub(super) fn unknown_type(&mut self, name: &Name, span: Span) {
        if let Some(here) = foreign::type_here(name) {
            return self.other_name("type", name, span, here);
        }
        if let Some(help) = foreign::no_type(name) {
            let message = format!("there is no type `{name}`");
            let finding =
                Finding::new(Code::RPI1001, message).at(span, "a type of other languages");
            return self.report(finding.help(help));
        }
        let near = self.near_type(name);
        self.unknown_name("type", name, span, near);
    }

    /// Reports a name by which other languages know `here`.
    pub(super) fn other_name(&mut self, what: &str, name: &str, span: Span, here: &str) {
        let title = format!("write `{here}`");
        let fix = match foreign::differs_by_name(name, here) {
            true => Fix::sure(title),
            false => Fix::maybe(title),
        };
        let finding = Finding::new(Code::RPI1001, format!("there is no {what} `{name}`"))
            .at(span, format!("here it is called `{here}`"))
            .fix(fix.replace(span, here));
        self.report(finding);
    }
}

/// A state that no automaton around a transition has; `near` is the nearest that one has.
pub(super) fn unknown_state(target: &Ident, near: Option<String>) -> Finding {
    if near.is_some() {
        return unknown("state", &target.name, target.span, near);
    }
    let message = format!("there is no state `{}`", target.name);
    Finding::new(Code::RPI1001, message).at(target.span, NOWHERE)
}

/// A state that is one of another automaton.
pub(super) fn state_elsewhere(target: &Ident, declared: Span) -> Finding {
    let name = &target.name;
    let message = format!("`{name}` is a state of another automaton");
    Finding::new(Code::RPI1001, message)
        .at(target.span, "a transition leads to a state beside its own")
        .also(declared, "declared here")
}

/// A module that is not there; `known` are those that are.
pub(crate) fn no_module<'n>(
    name: &str,
    span: Span,
    known: impl Iterator<Item = &'n str>,
) -> Finding {
    Finding::new(Code::RPI1005, format!("there is no module `{name}`"))
        .at(span, "neither in the standard library nor beside this file")
        .did_you_mean(span, rpi_diag::suggest(name, known))
}

/// A file that a text includes and that is not there; a text alone has none beside it.
#[must_use]
pub fn no_file(include: &Ident, is_alone: bool) -> Finding {
    let why = match is_alone {
        true => "this text has no files beside it",
        false => "there is none beside this file, or no text in it",
    };
    let message = format!("there is no file `{}`", include.name);
    Finding::new(Code::RPI1005, message).at(include.span, why)
}

/// Of findings that one and the same sure change mends, the first: the others follow from the same fault.
pub(super) fn once_for_each_fix(findings: &mut Vec<Finding>) {
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

/// Of findings about one name that no unit knows the first, with the places of the others: one declaration is missing.
pub(super) fn once_for_each_name(findings: &mut Vec<Finding>) {
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
            *finding = finding.clone().also(*span, "needed here, too");
        }
        match others.len().saturating_sub(MAX_PLACES) {
            0 => {}
            1 => finding.help.push("one more place needs it".to_owned()),
            more => finding.help.push(format!("{more} more places need it")),
        }
    }
}

fn says_no_more(finding: &Finding) -> bool {
    finding.fixes.is_empty() && finding.help.is_empty()
}
