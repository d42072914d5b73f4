//! Shares of a way, ramps and curves over one real.

use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[INTERVAL, LERP, RAMPIFY, DOUBLE_BEZIER, CUBIC_BEZIER];

primitive! {
    /// Where a value lies in the interval from `Min` to `Max` (both included): share from 0 to 1 and whether it lies inside;
    /// 0 below, 1 above. Where both bounds are equal the upper one is taken as `Min` + 1.
    INTERVAL = "Core::Interval";
    in { inValue: f64; inMin: f64 = Min(Real(0.0)); inMax: f64 = Max(Real(1000.0)) }
    out { outActive: bool; outValue: f64 }
    presence strict work 6;
    pure |(x, min, max)| share(x, min, max)
}

primitive! {
    /// Linear interpolation from `From` (amount 0) to `To` (amount 1); beyond them it goes on.
    LERP = "Core::Lerp";
    in { inFrom: f64 = From(Real(0.0)); inTo: f64 = To(Real(0.0)); inAmount: f64 }
    out { outValue: f64 }
    presence strict work 3;
    pure |(from, to, amount)| (from + (to - from) * amount,)
}

primitive! {
    /// A way from 0 to 1 in unit time with a trapezoid of speed: constant acceleration, constant speed for the share
    /// `Constant` of the time, constant deceleration. 0 before and 1 after.
    RAMPIFY = "Core::Rampify";
    in { inValue: f64 }
    param { Constant: f64 = Real(0.5) }
    out { outValue: f64 }
    presence strict work 10;
    full |_, _, _, (constant,), (time,)| (ramp(time, constant),)
}

primitive! {
    /// Cubic curve over 0 to 1 with values `From` and `To` and slopes `FromVel` and `ToVel` at its ends.
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
    pure |(t, from, from_vel, to_vel, to)| (bezier(t, from, from + from_vel / 3.0, to - to_vel / 3.0, to),)
}

primitive! {
    /// Cubic Bézier curve over 0 to 1 with its four control values.
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
    pure |(t, from, control1, control2, to)| (bezier(t, from, control1, control2, to),)
}

fn share(x: f64, min: f64, max: f64) -> (bool, f64) {
    if x < min {
        return (false, 0.0);
    }
    let max = if max == min { min + 1.0 } else { max };
    if x > max {
        return (false, 1.0);
    }
    (true, (x - min) / (max - min))
}

/// Place after unit time share `time` on a trapezoid whose top lasts for `constant` of the time.
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

/// Cubic Bézier curve in Bernstein form.
fn bezier(t: f64, p0: f64, p1: f64, p2: f64, p3: f64) -> f64 {
    let s = 1.0 - t;
    s * s * s * p0 + 3.0 * s * s * t * p1 + 3.0 * s * t * t * p2 + t * t * t * p3
}
