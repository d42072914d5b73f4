//! Checks generic declarations on their own, independent of calls.
//!
//! A body is checked for sample types that represent all types allowed by its constraints: an opaque type where there
//! is no constraint, `int`, and a `real` with a free unit, which is a dimension of its own. An error for one sample is
//! an error for some call, and is reported at the declaration. The instances for samples are discarded. Type parameters
//! of Lustre are textual (V6) or [opaque](super::sample) (Kind 2), and are not checked here.

use crate::check::Checker;
use crate::check::diagnostics::report::join_names;
use crate::check::reuse;
use crate::check::signatures::constraint::CONSTRAINTS;
use crate::check::signatures::constraint::Constraint;
use crate::check::signatures::constraint::parse_constraint;
use crate::check::signatures::constraint::unknown_constraint;
use crate::check::signatures::header;
use crate::check::signatures::sample_check;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::check::signatures::unit;
use crate::hash::FastSet;
use crate::program::DeclId;
use crate::ty::Ty;
use crate::units::{Dimension, FREE_COUNT};
use rpi_diag::{Code, Diagnostic, Edit, Fix, Severity, Span};
use rpi_syntax::ast::Ident;
use std::rc::Rc;

/// Maximum number of combinations of sample types for which the body of one generic declaration is checked.
const MAX_COMBINATIONS: usize = 16;

/// Type parameter of a generic declaration with its constraint.
#[derive(Clone, Copy)]
struct TypeParam<'a> {
    name: &'a Ident,
    constraint: Constraint,
    /// Keyword of the constraint in the source text; `None` if no constraint is written.
    constraint_ident: Option<&'a Ident>,
    /// Index of the free unit (which stands for any unit) in the sample types of this parameter; `None` if the sample
    /// types have no unit in this round of checks.
    free_unit: Option<usize>,
}

/// Errors found in a generic body that was checked for sample types, at most one for each location.
struct SampleErrors {
    errors: Vec<Diagnostic>,
    locations: FastSet<Span>,
}

/// Checks the bodies of the generic declarations of the first module for all types that their constraints allow.
pub(crate) fn check_generics(checker: &mut Checker<'_>) {
    for id in checker.program.root().decls.clone() {
        let params = type_params_of(checker, id);
        let unknown = params
            .iter()
            .filter_map(|param| unknown_constraint(param.constraint_ident?));
        let unknown: Vec<Diagnostic> = unknown.collect();
        let is_checked = unknown.is_empty() && !params.is_empty() && !checker.is_lustre(id);
        if !unknown.is_empty() {
            checker.instances.erroneous_generics.insert(id);
        }
        checker.diagnostics.extend(unknown);
        if !is_checked {
            continue;
        }
        let found = errors_for(checker, id, &params);
        let errors = match found.errors.is_empty() {
            true => found.errors,
            false => attribute_to_constraint(checker, id, &params, found),
        };
        if !errors.is_empty() {
            checker.instances.erroneous_generics.insert(id);
        }
        checker.diagnostics.extend(errors);
    }
}

/// Returns the type parameters of a declaration, with their constraints.
fn type_params_of<'a>(checker: &Checker<'a>, id: DeclId) -> Vec<TypeParam<'a>> {
    let types = static_params::static_params_of_decl(checker, id)
        .into_iter()
        .filter_map(|param| match param {
            StaticParamDecl::Type(name, constraint) => Some((name, constraint)),
            _ => None,
        });
    let param = |(place, (name, constraint)): (usize, (&'a Ident, Option<&'a Ident>))| TypeParam {
        name,
        constraint: parse_constraint(constraint),
        constraint_ident: constraint,
        free_unit: Some(place),
    };
    types.enumerate().map(param).collect()
}

/// Returns the errors of the body of declaration `id` for all combinations of sample types of its type parameters.
fn errors_for<'a>(checker: &mut Checker<'a>, id: DeclId, params: &[TypeParam<'a>]) -> SampleErrors {
    let mut found = SampleErrors {
        errors: Vec::new(),
        locations: FastSet::default(),
    };
    // There are only `FREE` free units, so that more parameters take several rounds.
    for first in (0..params.len()).step_by(FREE_COUNT) {
        let mut params = params.to_vec();
        for param in &mut params {
            let own = param
                .free_unit
                .filter(|at| (first..first + FREE_COUNT).contains(at));
            param.free_unit = own.map(|at| at - first);
        }
        for types in sample_combinations(&params) {
            let errors = errors_for_types(checker, id, &params, &types);
            let is_new = |error: &Diagnostic| found.locations.insert(error.span());
            found.errors.extend(errors.into_iter().filter(is_new));
        }
    }
    found
}

