//! Error-free units. Later passes run on these even if other units have errors.
//!
//! A unit is not sound if there is an error inside its declaration, if it contains an error expression or an unknown
//! type, or if it needs a unit that is not sound. An error elsewhere, in a type or between declarations, may affect any
//! unit.

use crate::program::Program;
use crate::typed::TypedKind;
use crate::typed::{Unit, UnitId};
use rpi_diag::suppression::{Cause, suppress};
use rpi_diag::{Diagnostic, FileId, Severity, Span};
use std::collections::BTreeMap;
use std::rc::Rc;

/// Returns for each unit whether it can be compiled, because neither it nor any unit that it needs has an error.
#[must_use]
pub fn sound_units(
    program: &Program<'_>,
    units: &[Rc<Unit>],
    diagnostics: &[Diagnostic],
) -> Vec<bool> {
    let errors = diagnostics
        .iter()
        .filter(|f| f.severity() == Severity::Error);
    let mut errors = errors.peekable();
    if errors.peek().is_none() {
        return vec![true; units.len()];
    }
    let extents = Extents::of_units(program);
    let mut faulty = Vec::new();
    for error in errors {
        match extents.containing(error.span()) {
            Some(extent) => faulty.push(extent),
            None => return vec![false; units.len()],
        }
    }
    faulty.sort_unstable_by_key(|span| (span.file, span.start));
    let faulty = Extents::from_spans(faulty);
    let stands = |unit: &Unit| faulty.containing(unit.span).is_none() && !has_error(unit);
    propagate_unsound(units, units.iter().map(|unit| stands(unit)).collect())
}

/// Removes errors about flows that are never defined (RPI1009) in bodies whose end is missing. The definition may be in
/// the text that the parser did not recognise as part of the body.
#[must_use]
pub fn without_undefined_flows_in_unclosed_bodies(
    program: &Program<'_>,
    mut diagnostics: Vec<Diagnostic>,
) -> Vec<Diagnostic> {
    let no_end = diagnostics.iter().filter(|f| f.code.is_unclosed());
    let no_end: Vec<Span> = no_end.map(Diagnostic::span).collect();
    if no_end.is_empty() {
        return diagnostics;
    }
    let extents = Extents::from_spans(program.extents.iter().map(|extent| extent.span).collect());
    let open: Vec<Span> = no_end
        .iter()
        .filter_map(|at| extents.containing(*at))
        .collect();
    suppress(&mut diagnostics, Cause::UnclosedDeclarations(&open));
    diagnostics
}

fn has_error(unit: &Unit) -> bool {
    let mut exprs = unit.exprs.iter();
    let mut flows = unit.flows.iter();
    exprs.any(|expr| matches!(expr.kind, TypedKind::Error))
        || flows.any(|flow| flow.ty.has_unknown())
}

/// Returns `sound` with the units that need a unit with errors marked as having errors as well.
fn propagate_unsound(units: &[Rc<Unit>], mut sound: Vec<bool>) -> Vec<bool> {
    let mut users: Vec<Vec<usize>> = vec![Vec::new(); units.len()];
    for (user, unit) in units.iter().enumerate() {
        dependencies(unit).for_each(|needed| users[needed.0 as usize].push(user));
    }
    let mut open: Vec<usize> = (0..units.len()).filter(|unit| !sound[*unit]).collect();
    while let Some(unit) = open.pop() {
        for user in &users[unit] {
            if std::mem::replace(&mut sound[*user], false) {
                open.push(*user);
            }
        }
    }
    sound
}

/// Returns the units that a unit calls, or that it runs as steps of a task.
fn dependencies(unit: &Unit) -> impl Iterator<Item = UnitId> + '_ {
    let calls = unit.exprs.iter().filter_map(|expr| match &expr.kind {
        TypedKind::Call(call) => Some(call.unit),
        _ => None,
    });
    calls.chain(unit.steps.iter().map(|step| step.unit))
}

/// Spans of declarations, which do not overlap, in ascending order for each file.
struct Extents(BTreeMap<FileId, Vec<Span>>);

impl Extents {
    fn of_units(program: &Program<'_>) -> Extents {
        let of_units = program.extents.iter().filter(|extent| extent.is_of_units);
        Extents::from_spans(of_units.map(|extent| extent.span).collect())
    }

    fn from_spans(spans: Vec<Span>) -> Extents {
        let mut all: BTreeMap<FileId, Vec<Span>> = BTreeMap::new();
        for span in spans {
            all.entry(span.file).or_default().push(span);
        }
        Extents(all)
    }

    /// Returns the span of the declaration that contains the start of `place`; `None` if there is none.
    fn containing(&self, place: Span) -> Option<Span> {
        let spans = self.0.get(&place.file)?;
        let after = spans.partition_point(|span| span.start <= place.start);
        let before = spans.get(after.checked_sub(1)?)?;
        (place.start <= before.end && !place.is_none()).then_some(*before)
    }
}
