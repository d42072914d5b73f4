//! Functions of reals. All use the same software implementation on every machine, so that results are bit-identical.

use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[SIN, COS, TAN, ASIN, ACOS, ATAN2, POWER, SQUARE_ROOT, LOG];

primitive! {
    /// Sine of an angle in rad.
    SIN = "Core::DoubleSin";
    in { inValue: f64 = Value(Real(1.0)) }
    out { outValue: f64 }
    presence strict work 20;
    c Value("rpi_sin(inValue)");
    pure |(x,)| (rpi_math::sin(x),)
}

primitive! {
    /// Cosine of an angle in rad.
    COS = "Core::DoubleCos";
    in { inValue: f64 = Value(Real(1.0)) }
    out { outValue: f64 }
    presence strict work 20;
    c Value("rpi_cos(inValue)");
    pure |(x,)| (rpi_math::cos(x),)
}

primitive! {
    /// Tangent of an angle in rad.
    TAN = "Core::DoubleTan";
    in { inValue: f64 = Value(Real(1.0)) }
    out { outValue: f64 }
    presence strict work 25;
    c Value("rpi_tan(inValue)");
    pure |(x,)| (rpi_math::tan(x),)
}

primitive! {
    /// Arc sine in rad, -π/2 to π/2. Not a number for a value outside -1 to 1.
    ASIN = "Core::DoubleAsin";
    in { inValue: f64 = Value(Real(1.0)) }
    out { outValue: f64 }
    presence strict work 20;
    c Value("rpi_asin(inValue)");
    pure |(x,)| (rpi_math::asin(x),)
}

primitive! {
    /// Arc cosine in rad, 0 to π. Not a number for a value outside -1 to 1.
    ACOS = "Core::DoubleAcos";
    in { inValue: f64 = Value(Real(1.0)) }
    out { outValue: f64 }
    presence strict work 20;
    c Value("rpi_acos(inValue)");
    pure |(x,)| (rpi_math::acos(x),)
}

primitive! {
    /// Angle of the point (x, y) in rad, -π to π.
    ATAN2 = "Core::DoubleAtan2";
    in { inY: f64 = Y(Real(1.0)); inX: f64 = X(Real(1.0)) }
    out { outValue: f64 }
    presence strict work 30;
    c Value("rpi_atan2(inY, inX)");
    pure |(y, x)| (rpi_math::atan2(y, x),)
}

primitive! {
    /// `inFirst` to the power of `inSecond` (C `pow`).
    POWER = "Core::DoublePower";
    in { inFirst: f64 = First(Real(0.0)); inSecond: f64 = Second(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 60;
    c Value("rpi_pow(inFirst, inSecond)");
    pure |(a, b)| (rpi_math::pow(a, b),)
}

primitive! {
    /// Square root. Not a number for a negative value.
    SQUARE_ROOT = "Core::DoubleSquareRoot";
    in { inValue: f64 = Value(Real(1.0)) }
    out { outValue: f64 }
    presence strict work 5;
    c Value("rpi_sqrt(inValue)");
    pure |(x,)| (libm::sqrt(x),)
}

primitive! {
    /// Natural logarithm. Minus infinity for 0, not a number for a negative value.
    LOG = "Core::DoubleLog";
    in { inValue: f64 = Value(Real(0.0)) }
    out { outValue: f64 }
    presence strict work 20;
    c Value("rpi_log(inValue)");
    pure |(x,)| (rpi_math::log(x),)
}
