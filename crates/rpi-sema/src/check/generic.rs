//! Generic declarations, checked where they are declared.
//!
//! A body is checked for a few types that stand for all which its constraints admit: a type of which nothing is known
//! where there is no constraint, `int`, and a `real` whose unit is free, a dimension of its own that meets no other.
//! What is wrong for one of them is wrong for some call, and is reported at the declaration. These instances never run:
//! nothing of them is left behind. Lustre's type parameters are text that is put in (V6) or [opaque](super::sample) (Kind 2).

use super::constraint::{CONSTRAINTS, Constraint, unknown, written};
use super::statics::{Param, Static, Statics};
use super::{Checker, sample};
use crate::hash::Set;
use crate::program::DeclId;
use crate::ty::Ty;
use crate::units::{Dim, FREE};
use rpi_diag::{Edit, Finding, Fix, Severity, Span};
use rpi_syntax::ast::Ident;
use std::rc::Rc;

/// The most combinations of types for which one declaration is checked.
const MOST_ROUNDS: usize = 16;

/// A type parameter with its constraint.
#[derive(Clone, Copy)]
struct TypeParam<'a> {
    name: &'a Ident,
    constraint: Constraint,
    /// The constraint as it is written.
    written: Option<&'a Ident>,
    /// Which free unit it has; none if others need them in this round.
    unit: Option<usize>,
}

/// What was found in a body, once for each place.
struct Found {
    errors: Vec<Finding>,
    places: Set<Span>,
}

impl<'a> Checker<'a> {
    /// Checks the generic declarations of the first module for all types that their constraints admit.
    pub(super) fn check_generics(&mut self) {
        for id in self.program.root().decls.clone() {
            let params = self.type_params_of(id);
            let unknown = params.iter().filter_map(|param| unknown(param.written?));
            let unknown: Vec<Finding> = unknown.collect();
            let is_checked = unknown.is_empty() && !params.is_empty() && !self.is_lustre(id);
            if !unknown.is_empty() {
                self.faulty_generics.insert(id);
            }
            self.findings.extend(unknown);
            if !is_checked {
                continue;
            }
            let found = self.errors_for(id, &params);
            let told = match found.errors.is_empty() {
                true => found.errors,
                false => self.explained(id, &params, found),
            };
            if !told.is_empty() {
                self.faulty_generics.insert(id);
            }
            self.findings.extend(told);
        }
    }

