//! Constraints of type parameters, `<<type T: number>>`: the types allowed for `T`, and so the operators that a body
//! may apply to its values.
//!
//! Without a constraint `T` is any type, and a body may only use what is defined for every type. There are exactly
//! three constraints. Each is a set of types on which the same operators have results of the same type.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::signatures::static_args::Static;
use crate::check::signatures::static_args::Statics;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::Param;
use crate::program::DeclId;
use crate::ty::{StructTy, Ty};
use crate::units::Dim;
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;
use std::rc::Rc;

/// Set of types allowed for a type parameter.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Constraint {
    /// All types.
    Any,
    /// `int`, `time` and `real` of any unit.
    Number,
    /// `int` and `real` without a unit. Unlike `Number`, this set is closed under products.
    Plain,
    /// `real` of any unit.
    Real,
}

/// Constraints that can be written, largest set of types first.
pub(crate) const CONSTRAINTS: [Constraint; 3] =
    [Constraint::Number, Constraint::Real, Constraint::Plain];

/// Returns the keyword of each constraint and a description of its types, for editors and documentation.
pub(crate) fn constraints() -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = CONSTRAINTS.into_iter();
    all.map(|constraint| (constraint.word(), constraint.described()))
}

impl Constraint {
    fn of(word: &str) -> Option<Constraint> {
        CONSTRAINTS.into_iter().find(|one| one.word() == word)
    }

    /// Returns the keyword; empty for `Any`.
    pub(crate) fn word(self) -> &'static str {
        match self {
            Constraint::Any => "",
            Constraint::Number => "number",
            Constraint::Plain => "plain",
            Constraint::Real => "real",
        }
    }

    /// Returns a description of the allowed types, for messages.
    pub(crate) fn described(self) -> &'static str {
        match self {
            Constraint::Any => "any type",
            Constraint::Number => "`int`, `time`, or `real` of any unit",
            Constraint::Plain => "`int`, or `real` without unit",
            Constraint::Real => "`real` of any unit",
        }
    }

    /// Whether the constraint allows a type.
    pub(crate) fn admits(self, ty: &Ty) -> bool {
        match (self, ty) {
            (Constraint::Any, _) | (_, Ty::Unknown | Ty::Generic(_)) => true,
            (Constraint::Number | Constraint::Plain, Ty::Int) => true,
            (Constraint::Number, Ty::Duration) => true,
            (Constraint::Number | Constraint::Real, Ty::Real(_)) => true,
            (Constraint::Plain, Ty::Real(dim)) => dim.is_plain(),
            _ => false,
        }
    }

    /// Returns sample types: a body that is correct for these is correct for all allowed types. Reals have the free
    /// unit `unit`.
    pub(crate) fn samples(self, name: &Name, unit: Dim) -> Vec<Ty> {
        match self {
            Constraint::Any => vec![nothing_known(name)],
            Constraint::Number => vec![Ty::Real(unit), Ty::Int],
            Constraint::Plain => vec![Ty::REAL, Ty::Int],
            Constraint::Real => vec![Ty::Real(unit)],
        }
    }
}

/// Returns an opaque type with this name.
pub(crate) fn nothing_known(name: &Name) -> Ty {
    Ty::Struct(Rc::new(StructTy {
        name: name.clone(),
        fields: Vec::new(),
        defaults: Vec::new(),
    }))
}

/// Returns the written constraint; `Any` without one or after an error.
pub(crate) fn written(constraint: Option<&Ident>) -> Constraint {
    let known = constraint.and_then(|ident| Constraint::of(&ident.name));
    known.unwrap_or(Constraint::Any)
}

/// Returns the diagnostic for an unknown constraint; `None` for a known one.
pub(crate) fn unknown(constraint: &Ident) -> Option<Finding> {
    let word = &constraint.name;
    if Constraint::of(word).is_some() {
        return None;
    }
    let words = CONSTRAINTS.map(Constraint::word);
    let near = rpi_diag::suggest(word, words.into_iter());
    let finding = Finding::new(Code::RPI1001, format!("undefined constraint `{word}`"))
        .at(constraint.span, "not a constraint");
    let finding = match near.is_none() {
        true => finding.help("use `number`, `real` or `plain`, or no constraint"),
        false => finding,
    };
    Some(finding.did_you_mean(constraint.span, near))
}

/// Whether the static arguments of a callable satisfy its constraints; reports the first violation.
pub(crate) fn check_constraints(
    cx: &mut Body<'_, '_>,
    id: DeclId,
    statics: &Statics,
    span: Span,
) -> bool {
    for param in static_params::static_params_of(cx.checker, id) {
        let Param::Type(name, Some(constraint)) = param else {
            continue;
        };
        let wanted = written(Some(constraint));
        let Some(Static::Ty(ty)) = statics.get(&name.name) else {
            continue;
        };
        if !wanted.admits(ty) {
            let of = cx.checker.program.decl(id).name.clone();
            let finding = violated(&of, name, wanted, ty);
            let finding = finding.at(span, format!("`{}` is `{ty}` here", name.name));
            let declared = format!("`{}` is {}", name.name, wanted.described());
            report::report_diagnostic(cx, finding.also(constraint.span, declared));
            return false;
        }
    }
    true
}

/// Returns the diagnostic for a type that violates a constraint.
fn violated(of: &Name, name: &Ident, wanted: Constraint, ty: &Ty) -> Finding {
    let message = format!("`{of}` is not defined for values of type `{ty}`");
    let finding = Finding::new(Code::RPI2019, message);
    match (wanted, ty) {
        (Constraint::Real, Ty::Int) => finding.help("convert the arguments: `real n`"),
        (Constraint::Plain, Ty::Real(dim)) => finding.help(format!(
            "divide by a quantity in `{dim}` to get a plain number"
        )),
        _ => finding.help(format!(
            "pass values for which `{}` is {}",
            name.name,
            wanted.described()
        )),
    }
}
