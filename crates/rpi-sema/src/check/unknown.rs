//! A name that nothing declares: misspelt, of another language, or of a module that is not used.

use super::body::Body;
use super::foreign;
use super::report::unknown;
use rpi_diag::{Applicability, Code, Finding, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;
use std::collections::BTreeSet;

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
        let finding = match (self.c.program.library.declaring)(name) {
            _ if lacks_use && near.is_none() => None,
            Some(module) => Some(self.of_module_not_used(what, name, module, span)),
            None => Some(unknown(what, name, span, near)),
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
        match foreign::type_here(name) {
            Some(here) => self.other_name("type", name, span, here),
            None => {
                let near = self.near_type(name);
                self.unknown_name("type", name, span, near);
            }
        }
    }

    /// Reports a name by which other languages know `here`.
    pub(super) fn other_name(&mut self, what: &str, name: &str, span: Span, here: &str) {
        let title = format!("write `{here}`");
        let fix = match foreign::differs_by_name(here) {
            true => Fix::sure(title),
            false => Fix::maybe(title),
        };
        let finding = Finding::new(Code::RPI1001, format!("there is no {what} `{name}`"))
            .at(span, format!("here it is called `{here}`"))
            .fix(fix.replace(span, here));
        self.report(finding);
    }
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
