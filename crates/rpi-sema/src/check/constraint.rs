//! Constraints of type parameters, `<<type T: number>>`: which types may stand for `T`, and with that what a body may do with it.
//!
//! Without a constraint `T` is any type, and a body may do with its values what every type allows. There are three
//! constraints and no more: each is a set of types on which the same operators have results of the same type.

use super::body::Body;
use super::statics::{Param, Static, Statics};
use crate::program::DeclId;
use crate::ty::{StructTy, Ty};
use crate::units::Dim;
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;
use std::rc::Rc;

/// Which types may stand for a type parameter.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Constraint {
    /// All.
    Any,
    /// `int`, `time` and `real` of any unit.
    Number,
    /// `int` and `real` without unit: products of such values are such values.
    Plain,
    /// `real` of any unit.
    Real,
}

/// The constraints that can be written, the one that admits most first.
pub(super) const CONSTRAINTS: [Constraint; 3] =
    [Constraint::Number, Constraint::Real, Constraint::Plain];

/// Their words, and the types that they admit.
pub(crate) fn constraints() -> impl Iterator<Item = (&'static str, &'static str)> {
    let all = CONSTRAINTS.into_iter();
    all.map(|constraint| (constraint.word(), constraint.described()))
}

impl Constraint {
    fn of(word: &str) -> Option<Constraint> {
        CONSTRAINTS.into_iter().find(|one| one.word() == word)
    }

    /// As it is written.
    pub(super) fn word(self) -> &'static str {
        match self {
            Constraint::Any => "",
            Constraint::Number => "number",
            Constraint::Plain => "plain",
            Constraint::Real => "real",
        }
    }

    /// The types that it admits, in words.
    pub(super) fn described(self) -> &'static str {
        match self {
            Constraint::Any => "any type",
            Constraint::Number => "`int`, `time`, or `real` of any unit",
            Constraint::Plain => "`int`, or `real` without unit",
            Constraint::Real => "`real` of any unit",
        }
    }

    pub(super) fn admits(self, ty: &Ty) -> bool {
        match (self, ty) {
            (Constraint::Any, _) | (_, Ty::Unknown | Ty::Generic(_)) => true,
            (Constraint::Number | Constraint::Plain, Ty::Int) => true,
            (Constraint::Number, Ty::Duration) => true,
            (Constraint::Number | Constraint::Real, Ty::Real(_)) => true,
            (Constraint::Plain, Ty::Real(dim)) => dim.is_plain(),
            _ => false,
        }
    }

    /// Types that stand for all that are admitted: what is right for these is right for each. The unit of reals is free.
    pub(super) fn samples(self, name: &Name, unit: Dim) -> Vec<Ty> {
        match self {
            Constraint::Any => vec![nothing_known(name)],
            Constraint::Number => vec![Ty::Real(unit), Ty::Int],
            Constraint::Plain => vec![Ty::REAL, Ty::Int],
            Constraint::Real => vec![Ty::Real(unit)],
        }
    }
}

/// A type of which nothing is known but its name.
pub(super) fn nothing_known(name: &Name) -> Ty {
    Ty::Struct(Rc::new(StructTy {
        name: name.clone(),
        fields: Vec::new(),
        defaults: Vec::new(),
    }))
}

/// The constraint that is written; any type after a fault.
pub(super) fn written(constraint: Option<&Ident>) -> Constraint {
    let known = constraint.and_then(|ident| Constraint::of(&ident.name));
    known.unwrap_or(Constraint::Any)
}

/// There is no constraint of this name.
pub(super) fn unknown(constraint: &Ident) -> Option<Finding> {
    let word = &constraint.name;
    if Constraint::of(word).is_some() {
        return None;
    }
    let words = CONSTRAINTS.map(Constraint::word);
    let near = rpi_diag::suggest(word, words.into_iter());
    let finding = Finding::new(Code::RPI1001, format!("there is no constraint `{word}`"))
        .at(constraint.span, "not known");
    let finding = match near.is_none() {
        true => {
            finding.help("a type parameter is declared `number`, `real` or `plain`, or without any")
        }
        false => finding,
    };
    Some(finding.did_you_mean(constraint.span, near))
}

impl Body<'_, '_> {
    /// Whether the types for which a callable is called satisfy its constraints; reports the first that does not.
    pub(super) fn satisfies(&mut self, id: DeclId, statics: &Statics, span: Span) -> bool {
        for param in self.c.params_of(id) {
            let Param::Type(name, Some(constraint)) = param else {
                continue;
            };
            let wanted = written(Some(constraint));
            let Some(Static::Ty(ty)) = statics.get(&name.name) else {
                continue;
            };
            if !wanted.admits(ty) {
                let of = self.c.program.decl(id).name.clone();
                let finding = violated(&of, name, wanted, ty);
                let finding = finding.at(span, format!("`{}` is `{ty}` here", name.name));
                let declared = format!("`{}` is {}", name.name, wanted.described());
                self.report(finding.also(constraint.span, declared));
                return false;
            }
        }
        true
    }
}

fn violated(of: &Name, name: &Ident, wanted: Constraint, ty: &Ty) -> Finding {
    let message = format!("`{of}` is not for values of type `{ty}`");
    let finding = Finding::new(Code::RPI2019, message);
    match (wanted, ty) {
        (Constraint::Real, Ty::Int) => finding.help("convert the arguments: `real n`"),
        (Constraint::Plain, Ty::Real(dim)) => finding.help(format!(
            "divided by a quantity in `{dim}` a value is a plain number"
        )),
        _ => finding.help(format!(
            "give values for which `{}` is {}",
            name.name,
            wanted.described()
        )),
    }
}
