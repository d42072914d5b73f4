//! Constraints of type parameters, `<<type T: number>>`: the types allowed for `T`, and so the operators that a body
//! may apply to its values.
//!
//! Without a constraint `T` is any type, and a body may only use what is defined for every type. There are exactly
//! three constraints. Each is a set of types on which the same operators have results of the same type.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::check::types::quantity;
use crate::program::DeclId;
use crate::ty::{StructTy, Ty};
use crate::units::Dimension;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;
use std::rc::Rc;

/// Set of types that a type parameter may stand for, as in `type T: number`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Constraint {
    /// Allows all types.
    Any,
    /// Allows `int`, `time` and `real` of any unit.
    Number,
    /// Allows `int` and `real` without a unit. Unlike `Number`, this set contains the products of its types.
    Dimensionless,
    /// Allows `real` of any unit.
    Real,
}

/// Constraints with a keyword, the one with the largest set of types first.
pub(crate) const CONSTRAINTS: [Constraint; 3] = [
    Constraint::Number,
    Constraint::Real,
    Constraint::Dimensionless,
];

/// Returns the keyword of each constraint on type parameters and a description of the types that it allows, for editors
/// and documentation.
pub(crate) fn constraints() -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = CONSTRAINTS.into_iter();
    all.map(|constraint| (constraint.keyword(), constraint.description()))
}

impl Constraint {
    fn from_keyword(word: &str) -> Option<Constraint> {
        CONSTRAINTS.into_iter().find(|one| one.keyword() == word)
    }

    /// Returns the keyword of the constraint; empty for `Any`.
    pub(crate) fn keyword(self) -> &'static str {
        match self {
            Constraint::Any => "",
            Constraint::Number => "number",
            Constraint::Dimensionless => "plain",
            Constraint::Real => "real",
        }
    }

    /// Returns a description of the allowed types, for messages.
    pub(crate) fn description(self) -> &'static str {
        match self {
            Constraint::Any => "any type",
            Constraint::Number => "`int`, `time`, or `real` of any unit",
            Constraint::Dimensionless => "`int`, or `real` without unit",
            Constraint::Real => "`real` of any unit",
        }
    }

    /// Returns whether a type may be the argument of a type parameter with this constraint.
    pub(crate) fn allows(self, ty: &Ty) -> bool {
        match (self, ty) {
            (Constraint::Any, _) | (_, Ty::Unknown | Ty::Generic(_)) => true,
            (Constraint::Number | Constraint::Dimensionless, Ty::Int) => true,
            (Constraint::Number, Ty::Duration) => true,
            (Constraint::Number | Constraint::Real, Ty::Real(_)) => true,
            (Constraint::Dimensionless, Ty::Real(dim)) => dim.is_dimensionless(),
            _ => false,
        }
    }

    /// Returns sample types for a type parameter `name` with this constraint: a generic body without errors for these
    /// has no errors for any allowed type. Sample types that are real have the unit `unit`, which stands for any unit.
    pub(crate) fn sample_types(self, name: &Name, unit: Dimension) -> Vec<Ty> {
        match self {
            Constraint::Any => vec![opaque_type(name)],
            Constraint::Number => vec![Ty::Real(unit), Ty::Int],
            Constraint::Dimensionless => vec![Ty::REAL, Ty::Int],
            Constraint::Real => vec![Ty::Real(unit)],
        }
    }
}

/// Returns a type that is equal to itself only. A generic body is checked with it in place of the type parameter `name`
/// if any type is allowed.
pub(crate) fn opaque_type(name: &Name) -> Ty {
    Ty::Struct(Rc::new(StructTy {
        name: name.clone(),
        fields: Vec::new(),
        defaults: Vec::new(),
    }))
}

/// Returns the constraint with the keyword `constraint`; `Any` without a keyword or for an unknown one.
pub(crate) fn parse_constraint(constraint: Option<&Ident>) -> Constraint {
    let known = constraint.and_then(|ident| Constraint::from_keyword(&ident.name));
    known.unwrap_or(Constraint::Any)
}

/// Returns the diagnostic for an unknown keyword of a constraint; `None` for a known one.
pub(crate) fn unknown_constraint(constraint: &Ident) -> Option<Diagnostic> {
    let word = &constraint.name;
    if Constraint::from_keyword(word).is_some() {
        return None;
    }
    let words = CONSTRAINTS.map(Constraint::keyword);
    let near = rpi_diag::suggest(word, words.into_iter());
    let diagnostic = Diagnostic::new(Code::RPI1001, format!("undefined constraint `{word}`"))
        .primary(constraint.span, "not a constraint");
    let diagnostic = match near.is_none() {
        true => diagnostic.help("use `number`, `real` or `plain`, or no constraint"),
        false => diagnostic,
    };
    Some(diagnostic.did_you_mean(constraint.span, near))
}

/// Whether the static arguments of the callable `id` satisfy the constraints on its type parameters. Reports the first
/// violation.
pub(crate) fn check_constraints(
    cx: &mut Body<'_, '_>,
    id: DeclId,
    statics: &StaticBindings,
    span: Span,
) -> bool {
    for param in static_params::static_params_of_decl(cx.checker, id) {
        let StaticParamDecl::Type(name, Some(constraint)) = param else {
            continue;
        };
        let wanted = parse_constraint(Some(constraint));
        let Some(StaticBinding::Type(ty)) = statics.get(&name.name) else {
            continue;
        };
        if !wanted.allows(ty) {
            let of = cx.checker.program.decl(id).name.clone();
            let diagnostic = constraint_violation(&of, name, wanted, ty);
            let argument = match ty.to_string() == name.name.to_string() {
                // A parameter that is passed on under its own name: "`T` is `T`" would be no help.
                true => format!("`{}` is a type parameter of the caller", name.name),
                false => format!("`{}` is `{ty}` here", name.name),
            };
            let diagnostic = diagnostic.primary(span, argument);
            let declared = format!("`{}` is {}", name.name, wanted.description());
            report::report_diagnostic(cx, diagnostic.secondary(constraint.span, declared));
            return false;
        }
    }
    true
}

/// Returns the diagnostic for a type argument `ty` that the constraint `wanted` of the type parameter `name` does not
/// allow. `of` is the name of the callable.
fn constraint_violation(of: &Name, name: &Ident, wanted: Constraint, ty: &Ty) -> Diagnostic {
    let message = format!("`{of}` is not defined for values of type `{ty}`");
    let diagnostic = Diagnostic::new(Code::RPI2019, message);
    match (wanted, ty) {
        (Constraint::Real, Ty::Int) => {
            diagnostic.help("convert the integers to reals: `real` before each")
        }
        (Constraint::Dimensionless, Ty::Real(dim)) => {
            diagnostic.help(quantity::plain_number_help(*dim))
        }
        (_, Ty::Bool) => diagnostic.help(format!(
            "Booleans are combined by `and`, `or` and `xor`; `{of}` needs values for which `{}` is {}",
            name.name,
            wanted.description()
        )),
        (_, Ty::Array(element, n)) if wanted.allows(element) => diagnostic.help(format!(
            "apply it to the elements one by one: `map<<{of}, {n}>>(...)`"
        )),
        _ => diagnostic.help(format!(
            "pass values for which `{}` is {}",
            name.name,
            wanted.description()
        )),
    }
}
