//! Exponential function and hyperbolic tangent.
//!
//! x = n log 2 / 128 + r, and exp x = 2^(n / 128) exp r. The first factor is in a table, the second a short polynomial.

use crate::constants::{
    EXP_TERMS, EXPM1_TERMS, POWER_STEP_HIGH, POWER_STEP_LOW, POWER_STEPS_PER_UNIT, TANH_TERMS,
};
use crate::pair::Pair;
use crate::power_tables::POWERS;
use crate::real::{ROUNDER, cubic, power_of_two, scale, upper};

/// Exponent above which the exponential function is infinite.
pub(crate) const OVERFLOW: f64 = 709.79;

/// Exponent below which the exponential function is 0.
pub(crate) const UNDERFLOW: f64 = -745.2;

/// Number below which `expm1` and `tanh` are the number itself: 2^-54.
const TINY: f64 = 5.551115123125783e-17;

/// Number above which the hyperbolic tangent is 1.
const SATURATED: f64 = 22.0;

/// An exponential function as a power of two and a factor between 1/2 and 4.
pub(crate) struct Exponential {
    /// Exponent of the power of two.
    pub(crate) exponent: i32,
    /// The factor. Its low part is up to 2^-7 of its high part.
    pub(crate) factor: Pair,
}

impl Exponential {
    /// Exponential function of x + rest, for `x` between [`UNDERFLOW`] and [`OVERFLOW`].
    pub(crate) fn new(x: f64, rest: f64) -> Exponential {
        let rounded = x * POWER_STEPS_PER_UNIT + ROUNDER;
        let count = rounded - ROUNDER;
        // The first difference is exact: 18 bits of `count` times 35 bits.
        let r = ((x - count * POWER_STEP_HIGH) - count * POWER_STEP_LOW) + rest;
        let square = r * r;
        let excess = r + square * (0.5 + r * cubic(&EXP_TERMS[0], r, square));
        let number = rounded.to_bits() as i32;
        let [high, low] = POWERS[(number & 127) as usize];
        Exponential {
            exponent: number >> 7,
            factor: Pair {
                high,
                low: low + high * excess,
            },
        }
    }

    /// The nearest real.
    pub(crate) fn value(self) -> f64 {
        scale(self.factor.value(), self.exponent)
    }

    /// The function as a pair, for an exponent between -1000 and 1000.
    fn pair(self) -> Pair {
        let factor = power_of_two(self.exponent);
        Pair {
            high: self.factor.high * factor,
            low: self.factor.low * factor,
        }
    }
}

/// e to the power of x.
pub fn exp(x: f64) -> f64 {
    if x.is_nan() {
        return f64::NAN;
    }
    if x > OVERFLOW {
        return f64::INFINITY;
    }
    if x < UNDERFLOW {
        return 0.0;
    }
    Exponential::new(x, 0.0).value()
}

/// e to the power of x, minus 1, which is accurate for small x.
pub fn expm1(x: f64) -> f64 {
    if x.abs() <= 0.125 {
        return small_expm1(x);
    }
    if x > 50.0 || x.is_nan() {
        return exp(x);
    }
    if x < -50.0 {
        return -1.0;
    }
    let power = Exponential::new(x, 0.0).pair();
    let sum = Pair::sum(power.high, -1.0);
    sum.high + (sum.low + power.low)
}

/// exp x - 1 for |x| up to 1/8.
fn small_expm1(x: f64) -> f64 {
    if x.abs() < TINY {
        return x;
    }
    let upper = upper(x);
    // x^2 / 2 in two parts, of which the first one is exact.
    let sum = Pair::ordered_sum(x, 0.5 * upper * upper);
    let rest = (x - upper) * (x + upper) * 0.5;
    let square = x * x;
    let [a, b] = &EXPM1_TERMS;
    let terms = cubic(a, x, square) + square * square * cubic(b, x, square);
    sum.high + (sum.low + (rest + x * square * terms))
}

/// Hyperbolic tangent.
pub fn tanh(x: f64) -> f64 {
    let size = x.abs();
    if size < TINY {
        return x;
    }
    if size <= 0.25 {
        let z = x * x;
        let square = z * z;
        let [a, b] = &TANH_TERMS;
        return x + x * z * (cubic(a, z, square) + square * square * cubic(b, z, square));
    }
    if x.is_nan() {
        return f64::NAN;
    }
    if size > SATURATED {
        return 1.0_f64.copysign(x);
    }
    // (exp 2x - 1) / (exp 2x + 1)
    let power = Exponential::new(2.0 * size, 0.0).pair();
    let mut numerator = Pair::ordered_sum(power.high, -1.0);
    numerator.low += power.low;
    let mut denominator = Pair::ordered_sum(power.high, 1.0);
    denominator.low += power.low;
    numerator.quotient(denominator).value().copysign(x)
}
