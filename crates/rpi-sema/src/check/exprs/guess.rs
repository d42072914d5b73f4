//! Guesses of the result type of an operator from one known operand, used during type inference and after errors.

use crate::check::bodies::type_inference::GuessPolicy;
use crate::ty::{Ty, join};
use crate::units::Dimension;
use rpi_syntax::ops::{BinaryOp, UnaryOp};

use BinaryOp::{Add, And, Div, Ge, Gt, Implies, IntDiv, Le, Lt, Mod, Mul, Or, Sub, Xor};

/// Returns the result type of a unary operator whose operand has an unknown type; `Unknown` if the result type depends
/// on the operand.
pub(crate) fn unary_guess(op: UnaryOp) -> Ty {
    match op {
        UnaryOp::Not => Ty::Bool,
        UnaryOp::ToInt => Ty::Int,
        UnaryOp::ToReal => Ty::REAL,
        _ => Ty::Unknown,
    }
}

/// Whether the type of one operand does not determine the result type of a sum, as for points in time and integers.
fn is_uninformative(ty: &Ty) -> bool {
    matches!(ty, Ty::Time | Ty::Int)
}

/// Returns the result type of a binary operator as far as it follows from the operand whose type is known; `Unknown` if
/// it does not follow.
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

/// Returns the result type of a binary operator, guessed from the operand that is a number, while the type of the other
/// operand is unknown. `None` if the operand is no number or the policy `by` forbids the guess.
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
