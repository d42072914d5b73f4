//! Arithmetic and comparison of reals (IEEE 754 binary64). There are no faults; infinities and not-a-number propagate.

use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[ADD, MULTIPLY, DIVIDE, MODULO, EQUALS, GREATER];

primitive! {
    /// Sum of two reals.
    ADD = "Core::DoubleAdd";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("inFirst + inSecond");
    pure |(a, b)| (a + b,)
}

primitive! {
    /// Product of two reals.
    MULTIPLY = "Core::DoubleMultiply";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("inFirst * inSecond");
    pure |(a, b)| (a * b,)
}

primitive! {
    /// Quotient of two reals. Infinite or not a number if the second operand is 0.
    DIVIDE = "Core::DoubleDivide";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 4;
    c Value("inFirst / inSecond");
    pure |(a, b)| (a / b,)
}

primitive! {
    /// Remainder of the truncated division; it has the sign of the first operand (C `fmod`).
    MODULO = "Core::DoubleModulo";
    in { inFirst: f64 = First(Real(1.0)); inSecond: f64 = Second(Real(1.0)) }
    out { outValue: f64 }
    presence strict work 40;
    c Value("rpi_fmod(inFirst, inSecond)");
    pure |(a, b)| (libm::fmod(a, b),)
}

primitive! {
    /// True if the operands are equal or differ by at most `Epsilon`. False if an operand is not a number.
    EQUALS = "Core::DoubleEquals";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    param { Epsilon: f64 = Real(0.0) }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst == inSecond || rpi_abs(inFirst - inSecond) <= Epsilon");
    full |_, _, _, (epsilon,), (a, b)| (equal(a, b, epsilon),)
}

primitive! {
    /// True if the first operand is greater than the second. False if an operand is not a number.
    GREATER = "Core::DoubleGreater";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst > inSecond");
    pure |(a, b)| (a > b,)
}

/// Returns true if `a` and `b` are equal or differ by at most `epsilon`. Equal infinities need the first test, as their
/// difference is not a number.
fn equal(a: f64, b: f64, epsilon: f64) -> bool {
    a == b || libm::fabs(a - b) <= epsilon
}
