//! Checks generic declarations on their own, independent of calls.
//!
//! A body is checked for sample types that represent all types allowed by its constraints: an opaque type where there
//! is no constraint, `int`, and a `real` with a free unit, which is a dimension of its own. An error for one sample is
//! an error for some call, and is reported at the declaration. The instances for samples are discarded. Type parameters
//! of Lustre are textual (V6) or [opaque](super::sample) (Kind 2), and are not checked here.

use crate::check::Checker;
use crate::check::signatures::constraint::CONSTRAINTS;
use crate::check::signatures::constraint::Constraint;
use crate::check::signatures::constraint::unknown;
use crate::check::signatures::constraint::written;
use crate::check::signatures::header;
use crate::check::signatures::sample_check;
use crate::check::signatures::static_args::Static;
use crate::check::signatures::static_args::Statics;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::Param;
use crate::check::signatures::unit;
use crate::hash::Set;
use crate::program::DeclId;
use crate::ty::Ty;
use crate::units::{Dim, FREE};
use rpi_diag::{Edit, Finding, Fix, Severity, Span};
use rpi_syntax::ast::Ident;
use std::rc::Rc;

/// Maximum number of combinations of sample types for one declaration.
const MOST_ROUNDS: usize = 16;

/// Type parameter with its constraint.
#[derive(Clone, Copy)]
struct TypeParam<'a> {
    name: &'a Ident,
    constraint: Constraint,
    /// Constraint in the source text, if there is one.
    written: Option<&'a Ident>,
    /// Index of its free unit; `None` if the free units of this round are used by other parameters.
    unit: Option<usize>,
}

/// Errors in a body, at most one for each location.
struct Found {
    errors: Vec<Finding>,
    places: Set<Span>,
}

/// Checks the generic declarations of the first module for all types allowed by their constraints.
pub(crate) fn check_generics(checker: &mut Checker<'_>) {
    for id in checker.program.root().decls.clone() {
        let params = type_params_of(checker, id);
        let unknown = params.iter().filter_map(|param| unknown(param.written?));
        let unknown: Vec<Finding> = unknown.collect();
        let is_checked = unknown.is_empty() && !params.is_empty() && !checker.is_lustre(id);
        if !unknown.is_empty() {
            checker.instances.erroneous_generics.insert(id);
        }
        checker.findings.extend(unknown);
        if !is_checked {
            continue;
        }
        let found = errors_for(checker, id, &params);
        let told = match found.errors.is_empty() {
            true => found.errors,
            false => attribute_to_constraint(checker, id, &params, found),
        };
        if !told.is_empty() {
            checker.instances.erroneous_generics.insert(id);
        }
        checker.findings.extend(told);
    }
}

/// Returns the type parameters of a declaration.
fn type_params_of<'a>(checker: &Checker<'a>, id: DeclId) -> Vec<TypeParam<'a>> {
    let types = static_params::static_params_of(checker, id)
        .into_iter()
        .filter_map(|param| match param {
            Param::Type(name, constraint) => Some((name, constraint)),
            _ => None,
        });
    let param = |(place, (name, constraint)): (usize, (&'a Ident, Option<&'a Ident>))| TypeParam {
        name,
        constraint: written(constraint),
        written: constraint,
        unit: Some(place),
    };
    types.enumerate().map(param).collect()
}

/// Returns the errors of a body for all combinations of sample types.
fn errors_for<'a>(checker: &mut Checker<'a>, id: DeclId, params: &[TypeParam<'a>]) -> Found {
    let mut found = Found {
        errors: Vec::new(),
        places: Set::default(),
    };
    // There are only `FREE` free units, so that more parameters take several rounds.
    for first in (0..params.len()).step_by(FREE) {
        let mut params = params.to_vec();
        for param in &mut params {
            let own = param.unit.filter(|at| (first..first + FREE).contains(at));
            param.unit = own.map(|at| at - first);
        }
        for types in choices(&params) {
            let errors = errors_for_types(checker, id, &params, &types);
            let is_new = |error: &Finding| found.places.insert(error.span());
            found.errors.extend(errors.into_iter().filter(is_new));
        }
    }
    found
}