    fn type_params_of(&self, id: DeclId) -> Vec<TypeParam<'a>> {
        let types = self
            .params_of(id)
            .into_iter()
            .filter_map(|param| match param {
                Param::Type(name, constraint) => Some((name, constraint)),
                _ => None,
            });
        let param =
            |(place, (name, constraint)): (usize, (&'a Ident, Option<&'a Ident>))| TypeParam {
                name,
                constraint: written(constraint),
                written: constraint,
                unit: Some(place),
            };
        types.enumerate().map(param).collect()
    }

    /// What is wrong in a body for some choice of types, with the constraints given.
    fn errors_for(&mut self, id: DeclId, params: &[TypeParam<'a>]) -> Found {
        let mut found = Found {
            errors: Vec::new(),
            places: Set::default(),
        };
        for first in (0..params.len()).step_by(FREE) {
            let mut params = params.to_vec();
            for param in &mut params {
                let own = param.unit.filter(|at| (first..first + FREE).contains(at));
                param.unit = own.map(|at| at - first);
            }
            for types in choices(&params) {
                let errors = self.errors_with(id, &params, &types);
                let is_new = |error: &Finding| found.places.insert(error.span());
                found.errors.extend(errors.into_iter().filter(is_new));
            }
        }
        found
    }

    /// The same for one choice. The instance is forgotten, and so are those that it calls.
    fn errors_with(&mut self, id: DeclId, params: &[TypeParam<'a>], types: &[Ty]) -> Vec<Finding> {
        let mut statics = self.unknown(id);
        for (param, ty) in params.iter().zip(types) {
            let name = param.name.name.clone();
            statics.insert(name, Static::Ty(ty.clone()));
        }
        let found = self.aside(|checker| checker.check_instance(id, statics));
        let errors = found.into_iter().filter(is_of_generic);
        let named = errors.map(|error| with_names(error, params, types));
        named.collect()
    }

    fn check_instance(&mut self, id: DeclId, statics: Statics) {
        if let Some(header) = self.header(id, Rc::new(statics)) {
            self.unit(&header, header.span);
            self.check_queued();
        }
    }

    /// Gives what is found on the way, and forgets all units that are made.
    fn aside(&mut self, check: impl FnOnce(&mut Self)) -> Vec<Finding> {
        let findings = std::mem::take(&mut self.findings);
        let queue = std::mem::take(&mut self.queue);
        let unit_ids = std::mem::take(&mut self.unit_ids);
        let called = std::mem::take(&mut self.called);
        let told = std::mem::take(&mut self.told_of_instances);
        let (units, written_out) = (self.units.len(), self.written_out);
        check(self);
        self.units.truncate(units);
        self.entries.truncate(units);
        self.written_out = written_out;
        self.queue = queue;
        self.unit_ids = unit_ids;
        self.called = called;
        self.told_of_instances = told;
        std::mem::replace(&mut self.findings, findings)
    }

    /// Where another constraint would mend what is wrong, that is one fault: the constraint.
    fn explained(&mut self, id: DeclId, params: &[TypeParam<'a>], found: Found) -> Vec<Finding> {
        let mut best: Option<(Constraint, Found)> = None;
        for constraint in CONSTRAINTS {
            let tried: Vec<TypeParam<'a>> = params.iter().map(|p| p.or(constraint)).collect();
            let left = self.errors_for(id, &tried);
            let fewest = best
                .as_ref()
                .map_or(found.errors.len(), |b| b.1.errors.len());
            if left.errors.len() < fewest {
                best = Some((constraint, left));
            }
        }
        let Some((constraint, left)) = best else {
            let open = params.iter().find(|p| p.constraint == Constraint::Any);
            let errors = found.errors.into_iter();
            return errors.map(|error| about_any_type(error, open)).collect();
        };
        let mended = found.errors.into_iter();
        let mut mended = mended.filter(|error| !left.places.contains(&error.span()));
        let changed: Vec<&TypeParam<'_>> = (params.iter())
            .filter(|param| param.or(constraint).constraint != param.constraint)
            .collect();
        let lacking = mended
            .next()
            .map(|error| lacks(error, constraint, &changed));
        lacking.into_iter().chain(left.errors).collect()
    }
}

impl TypeParam<'_> {
    /// With another constraint, if that admits less than the one that is written.
    fn or(self, constraint: Constraint) -> Self {
        match self.constraint {
            Constraint::Any | Constraint::Number => TypeParam { constraint, ..self },
            Constraint::Real | Constraint::Plain => self,
        }
    }

    fn samples(&self) -> Vec<Ty> {
        let unit = self.unit.map_or(Dim::ONE, Dim::free);
        self.constraint.samples(&self.name.name, unit)
    }
}

/// Every combination of the types that stand for the parameters, as far as that are not too many.
fn choices(params: &[TypeParam<'_>]) -> Vec<Vec<Ty>> {
    let mut all = vec![Vec::new()];
    for param in params {
        let samples = param.samples();
        let all_fit = all.len() * samples.len() <= MOST_ROUNDS;
        let samples = &samples[..if all_fit { samples.len() } else { 1 }];
        all = (all.iter())
            .flat_map(|types: &Vec<Ty>| {
                let with = |ty: &Ty| types.iter().chain([ty]).cloned().collect();
                samples.iter().map(with)
            })
            .collect();
    }
    all
}

/// Whether a finding about an instance is one about the declaration: an error, whatever its sizes are.
fn is_of_generic(finding: &Finding) -> bool {
    finding.severity() == Severity::Error && sample::is_its_fault(finding)
}

/// Gives free units the names of the parameters that they stand for, and says which types were chosen where it matters.
fn with_names(mut finding: Finding, params: &[TypeParam<'_>], types: &[Ty]) -> Finding {
    without_unit(&mut finding, params);
    let named = |text: &str| {
        let units = params
            .iter()
            .filter_map(|param| Some((param.unit?, param.name)));
        units.fold(text.to_owned(), |text, (place, name)| {
            text.replace(Dim::free_sign(place), &name.name)
        })
    };
    finding.message = named(&finding.message);
    let texts = finding.help.iter_mut().chain(&mut finding.notes);
    let texts = texts.chain(finding.labels.iter_mut().map(|label| &mut label.text));
    texts.for_each(|text| *text = named(text));
    for fix in &mut finding.fixes {
        fix.title = named(&fix.title);
        fix.edits
            .iter_mut()
            .for_each(|edit| edit.text = named(&edit.text));
    }
    let chosen = params.iter().zip(types).filter(|(param, ty)| {
        let is_free = matches!(ty, Ty::Real(dim) if dim.has_free());
        param.constraint != Constraint::Any && param.constraint != Constraint::Real && !is_free
    });
    chosen.fold(finding, |finding, (param, ty)| {
        let (name, word) = (&param.name.name, param.constraint.word());
        finding.note(format!(
            "`{name}` may be `{ty}`, as it is declared `{word}`"
        ))
    })
}

/// A number takes on no unit of a type parameter that may be `int`, too.
fn without_unit(finding: &mut Finding, params: &[TypeParam<'_>]) {
    let numbers = params
        .iter()
        .filter(|param| param.constraint == Constraint::Number);
    let signs: Vec<&str> = numbers
        .filter_map(|param| Some(Dim::free_sign(param.unit?)))
        .collect();
    let has_unit = |edit: &Edit| signs.iter().any(|sign| edit.text.contains(sign));
    if finding
        .fixes
        .iter()
        .any(|fix| fix.edits.iter().any(has_unit))
    {
        finding.fixes.clear();
        finding.help = vec!["0 of a type that is a parameter is `x - x`".to_owned()];
    }
}

/// Says what a parameter without constraint is, where nothing else helps.
fn about_any_type(error: Finding, open: Option<&TypeParam<'_>>) -> Finding {
    match open {
        Some(param) if error.help.is_empty() && error.fixes.is_empty() => {
            let name = &param.name.name;
            error.help(format!(
                "`{name}` may be any type; a constraint says of which: `type {name}: number`"
            ))
        }
        _ => error,
    }
}

/// A fault that is none if the parameters have another constraint.
fn lacks(error: Finding, constraint: Constraint, params: &[&TypeParam<'_>]) -> Finding {
    let word = constraint.word();
    let declared = params
        .iter()
        .map(|p| format!("type {}: {word}", p.name.name));
    let declared = declared.collect::<Vec<_>>().join("; ");
    let mut finding = error;
    finding.help.clear();
    let mut fix = Fix::maybe(format!("declare `{declared}`"));
    finding.fixes.clear();
    for param in params {
        let admitted = format!("may be {}", param.constraint.described());
        finding = finding.also(param.name.span, admitted);
        fix = match param.written {
            Some(at) => fix.replace(at.span, word),
            None => fix.insert_after(param.name.span, format!(": {word}")),
        };
    }
    let help = format!(
        "for {} it has a meaning: `{declared}`",
        constraint.described()
    );
    finding.help(help).fix(fix)
}