/// Returns the errors of the body of declaration `id` for one combination of sample types, one for each type parameter.
/// The units that the check creates are discarded.
fn errors_for_types<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    params: &[TypeParam<'a>],
    types: &[Ty],
) -> Vec<Diagnostic> {
    let mut statics = sample_check::unknown_statics(checker, id);
    for (param, ty) in params.iter().zip(types) {
        let name = param.name.name.clone();
        statics.insert(name, StaticBinding::Type(ty.clone()));
    }
    let found = discarding_units(checker, |checker| check_instance(checker, id, statics));
    let errors = found.into_iter().filter(is_of_generic);
    let named = errors.map(|error| name_free_units(error, params, types));
    named.collect()
}

fn check_instance(checker: &mut Checker<'_>, id: DeclId, statics: StaticBindings) {
    if let Some(header) = header::check_header(checker, id, Rc::new(statics)) {
        unit::instantiate(checker, &header, header.span);
        unit::check_queued(checker);
    }
}

/// Runs a check and returns its diagnostics. All units that the check creates are discarded.
fn discarding_units(
    checker: &mut Checker<'_>,
    check: impl FnOnce(&mut Checker),
) -> Vec<Diagnostic> {
    let diagnostics = std::mem::take(&mut checker.diagnostics);
    let queue = std::mem::take(&mut checker.instances.queue);
    let unit_ids = std::mem::take(&mut checker.instances.ids);
    let called = std::mem::take(&mut checker.instances.called);
    let reported = std::mem::take(&mut checker.instances.reported);
    let (units, written_out) = (checker.units.len(), checker.limits.expanded_size);
    let reuse = reuse::suspend(checker, true);
    check(checker);
    reuse::suspend(checker, reuse);
    checker.units.truncate(units);
    checker.instances.entries.truncate(units);
    checker.limits.expanded_size = written_out;
    checker.instances.queue = queue;
    checker.instances.ids = unit_ids;
    checker.instances.called = called;
    checker.instances.reported = reported;
    std::mem::replace(&mut checker.diagnostics, diagnostics)
}

/// Returns the errors `found` in the body of declaration `id`. Errors that would not occur with a stricter constraint
/// on its type parameters are replaced by one error that suggests this constraint.
fn attribute_to_constraint<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    params: &[TypeParam<'a>],
    found: SampleErrors,
) -> Vec<Diagnostic> {
    let mut best: Option<(Constraint, SampleErrors)> = None;
    for constraint in CONSTRAINTS {
        let tried: Vec<TypeParam<'a>> = params
            .iter()
            .map(|p| p.with_constraint(constraint))
            .collect();
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
        return errors
            .map(|error| with_constraint_help(error, open))
            .collect();
    };
    let removed = found.errors.into_iter();
    let mut removed = removed.filter(|error| !left.locations.contains(&error.span()));
    let changed: Vec<&TypeParam<'_>> = (params.iter())
        .filter(|param| param.with_constraint(constraint).constraint != param.constraint)
        .collect();
    let lacking = removed
        .next()
        .map(|error| missing_constraint(error, constraint, &changed));
    lacking.into_iter().chain(left.errors).collect()
}

impl TypeParam<'_> {
    /// Returns the parameter with a stricter constraint, unless its declared constraint is already strict (`Real` or
    /// `Dimensionless`).
    fn with_constraint(self, constraint: Constraint) -> Self {
        match self.constraint {
            Constraint::Any | Constraint::Number => TypeParam { constraint, ..self },
            Constraint::Real | Constraint::Dimensionless => self,
        }
    }

    /// Returns the sample types for which the body is checked in place of this parameter.
    fn sample_types(&self) -> Vec<Ty> {
        let unit = self.free_unit.map_or(Dimension::ONE, Dimension::free);
        self.constraint.sample_types(&self.name.name, unit)
    }
}

