//! Relative position in an interval, ramps and curves of one real.

use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[INTERVAL, LERP, RAMPIFY, DOUBLE_BEZIER, CUBIC_BEZIER];

primitive! {
    /// Position of a value in the interval from `inMin` to `inMax`, both included. `outValue` is the relative position
    /// (0 to 1); it is 0 below the interval and 1 above. `outActive` is true inside the interval. If both bounds are
    /// equal, the upper bound is `inMin` + 1.
    INTERVAL = "Core::Interval";
    in { inValue: f64; inMin: f64 = Min(Real(0.0)); inMax: f64 = Max(Real(1000.0)) }
    out { outActive: bool; outValue: f64 }
    presence strict work 6;
    c Code(r"
const double most = inMax == inMin ? inMin + 1.0 : inMax;
if (inValue < inMin) {
  *outActive = false;
  *outValue = 0.0;
} else if (inValue > most) {
  *outActive = false;
  *outValue = 1.0;
} else {
  *outActive = true;
  *outValue = (inValue - inMin) / (most - inMin);
}
");
    pure |(x, min, max)| relative_position(x, min, max)
}

primitive! {
    /// Linear interpolation from `inFrom` (amount 0) to `inTo` (amount 1). Amounts outside 0 to 1 extrapolate.
    LERP = "Core::Lerp";
    in { inFrom: f64 = From(Real(0.0)); inTo: f64 = To(Real(0.0)); inAmount: f64 }
    out { outValue: f64 }
    presence strict work 3;
    c Value("inFrom + (inTo - inFrom) * inAmount");
    pure |(from, to, amount)| (from + (to - from) * amount,)
}

primitive! {
    /// Motion from 0 to 1 in unit time with a trapezoidal speed profile: constant acceleration, constant speed for the
    /// fraction `Constant` of the time, constant deceleration. 0 before the start and 1 after the end.
    RAMPIFY = "Core::Rampify";
    in { inValue: f64 }
    param { Constant: f64 = Real(0.5) }
    out { outValue: f64 }
    presence strict work 10;
    c Value("rpi_ramp(inValue, Constant)");
    full |_, _, _, (constant,), (time,)| (ramp(time, constant),)
}

primitive! {
    /// Cubic curve over the parameter `inValue` from 0 to 1 with the values `inFrom` and `inTo` and the slopes
    /// `inFromVel` and `inToVel` at its ends.
    DOUBLE_BEZIER = "Core::DoubleBezier";
    in {
        inValue: f64;
        inFrom: f64 = From(Real(0.0));
        inFromVel: f64 = FromVel(Real(0.0));
        inToVel: f64 = ToVel(Real(0.0));
        inTo: f64 = To(Real(0.0))
    }
    out { outValue: f64 }
    presence strict work 16;
    c Value("rpi_bezier(inValue, inFrom, inFrom + inFromVel / 3.0, inTo - inToVel / 3.0, inTo)");
    pure |(t, from, from_vel, to_vel, to)| (bezier(t, from, from + from_vel / 3.0, to - to_vel / 3.0, to),)
}

primitive! {
    /// Cubic Bézier curve over the parameter `inValue` from 0 to 1 with four control values.
    CUBIC_BEZIER = "Core::CubicBezier";
    in {
        inValue: f64;
        inFrom: f64 = From(Real(0.0));
        inControl1: f64 = Control1(Real(0.0));
        inControl2: f64 = Control2(Real(0.0));
        inTo: f64 = To(Real(0.0))
    }
    out { outValue: f64 }
    presence strict work 14;
    c Value("rpi_bezier(inValue, inFrom, inControl1, inControl2, inTo)");
    pure |(t, from, control1, control2, to)| (bezier(t, from, control1, control2, to),)
}

fn relative_position(x: f64, min: f64, max: f64) -> (bool, f64) {
    if x < min {
        return (false, 0.0);
    }
    let max = if max == min { min + 1.0 } else { max };
    if x > max {
        return (false, 1.0);
    }
    (true, (x - min) / (max - min))
}

/// Returns the position (0 to 1) at the relative time `time` (0 to 1) of a motion with a trapezoidal speed profile,
/// whose speed is constant during the fraction `constant` of the time.
fn ramp(time: f64, constant: f64) -> f64 {
    if time <= 0.0 {
        return 0.0;
    }
    if time >= 1.0 {
        return 1.0;
    }
    let top = 2.0 / (1.0 + constant);
    let rise = (1.0 - constant) / 2.0;
    if time < rise {
        top * time * time / (2.0 * rise)
    } else if time <= 1.0 - rise {
        top * (time - rise / 2.0)
    } else {
        1.0 - top * (1.0 - time) * (1.0 - time) / (2.0 * rise)
    }
}

/// Evaluates a cubic Bézier curve with the control values `p0` to `p3` at the parameter `t` (0 to 1), in Bernstein
/// form.
fn bezier(t: f64, p0: f64, p1: f64, p2: f64, p3: f64) -> f64 {
    let s = 1.0 - t;
    s * s * s * p0 + 3.0 * s * s * t * p1 + 3.0 * s * t * t * p2 + t * t * t * p3
}
