//! Operators on reals (IEEE 754 binary64).

use crate::macros::primitive;
use crate::registry::Prim;

pub(in crate::catalogue) const ALL: &[Prim] = &[
    SUBTRACT,
    NEGATE,
    ABSOLUTE,
    MINIMUM,
    MAXIMUM,
    GREATER_OR_EQUAL,
    FLOOR,
    CEILING,
    ROUND,
    EXPONENTIAL,
    ATAN,
];

primitive! {
    /// Difference of two reals.
    SUBTRACT = "Rpi::DoubleSubtract";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    pure |(a, b): (f64, f64)| (a - b,)
}

primitive! {
    /// The real of opposite sign.
    NEGATE = "Rpi::DoubleNegate";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    pure |(a,): (f64,)| (-a,)
}

primitive! {
    /// Size without sign.
    ABSOLUTE = "Rpi::DoubleAbsolute";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    pure |(a,): (f64,)| (libm::fabs(a),)
}

primitive! {
    /// The smaller of two reals; the other one if one is not a number.
    MINIMUM = "Rpi::DoubleMinimum";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    pure |(a, b): (f64, f64)| (libm::fmin(a, b),)
}

primitive! {
    /// The greater of two reals; the other one if one is not a number.
    MAXIMUM = "Rpi::DoubleMaximum";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    pure |(a, b): (f64, f64)| (libm::fmax(a, b),)
}

primitive! {
    /// True if the first operand is not less than the second; false if one is not a number.
    GREATER_OR_EQUAL = "Rpi::DoubleGreaterOrEqual";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: bool }
    presence strict work 1;
    pure |(a, b): (f64, f64)| (a >= b,)
}

primitive! {
    /// The greatest whole number that is not greater.
    FLOOR = "Rpi::DoubleFloor";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    pure |(a,): (f64,)| (libm::floor(a),)
}

primitive! {
    /// The smallest whole number that is not less.
    CEILING = "Rpi::DoubleCeiling";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    pure |(a,): (f64,)| (libm::ceil(a),)
}

primitive! {
    /// The nearest whole number; away from 0 where two are equally near.
    ROUND = "Rpi::DoubleRound";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    pure |(a,): (f64,)| (libm::round(a),)
}

primitive! {
    /// e to the power of the value.
    EXPONENTIAL = "Rpi::DoubleExponential";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 30;
    pure |(a,): (f64,)| (libm::exp(a),)
}

primitive! {
    /// The angle (rad, -π/2 to π/2) whose tangent is the value.
    ATAN = "Rpi::DoubleAtan";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 30;
    pure |(a,): (f64,)| (libm::atan(a),)
}
