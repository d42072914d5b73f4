//! Suppression of diagnostics that only follow from others. This is the only place that removes diagnostics.
//!
//! An error type or an error expression prevents most of these diagnostics where they would be made. This module decides
//! the rest, which needs the whole list: each [`Cause`] names the earlier error or the circumstance, and decides by codes
//! and spans which diagnostics it explains, never by texts.

use std::collections::{BTreeMap, BTreeSet};

use crate::{Applicability, Code, CodeGroup, Diagnostic, FileId, Fix, Severity, Span, Subject};

/// Reason why some diagnostics are only consequences of another error, and are therefore not reported.
#[derive(Clone, Copy, Debug)]
pub enum Cause<'a> {
    /// The compiler assumed a value for a constant or a size that has none. It explains errors about values of sizes
    /// and constants.
    SampleValue,
    /// The program has an error of its own. It explains diagnostics about parts that only another tool supplies.
    OtherError,
    /// Declarations whose end is missing, by their ranges, so that the rest was not recognised. They explain
    /// diagnostics about flows within them that have no definition.
    UnclosedDeclarations(&'a [Span]),
    /// Ranges of text with syntax errors. They explain all other diagnostics about text in these ranges.
    SyntaxErrors(&'a [Span]),
    /// Ranges of expressions whose operands have several clocks. They explain diagnostics about the expressions around
    /// them, which are absent in some cycles as a consequence.
    ClockMismatch(&'a BTreeSet<Span>),
    /// Ranges of expressions that are absent because of an error. They explain warnings and notes about them, for
    /// example about a default value, because it is unknown whether the corrected program needs it.
    AbsentValues(&'a BTreeSet<Span>),
    /// Some text has an error that may hide the use of a name. It explains warnings about unused and unreachable text.
    HiddenUse,
    /// Ranges of results of a call that one caller does not need. They explain warnings that these results are unused,
    /// because other callers may use them.
    UsedElsewhere(&'a BTreeSet<Span>),
    /// Files of libraries: the file with this identifier and all later ones. They explain warnings and notes about
    /// these files, which the user of a library cannot act on.
    LibraryFiles(FileId),
}

impl Cause<'_> {
    /// Returns whether a diagnostic is a consequence of this cause, so that it need not be reported.
    #[must_use]
    pub fn explains(&self, diagnostic: &Diagnostic) -> bool {
        let (code, span) = (diagnostic.code, diagnostic.span());
        let is_error = diagnostic.severity() == Severity::Error;
        match self {
            Cause::SampleValue => code.may_depend_on_values(),
            Cause::OtherError => code.is_external(),
            Cause::UnclosedDeclarations(declarations) => {
                code == Code::RPI1009 && declarations.iter().any(|at| contains(*at, span))
            }
            Cause::SyntaxErrors(faults) => {
                let mut places = diagnostic.labels.iter().map(|label| label.span);
                let is_at_fault = |place| faults.iter().any(|fault| overlap(place, *fault));
                !is_syntax_error(diagnostic) && places.any(is_at_fault)
            }
            Cause::ClockMismatch(expressions) => contains_any(expressions, span),
            Cause::AbsentValues(values) => {
                let mut labels = diagnostic.labels.iter();
                !is_error && labels.any(|label| contains_any(values, label.span))
            }
            Cause::HiddenUse => code.is_unnecessary(),
            Cause::UsedElsewhere(results) => code.is_unnecessary() && results.contains(&span),
            Cause::LibraryFiles(first) => !is_error && !span.is_none() && span.file >= *first,
        }
    }
}

/// Removes the diagnostics that are only consequences of `cause`.
pub fn suppress(diagnostics: &mut Vec<Diagnostic>, cause: Cause<'_>) {
    suppress_from(diagnostics, 0, cause);
}

/// Removes the diagnostics with index `first` or higher that are only consequences of `cause`.
pub fn suppress_from(diagnostics: &mut Vec<Diagnostic>, first: usize, cause: Cause<'_>) {
    let later = diagnostics.split_off(first.min(diagnostics.len()));
    let own = later
        .into_iter()
        .filter(|diagnostic| !cause.explains(diagnostic));
    diagnostics.extend(own);
}

/// Removes all diagnostics except errors: warnings and notes of any subject.
pub fn suppress_warnings(diagnostics: &mut Vec<Diagnostic>) {
    diagnostics.retain(|diagnostic| diagnostic.severity() == Severity::Error);
}

/// Removes the diagnostics about definitions that only another tool can supply, if the program has an error of another
/// kind.
pub fn suppress_external(diagnostics: &mut Vec<Diagnostic>) {
    let is_other = |diagnostic: &Diagnostic| {
        diagnostic.severity() == Severity::Error && !diagnostic.code.is_external()
    };
    if diagnostics.iter().any(is_other) {
        suppress(diagnostics, Cause::OtherError);
    }
}

/// Removes the diagnostics about text with a syntax error, except the syntax errors themselves.
pub fn suppress_in_syntax_errors(diagnostics: &mut Vec<Diagnostic>) {
    let faults = diagnostics.iter().filter(|found| is_syntax_error(found));
    let labels = faults.flat_map(|fault| &fault.labels);
    let places: Vec<Span> = labels.map(|label| label.span).collect();
    suppress(diagnostics, Cause::SyntaxErrors(&places));
}

/// Adds the diagnostics of `more` whose code and location do not occur in `diagnostics`.
pub fn add_new(diagnostics: &mut Vec<Diagnostic>, more: impl IntoIterator<Item = Diagnostic>) {
    let reported: BTreeSet<(Code, Span)> = diagnostics.iter().map(place).collect();
    let more = more.into_iter();
    diagnostics.extend(more.filter(|diagnostic| !reported.contains(&place(diagnostic))));
}

/// Removes repeated diagnostics: with the same code, location and message, or with the same code, location and fixes.
/// They occur because a node that is called in several places is analysed in each of them, possibly with other names
/// for its flows.
pub fn remove_repeated(diagnostics: &mut Vec<Diagnostic>) {
    let (mut seen, mut fixed) = (BTreeSet::new(), BTreeSet::new());
    diagnostics.retain(|diagnostic| {
        let place = place(diagnostic);
        seen.insert((place, diagnostic.message.clone()))
            && (diagnostic.fixes.is_empty() || fixed.insert((place, fix_edits(diagnostic))))
    });
}

/// Reduces several diagnostics with the same single sure fix to the first one, because the others follow from the same
/// error.
pub fn remove_repeated_fixes(diagnostics: &mut Vec<Diagnostic>) {
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

/// Maximum number of further locations that the merged diagnostic about an undefined name shows.
const MAX_LOCATIONS: usize = 3;

/// Reduces several diagnostics about one undefined name or unsupported construct ([`Diagnostic::about`]) to the first
/// one, and adds the locations of other uses of an undefined name. A diagnostic about a name with help or fixes of its
/// own is preserved.
pub fn merge_by_subject(diagnostics: &mut Vec<Diagnostic>) {
    let mut places: BTreeMap<Subject, Vec<Span>> = BTreeMap::new();
    diagnostics.retain(|diagnostic| match mergeable_subject(diagnostic) {
        Some(subject) => {
            let known = places.entry(subject.clone()).or_default();
            known.push(diagnostic.span());
            known.len() == 1
        }
        None => true,
    });
    for diagnostic in diagnostics {
        let subject = diagnostic.subject.as_ref();
        let is_name = |subject: &&Subject| matches!(subject, Subject::UndefinedName(_));
        let subject = subject.filter(|subject| is_name(subject) && !has_hints(diagnostic));
        let all = subject.and_then(|subject| places.get(subject));
        let Some([_, others @ ..]) = all.map(Vec::as_slice) else {
            continue;
        };
        let advice = "declare it, or correct the name".to_owned();
        diagnostic.help.push(advice);
        for span in others.iter().take(MAX_LOCATIONS) {
            *diagnostic = diagnostic.clone().secondary(*span, "also used here");
        }
        match others.len().saturating_sub(MAX_LOCATIONS) {
            0 => {}
            1 => diagnostic
                .notes
                .push("it is used in one more place".to_owned()),
            more => diagnostic
                .notes
                .push(format!("it is used in {more} more places")),
        }
    }
}

fn mergeable_subject(diagnostic: &Diagnostic) -> Option<&Subject> {
    let is_plain = diagnostic.labels.len() == 1 && !has_hints(diagnostic);
    let is_mergeable = |subject: &&Subject| is_plain || matches!(subject, Subject::Construct(_));
    diagnostic.subject.as_ref().filter(is_mergeable)
}

fn has_hints(diagnostic: &Diagnostic) -> bool {
    !diagnostic.fixes.is_empty() || !diagnostic.help.is_empty()
}

/// Returns whether a diagnostic is a syntax error: it rejects the text before the meaning of the text is known.
fn is_syntax_error(diagnostic: &Diagnostic) -> bool {
    diagnostic.code.group() == CodeGroup::Syntax && diagnostic.severity() == Severity::Error
}

fn place(diagnostic: &Diagnostic) -> (Code, Span) {
    (diagnostic.code, diagnostic.span())
}

/// Returns the edits of all fixes of a diagnostic: ranges and new texts.
fn fix_edits(diagnostic: &Diagnostic) -> Vec<(Span, String)> {
    let edits = diagnostic.fixes.iter().flat_map(|fix| &fix.edits);
    edits.map(|edit| (edit.span, edit.text.clone())).collect()
}

fn overlap(a: Span, b: Span) -> bool {
    a.file == b.file && a.start < b.end && b.start < a.end
}

/// Returns whether `place` begins within `outer` or at its end.
fn contains(outer: Span, place: Span) -> bool {
    !place.is_none() && outer.file == place.file && (outer.start..=outer.end).contains(&place.start)
}

/// Returns whether one of the ranges `places` lies within `place` or equals it.
fn contains_any(places: &BTreeSet<Span>, place: Span) -> bool {
    let start = Span { end: 0, ..place };
    let within = places.range(start..).take_while(|at| at.file == place.file);
    within
        .take_while(|at| at.start < place.end)
        .any(|at| at.end <= place.end)
}
