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
    HYPERBOLIC_TANGENT,
    ATAN,
];

primitive! {
    /// Difference of two reals.
    SUBTRACT = "Rpi::DoubleSubtract";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("inFirst - inSecond");
    pure |(a, b): (f64, f64)| (a - b,)
}

primitive! {
    /// Negated real.
    NEGATE = "Rpi::DoubleNegate";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("-inValue");
    pure |(a,): (f64,)| (-a,)
}

primitive! {
    /// Absolute value of a real.
    ABSOLUTE = "Rpi::DoubleAbsolute";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("rpi_abs(inValue)");
    pure |(a,): (f64,)| (libm::fabs(a),)
}

primitive! {
    /// The smaller of two reals. If one operand is not a number, the other one.
    MINIMUM = "Rpi::DoubleMinimum";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("rpi_min(inFirst, inSecond)");
    pure |(a, b): (f64, f64)| (libm::fmin(a, b),)
}

primitive! {
    /// The greater of two reals. If one operand is not a number, the other one.
    MAXIMUM = "Rpi::DoubleMaximum";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("rpi_max(inFirst, inSecond)");
    pure |(a, b): (f64, f64)| (libm::fmax(a, b),)
}

primitive! {
    /// True if the first operand is greater than or equal to the second. False if an operand is not a number.
    GREATER_OR_EQUAL = "Rpi::DoubleGreaterOrEqual";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst >= inSecond");
    pure |(a, b): (f64, f64)| (a >= b,)
}

primitive! {
    /// Largest whole number that is not greater than the operand, as a real.
    FLOOR = "Rpi::DoubleFloor";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("rpi_floor(inValue)");
    pure |(a,): (f64,)| (libm::floor(a),)
}

primitive! {
    /// Smallest whole number that is not less than the operand, as a real.
    CEILING = "Rpi::DoubleCeiling";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("rpi_ceil(inValue)");
    pure |(a,): (f64,)| (libm::ceil(a),)
}

primitive! {
    /// Nearest whole number, as a real; halves are rounded away from 0.
    ROUND = "Rpi::DoubleRound";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 1;
    c Value("rpi_round(inValue)");
    pure |(a,): (f64,)| (libm::round(a),)
}

primitive! {
    /// Exponential function, e to the power of the operand.
    EXPONENTIAL = "Rpi::DoubleExponential";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 30;
    c Value("rpi_exp(inValue)");
    pure |(a,): (f64,)| (rpi_math::exp(a),)
}

primitive! {
    /// Hyperbolic tangent, between -1 and 1: a smooth saturation with slope 1 at 0.
    HYPERBOLIC_TANGENT = "Rpi::DoubleHyperbolicTangent";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 40;
    c Value("rpi_tanh(inValue)");
    pure |(a,): (f64,)| (rpi_math::tanh(a),)
}

primitive! {
    /// Arc tangent in rad, -π/2 to π/2.
    ATAN = "Rpi::DoubleAtan";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 30;
    c Value("rpi_atan(inValue)");
    pure |(a,): (f64,)| (rpi_math::atan(a),)
}