/// Returns the errors of a body for one combination of types. The instance, and those that it calls, are discarded.
fn errors_for_types<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    params: &[TypeParam<'a>],
    types: &[Ty],
) -> Vec<Finding> {
    let mut statics = sample_check::unknown_statics(checker, id);
    for (param, ty) in params.iter().zip(types) {
        let name = param.name.name.clone();
        statics.insert(name, Static::Ty(ty.clone()));
    }
    let found = discarding_units(checker, |checker| check_instance(checker, id, statics));
    let errors = found.into_iter().filter(is_of_generic);
    let named = errors.map(|error| with_names(error, params, types));
    named.collect()
}

fn check_instance(checker: &mut Checker<'_>, id: DeclId, statics: Statics) {
    if let Some(header) = header::check_header(checker, id, Rc::new(statics)) {
        unit::instantiate(checker, &header, header.span);
        unit::check_queued(checker);
    }
}

/// Runs a check and returns its diagnostics; discards all units that it creates.
fn discarding_units(checker: &mut Checker<'_>, check: impl FnOnce(&mut Checker)) -> Vec<Finding> {
    let findings = std::mem::take(&mut checker.findings);
    let queue = std::mem::take(&mut checker.instances.queue);
    let unit_ids = std::mem::take(&mut checker.instances.ids);
    let called = std::mem::take(&mut checker.instances.called);
    let told = std::mem::take(&mut checker.instances.reported);
    let (units, written_out) = (checker.units.len(), checker.limits.expanded_size);
    check(checker);
    checker.units.truncate(units);
    checker.instances.entries.truncate(units);
    checker.limits.expanded_size = written_out;
    checker.instances.queue = queue;
    checker.instances.ids = unit_ids;
    checker.instances.called = called;
    checker.instances.reported = told;
    std::mem::replace(&mut checker.findings, findings)
}

/// Replaces errors that another constraint would remove by one error about the constraint.
fn attribute_to_constraint<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    params: &[TypeParam<'a>],
    found: Found,
) -> Vec<Finding> {
    let mut best: Option<(Constraint, Found)> = None;
    for constraint in CONSTRAINTS {
        let tried: Vec<TypeParam<'a>> = params.iter().map(|p| p.or(constraint)).collect();
        let left = errors_for(checker, id, &tried);
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

impl TypeParam<'_> {
    /// Returns the parameter with another constraint, if the written one allows more types.
    fn or(self, constraint: Constraint) -> Self {
        match self.constraint {
            Constraint::Any | Constraint::Number => TypeParam { constraint, ..self },
            Constraint::Real | Constraint::Plain => self,
        }
    }

    /// Returns the sample types of the parameter.
    fn samples(&self) -> Vec<Ty> {
        let unit = self.unit.map_or(Dim::ONE, Dim::free);
        self.constraint.samples(&self.name.name, unit)
    }
}

/// Returns all combinations of sample types, up to `MOST_ROUNDS`. Above this limit a parameter has only its first
/// sample.
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

/// Whether a diagnostic about an instance applies to the declaration: an error that does not depend on sizes.
fn is_of_generic(finding: &Finding) -> bool {
    finding.severity() == Severity::Error && sample_check::is_its_fault(finding)
}

/// Replaces free units in a diagnostic by the names of their parameters, and adds a note with the sample types where
/// these matter.
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

/// Removes fixes that write a unit of a type parameter after a number, as the parameter may also be `int`.
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
        finding.help = vec!["write zero of a parametric type as `x - x`".to_owned()];
    }
}

/// Adds a help text about a parameter without a constraint to an error without help.
fn about_any_type(error: Finding, open: Option<&TypeParam<'_>>) -> Finding {
    match open {
        Some(param) if error.help.is_empty() && error.fixes.is_empty() => {
            let name = &param.name.name;
            error.help(format!(
                "`{name}` may be any type; add a constraint: `type {name}: number`"
            ))
        }
        _ => error,
    }
}

/// Turns an error that another constraint would remove into one about that constraint.
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
        "this is defined for {}: `{declared}`",
        constraint.described()
    );
    finding.help(help).fix(fix)
}
