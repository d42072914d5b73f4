//! Which units nothing is wrong with: the later passes look at these, whatever is wrong with others.
//!
//! A unit is not sound if a fault stands in the text of its declaration, if it holds something that stands for a fault,
//! or if it needs a unit that is not sound. A fault elsewhere, in a type or between declarations, may be about any of them.

use crate::program::Program;
use crate::typed::{Kind, Unit, UnitId};
use rpi_diag::{Code, FileId, Finding, Severity, Span};
use std::collections::{BTreeMap, BTreeSet};

/// For each unit whether it is sound.
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

/// Of a body without end it is not known what stands in it and what behind it: what it lacks is not told as well.
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

/// Takes away, again and again, what needs something that is not sound.
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

/// The units that a unit calls or runs.
fn needed_by(unit: &Unit) -> impl Iterator<Item = UnitId> + '_ {
    let calls = unit.exprs.iter().filter_map(|expr| match &expr.kind {
        Kind::Call(call) => Some(call.unit),
        _ => None,
    });
    calls.chain(unit.steps.iter().map(|step| step.unit))
}

/// Texts of declarations, which do not overlap: by file, in ascending order.
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

    /// The declaration in whose text a place lies.
    fn around(&self, place: Span) -> Option<Span> {
        let spans = self.0.get(&place.file)?;
        let after = spans.partition_point(|span| span.start <= place.start);
        let before = spans.get(after.checked_sub(1)?)?;
        (place.start <= before.end && !place.is_none()).then_some(*before)
    }
}