/// Returns all combinations of sample types of the parameters, up to [`MAX_COMBINATIONS`]. A parameter that would
/// exceed the limit has only its first sample type.
fn sample_combinations(params: &[TypeParam<'_>]) -> Vec<Vec<Ty>> {
    let mut all = vec![Vec::new()];
    for param in params {
        let samples = param.sample_types();
        let all_fit = all.len() * samples.len() <= MAX_COMBINATIONS;
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

/// Whether a diagnostic found with sample arguments applies to the generic declaration itself: an error that does not
/// depend on array sizes.
fn is_of_generic(diagnostic: &Diagnostic) -> bool {
    diagnostic.severity() == Severity::Error && sample_check::is_sample_independent(diagnostic)
}

/// Replaces the signs for free units in a diagnostic by the names of the type parameters. Adds a note with the sample
/// types `types` where the error may occur for these types only.
fn name_free_units(
    mut diagnostic: Diagnostic,
    params: &[TypeParam<'_>],
    types: &[Ty],
) -> Diagnostic {
    remove_unit_fixes(&mut diagnostic, params);
    let named = |text: &str| {
        let units = params
            .iter()
            .filter_map(|param| Some((param.free_unit?, param.name)));
        units.fold(text.to_owned(), |text, (place, name)| {
            text.replace(Dimension::free_sign(place), &name.name)
        })
    };
    diagnostic.message = named(&diagnostic.message);
    let texts = diagnostic.help.iter_mut().chain(&mut diagnostic.notes);
    let texts = texts.chain(diagnostic.labels.iter_mut().map(|label| &mut label.text));
    texts.for_each(|text| *text = named(text));
    for fix in &mut diagnostic.fixes {
        fix.title = named(&fix.title);
        fix.edits
            .iter_mut()
            .for_each(|edit| edit.text = named(&edit.text));
    }
    let chosen = params.iter().zip(types).filter(|(param, ty)| {
        let is_free = matches!(ty, Ty::Real(dim) if dim.has_free());
        param.constraint != Constraint::Any && param.constraint != Constraint::Real && !is_free
    });
    let unitless = params.iter().filter(|param| param.free_unit.is_none());
    let names: Vec<&str> = unitless.map(|param| param.name.name.as_str()).collect();
    if diagnostic.code == Code::RPI2002 && !names.is_empty() {
        let note = format!("checked with plain numbers for {}", join_names(names));
        diagnostic = diagnostic.note(note);
    }
    chosen.fold(diagnostic, |diagnostic, (param, ty)| {
        let (name, word) = (&param.name.name, param.constraint.keyword());
        diagnostic.note(format!(
            "`{name}` may be `{ty}`, as it is declared `{word}`"
        ))
    })
}

/// Removes fixes that write the unit of a type parameter after a number, because the parameter may also stand for
/// `int`.
fn remove_unit_fixes(diagnostic: &mut Diagnostic, params: &[TypeParam<'_>]) {
    let numbers = params
        .iter()
        .filter(|param| param.constraint == Constraint::Number);
    let signs: Vec<&str> = numbers
        .filter_map(|param| Some(Dimension::free_sign(param.free_unit?)))
        .collect();
    let has_unit = |edit: &Edit| signs.iter().any(|sign| edit.text.contains(sign));
    if diagnostic
        .fixes
        .iter()
        .any(|fix| fix.edits.iter().any(has_unit))
    {
        diagnostic.fixes.clear();
        diagnostic.help = vec!["the unit of the type parameter has no literal: zero is the difference of a value and itself, such as `x - x`".to_owned()];
    }
}

/// Adds a help text about the type parameter `open`, which has no constraint, to an error without help and without fix.
fn with_constraint_help(error: Diagnostic, open: Option<&TypeParam<'_>>) -> Diagnostic {
    match open {
        Some(param) if error.help.is_empty() && error.fixes.is_empty() => {
            let name = &param.name.name;
            let (code, declared) = (error.code, param.name.span);
            // No constraint gives a type fields, and none has made this error disappear.
            error.secondary(declared, "may be any type").help(match code {
                Code::RPI1004 => format!(
                    "`{name}` may be any type, so its fields are unknown: declare the port with a struct type"
                ),
                _ => format!(
                    "no constraint on `{name}` makes this possible for all its types: declare the ports with one type, such as `int` or `real`"
                ),
            })
        }
        _ => error,
    }
}

/// Changes an error that would not occur with a stricter constraint to an error that suggests this constraint. `params`
/// are the type parameters whose constraint would change.
fn missing_constraint(
    error: Diagnostic,
    constraint: Constraint,
    params: &[&TypeParam<'_>],
) -> Diagnostic {
    let word = constraint.keyword();
    let declared = params
        .iter()
        .map(|p| format!("type {}: {word}", p.name.name));
    let declared = declared.collect::<Vec<_>>().join("; ");
    let mut diagnostic = error;
    diagnostic.help.clear();
    let mut fix = Fix::maybe(format!("declare `{declared}`"));
    diagnostic.fixes.clear();
    for param in params {
        let admitted = format!("may be {}", param.constraint.description());
        diagnostic = diagnostic.secondary(param.name.span, admitted);
        fix = match param.constraint_ident {
            Some(at) => fix.replace(at.span, word),
            None => fix.insert_after(param.name.span, format!(": {word}")),
        };
    }
    let help = format!(
        "this is defined for {}: `{declared}`",
        constraint.description()
    );
    diagnostic.help(help).fix(fix)
}
