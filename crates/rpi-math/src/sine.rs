//! Sine, cosine and tangent.
//!
//! The argument is reduced to a remainder by pi / 32. Sine and cosine of the multiple are in a table, and those of the
//! remainder are short polynomials: sin (a + r) = sin a cos r + cos a sin r.

use crate::circle_tables::SINES;
use crate::constants::{COS_TERMS, SIN_TERMS, STEP_HIGH, STEP_LOW, STEP_MIDDLE, STEPS_PER_UNIT};
use crate::large_angle::reduce_large;
use crate::pair::Pair;
use crate::real::{ROUNDER, quadratic, upper};

/// Angle below which `STEP_LOW` times the number of steps is far below the rounding error of the remainder.
const MEDIUM: f64 = 1024.0;

/// Angle below which `STEP_HIGH` and `STEP_MIDDLE` times the number of steps are exact: 2^17.
const LARGE: f64 = 131_072.0;

/// Angle below which the sine is the angle itself: 2^-27.
const TINY: f64 = 7.450580596923828e-9;

/// Remainder per step below which the reduction by three parts is too coarse: 2^-58. Multiples of the real next to pi / 2
/// have slightly more, so that these common angles take the short way.
const CLOSE: f64 = 3.469446951953614e-18;

/// An angle as a multiple of pi / 32 and a remainder.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Angle {
    /// The multiple. Only its lower 6 bits have a meaning.
    pub(crate) step: u32,
    /// The remainder in rad, of at most pi / 64.
    pub(crate) rest: Pair,
}

/// The parts of an angle, and sine and cosine of its remainder r.
struct Remainder {
    step: u32,
    /// 26 bits of r.
    upper: f64,
    /// sin r without `upper`.
    sine: f64,
    /// cos r - 1.
    cosine: f64,
}

/// Steps from the sine to the cosine: pi / 2.
const QUARTER: u32 = 16;

/// Sine of an angle in rad. The sine of an infinity is not a number.
pub fn sin(x: f64) -> f64 {
    if x.abs() < TINY {
        return x;
    }
    match reduce_near(x) {
        Some(angle) => Remainder::new(angle).sine_after(0).value(),
        None => far_sine_after(x, 0),
    }
}

/// Cosine of an angle in rad. The cosine of an infinity is not a number.
pub fn cos(x: f64) -> f64 {
    match reduce_near(x) {
        Some(angle) => Remainder::new(angle).sine_after(QUARTER).value(),
        None => far_sine_after(x, QUARTER),
    }
}

/// Sine and cosine of an angle in rad, with the bits of [`sin`] and [`cos`].
pub fn sincos(x: f64) -> (f64, f64) {
    let Some(angle) = reduce_near(x) else {
        return (far_sine_after(x, 0), far_sine_after(x, QUARTER));
    };
    let remainder = Remainder::new(angle);
    let cosine = remainder.sine_after(QUARTER).value();
    if x.abs() < TINY {
        return (x, cosine);
    }
    (remainder.sine_after(0).value(), cosine)
}

/// Tangent of an angle in rad. The tangent of an infinity is not a number.
pub fn tan(x: f64) -> f64 {
    if x.abs() < TINY {
        return x;
    }
    match reduce_near(x) {
        Some(angle) => Remainder::new(angle).tangent(),
        None => Remainder::new(reduce_far(x)).tangent(),
    }
}

/// Sine of an angle that is not near, and that is turned by some steps. Apart, so that near angles stay in registers.
#[cold]
#[inline(never)]
fn far_sine_after(x: f64, steps: u32) -> f64 {
    Remainder::new(reduce_far(x)).sine_after(steps).value()
}

/// Reduces an angle below [`MEDIUM`] to a multiple of pi / 32 and a remainder. Nothing if the angle is not below, or if the
/// remainder is too small.
fn reduce_near(x: f64) -> Option<Angle> {
    if x.abs() < MEDIUM {
        reduce_by_parts(x)
    } else {
        None
    }
}

/// Reduces any angle. The remainder of an infinity is not a number.
fn reduce_far(x: f64) -> Angle {
    if !x.is_finite() {
        return Angle {
            step: 0,
            rest: Pair::exact(f64::NAN),
        };
    }
    let small = if x.abs() < LARGE {
        reduce_by_parts(x)
    } else {
        None
    };
    small.map_or_else(
        || reduce_large(x),
        |angle| Angle {
            step: angle.step,
            rest: Pair::ordered_sum(angle.rest.high, angle.rest.low),
        },
    )
}

/// Subtracts the multiple of pi / 32 in three parts (W. J. Cody and W. Waite, Software manual for the elementary
/// functions, 1980). Nothing if the remainder is so small that they are too coarse.
fn reduce_by_parts(x: f64) -> Option<Angle> {
    let rounded = x * STEPS_PER_UNIT + ROUNDER;
    let count = rounded - ROUNDER;
    // Both products and both differences are exact.
    let first = Pair::ordered_sum(x - count * STEP_HIGH, -(count * STEP_MIDDLE));
    if first.high.abs() < count.abs() * CLOSE {
        return None;
    }
    Some(Angle {
        step: rounded.to_bits() as u32,
        rest: Pair {
            high: first.high,
            low: first.low - count * STEP_LOW,
        },
    })
}

impl Remainder {
    fn new(angle: Angle) -> Remainder {
        let Pair { high, low } = angle.rest;
        let square = high * high;
        let upper = upper(high);
        Remainder {
            step: angle.step,
            upper,
            sine: (high - upper) + (low + high * square * quadratic(&SIN_TERMS[0], square)),
            cosine: square * (square * quadratic(&COS_TERMS[0], square) - 0.5) - high * low,
        }
    }

    fn tangent(&self) -> f64 {
        let cosine = self.sine_after(QUARTER);
        self.sine_after(0).quotient(cosine).value()
    }

    /// Sine of the angle that is `steps` times pi / 32 further. The low part is up to 2^-25 of the high part.
    fn sine_after(&self, steps: u32) -> Pair {
        let step = self.step.wrapping_add(steps);
        let [sine_high, sine_low, sine] = SINES[(step & 63) as usize];
        let [cosine_high, cosine_low, cosine] = SINES[(step.wrapping_add(QUARTER) & 63) as usize];
        // The table has 26 bits in the high parts, so that the product is exact.
        let sum = Pair::ordered_sum(sine_high, cosine_high * self.upper);
        let products = cosine_low * self.upper + cosine * self.sine + sine * self.cosine;
        Pair {
            high: sum.high,
            low: sum.low + (sine_low + products),
        }
    }
}
