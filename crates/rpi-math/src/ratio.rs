//! Arcsine and arccosine.
//!
//! Up to 1/2 the arcsine is a polynomial. Beyond, acos x = 2 asin (sqrt ((1 - x) / 2)), whose argument is at most 1/2.

use crate::constants::{ASIN_TERMS, QUARTER_HIGH, QUARTER_LOW};
use crate::pair::Pair;
use crate::real::cubic;

/// Number below which the arcsine is the number itself: 2^-27.
const TINY: f64 = 7.450580596923828e-9;

/// Arcsine in rad, from -pi / 2 to pi / 2. Not a number if `x` is beyond 1.
pub fn asin(x: f64) -> f64 {
    let size = x.abs();
    if size < TINY {
        return x;
    }
    if size <= 0.5 {
        return x + x * asin_excess(x * x);
    }
    if size < 1.0 {
        let half = half_arccosine(size);
        let sum = Pair::ordered_sum(QUARTER_HIGH, -2.0 * half.high);
        let angle = sum.high + (sum.low + (QUARTER_LOW - 2.0 * half.low));
        return angle.copysign(x);
    }
    if size == 1.0 {
        return QUARTER_HIGH.copysign(x);
    }
    f64::NAN
}

/// Arccosine in rad, from 0 to pi. Not a number if `x` is beyond 1.
pub fn acos(x: f64) -> f64 {
    let size = x.abs();
    if size <= 0.5 {
        let sum = Pair::ordered_sum(QUARTER_HIGH, -x);
        return sum.high + (sum.low + (QUARTER_LOW - x * asin_excess(x * x)));
    }
    if size < 1.0 {
        let half = half_arccosine(size);
        if x > 0.0 {
            return 2.0 * half.value();
        }
        let sum = Pair::ordered_sum(2.0 * QUARTER_HIGH, -2.0 * half.high);
        return sum.high + (sum.low + 2.0 * (QUARTER_LOW - half.low));
    }
    if size == 1.0 {
        return if x > 0.0 { 0.0 } else { 2.0 * QUARTER_HIGH };
    }
    f64::NAN
}

/// (asin x - x) / x of z = x^2, up to 1/4.
fn asin_excess(z: f64) -> f64 {
    let square = z * z;
    let fourth = square * square;
    let [a, b, c, d] = &ASIN_TERMS;
    let upper = cubic(c, z, square) + fourth * cubic(d, z, square);
    z * ((cubic(a, z, square) + fourth * cubic(b, z, square)) + fourth * fourth * upper)
}

/// Half of the arccosine of `x` from 1/2 to 1. The low part is up to 1/20 of the high part.
fn half_arccosine(x: f64) -> Pair {
    // Exact, as is the difference of two numbers of which one is at most twice the other.
    let z = (1.0 - x) * 0.5;
    let root = Pair::exact(z).root();
    Pair {
        high: root.high,
        low: root.low + root.high * asin_excess(z),
    }
}
