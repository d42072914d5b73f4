//! Guesses of the result type of an operator from one known operand, used during type inference and after errors.

use crate::check::bodies::type_inference::GuessPolicy;
use crate::ty::{Ty, join};
use crate::units::Dimension;
use rpi_syntax::ops::{BinaryOp, UnaryOp};

use BinaryOp::{Add, And, Div, Ge, Gt, Implies, IntDiv, Le, Lt, Mod, Mul, Or, Sub, Xor};

/// Returns the result type of a unary operator on an operand of unknown type; `Unknown` if it depends on that type.
pub(crate) fn unary_guess(op: UnaryOp) -> Ty {
    match op {
        UnaryOp::Not => Ty::Bool,
        UnaryOp::ToInt => Ty::Int,
        UnaryOp::ToReal => Ty::REAL,
        _ => Ty::Unknown,
    }
}

/// Whether the type of an operand says little about the result type.
fn is_uninformative(ty: &Ty) -> bool {
    matches!(ty, Ty::Time | Ty::Int)
}

/// Returns the result type of a binary operator as far as it follows from the operand of known type, else `Unknown`.
pub(crate) fn binary_guess(op: BinaryOp, a: &Ty, b: &Ty) -> Ty {
    match op {
        _ if [a, b].iter().any(|ty| matches!(ty, Ty::Array(..))) => Ty::Unknown,
        And | Or | Xor | Implies | Lt | Le | Gt | Ge => Ty::Bool,
        // An integer literal may be meant as a real, which may be the very error of the other operand.
        Add | Sub | Mod if !is_uninformative(a) && !is_uninformative(b) => {
            join(a, b).unwrap_or(Ty::Unknown)
        }
        IntDiv => Ty::Int,
        _ => Ty::Unknown,
    }
}

/// Returns the result type of an operator guessed from an operand that is a number; `None` if the policy `by` forbids
/// the guess.
pub(crate) fn guess_from_number(by: GuessPolicy, op: BinaryOp, a: &Ty, b: &Ty) -> Option<Ty> {
    let known = if a.is_unknown() { b } else { a };
    let says = match known {
        Ty::Int => by != GuessPolicy::Never && matches!(op, Add | Sub | Mul | Div | Mod),
        Ty::Real(dim) => {
            by == GuessPolicy::Factors && matches!(op, Mul | Div) && *dim == Dimension::ONE
        }
        _ => false,
    };
    says.then(|| known.clone())
}
