//! Arithmetic on reals.

use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[ADD, CONDITIONAL];

primitive! {
    /// Sum of two reals.
    ADD = "Core::DoubleAdd";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    pure |(a, b)| (a + b,)
}

primitive! {
    /// One of two reals: `True` where the condition holds, else `False`. Absent without a condition or if the chosen one is absent;
    /// the other one does not matter.
    CONDITIONAL = "Core::DoubleConditional";
    in { inCondition: bool; inTrue: f64 = True(Real(0.0)); inFalse: f64 = False(Real(0.0)) }
    out { outValue: f64 }
    presence if_all work 1;
    pure |(c, t, f)| (match c { Some(true) => t, Some(false) => f, None => None },)
}
