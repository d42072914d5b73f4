//! What an operator gives as far as one known operand tells, while types are looked for and after faults.

use super::order::Guess;
use crate::ty::{Ty, join};
use crate::units::Dim;
use rpi_syntax::ops::{BinaryOp, UnaryOp};

use BinaryOp::{Add, And, Div, Ge, Gt, Implies, IntDiv, Le, Lt, Mod, Mul, Or, Sub, Xor};

/// What the result is whatever the operand.
pub(super) fn unary_guess(op: UnaryOp) -> Ty {
    match op {
        UnaryOp::Not => Ty::Bool,
        UnaryOp::ToInt => Ty::Int,
        UnaryOp::ToReal => Ty::REAL,
        _ => Ty::Unknown,
    }
}

/// Whether an operand of this type says little of the result.
fn is_vague(ty: &Ty) -> bool {
    matches!(ty, Ty::Time | Ty::Int)
}

/// What the result is as far as one known operand tells.
pub(super) fn binary_guess(op: BinaryOp, a: &Ty, b: &Ty) -> Ty {
    match op {
        _ if [a, b].iter().any(|ty| matches!(ty, Ty::Array(..))) => Ty::Unknown,
        And | Or | Xor | Implies | Lt | Le | Gt | Ge => Ty::Bool,
        // An integer may be meant as a real, which may be what is wrong with the other one.
        Add | Sub | Mod if !is_vague(a) && !is_vague(b) => join(a, b).unwrap_or(Ty::Unknown),
        IntDiv => Ty::Int,
        _ => Ty::Unknown,
    }
}

/// What the result is if the one known operand is a number that says so.
pub(super) fn guess_by_number(by: Guess, op: BinaryOp, a: &Ty, b: &Ty) -> Option<Ty> {
    let known = if a.is_unknown() { b } else { a };
    let says = match known {
        Ty::Int => by != Guess::Nothing && matches!(op, Add | Sub | Mul | Div | Mod),
        Ty::Real(dim) => by == Guess::Factors && matches!(op, Mul | Div) && *dim == Dim::ONE,
        _ => false,
    };
    says.then(|| known.clone())
}
