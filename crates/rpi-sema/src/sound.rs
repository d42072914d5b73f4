//! Error-free units. Later passes run on these even if other units have errors.
//!
//! A unit is not sound if there is an error inside its declaration, if it contains an error expression or an unknown
//! type, or if it needs a unit that is not sound. An error elsewhere, in a type or between declarations, may affect any
//! unit.

use crate::program::Program;
use crate::typed::Kind;
use crate::typed::{Unit, UnitId};
use rpi_diag::{Code, FileId, Finding, Severity, Span};
use std::collections::{BTreeMap, BTreeSet};

/// Returns for each unit whether it is sound.
#[must_use]
pub fn sound(program: &Program<'_>, units: &[Unit], findings: &[Finding]) -> Vec<bool> {
    let errors = findings.iter().filter(|f| f.severity() == Severity::Error);
    let mut errors = errors.peekable();
    if errors.peek().is_none() {
        return vec![true; units.len()];
    }
    let extents = Extents::of(program);
    let mut faulty = Vec::new();
    for error in errors {
        match extents.around(error.span()) {
            Some(extent) => faulty.push(extent),
            None => return vec![false; units.len()],
        }
    }
    faulty.sort_unstable_by_key(|span| (span.file, span.start));
    let faulty = Extents::from(faulty);
    let stands = |unit: &Unit| faulty.around(unit.span).is_none() && !holds_a_fault(unit);
    without_users(units, units.iter().map(stands).collect())
}

/// Removes errors about flows that are never defined (RPI1009) in bodies whose end is missing. The definition may be in
/// the text that was not recognised as part of the body.
#[must_use]
pub fn without_lacks_of_open_bodies(
    program: &Program<'_>,
    mut findings: Vec<Finding>,
) -> Vec<Finding> {
    let no_end = findings.iter().filter(|f| f.code.is_about_missing_end());
    let no_end: Vec<Span> = no_end.map(Finding::span).collect();
    if no_end.is_empty() {
        return findings;
    }
    let extents = Extents::from(program.extents.iter().map(|extent| extent.span).collect());
    let open: BTreeSet<Span> = no_end.iter().filter_map(|at| extents.around(*at)).collect();
    let is_open = |at: Span| {
        extents
            .around(at)
            .is_some_and(|extent| open.contains(&extent))
    };
    findings.retain(|f| f.code != Code::RPI1009 || !is_open(f.span()));
    findings
}

fn holds_a_fault(unit: &Unit) -> bool {
    let mut exprs = unit.exprs.iter();
    let mut flows = unit.flows.iter();
    exprs.any(|expr| matches!(expr.kind, Kind::Fault)) || flows.any(|flow| flow.ty.has_unknown())
}

/// Marks every unit that needs an unsound unit as unsound, transitively.
fn without_users(units: &[Unit], mut sound: Vec<bool>) -> Vec<bool> {
    let mut users: Vec<Vec<usize>> = vec![Vec::new(); units.len()];
    for (user, unit) in units.iter().enumerate() {
        needed_by(unit).for_each(|needed| users[needed.0 as usize].push(user));
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

/// Units that a unit calls or runs.
fn needed_by(unit: &Unit) -> impl Iterator<Item = UnitId> + '_ {
    let calls = unit.exprs.iter().filter_map(|expr| match &expr.kind {
        Kind::Call(call) => Some(call.unit),
        _ => None,
    });
    calls.chain(unit.steps.iter().map(|step| step.unit))
}

/// Spans of declarations, which do not overlap: by file, in ascending order.
struct Extents(BTreeMap<FileId, Vec<Span>>);

impl Extents {
    fn of(program: &Program<'_>) -> Extents {
        let of_units = program.extents.iter().filter(|extent| extent.is_of_units);
        Extents::from(of_units.map(|extent| extent.span).collect())
    }

    fn from(spans: Vec<Span>) -> Extents {
        let mut all: BTreeMap<FileId, Vec<Span>> = BTreeMap::new();
        for span in spans {
            all.entry(span.file).or_default().push(span);
        }
        Extents(all)
    }

    /// Returns the declaration that contains a span.
    fn around(&self, place: Span) -> Option<Span> {
        let spans = self.0.get(&place.file)?;
        let after = spans.partition_point(|span| span.start <= place.start);
        let before = spans.get(after.checked_sub(1)?)?;
        (place.start <= before.end && !place.is_none()).then_some(*before)
    }
}
