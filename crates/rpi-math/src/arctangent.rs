//! Arctangent of a number and of a ratio.
//!
//! A ratio of at most 1 is the sum of a multiple c of 1 / 64 and a rest d. A table has atan c and a short polynomial
//! of d for atan (c + d) - atan c - d, so that one division is enough.

use core::f64::consts::FRAC_PI_4;

use crate::circle_tables::{ANGLE_TERMS, ANGLES};
use crate::constants::{QUARTER_HIGH, QUARTER_LOW};
use crate::pair::Pair;
use crate::real::{ROUNDER, biased_exponent, power_of_two};

/// Number below which the arctangent is the number itself: 2^-27.
const TINY: f64 = 7.450580596923828e-9;

/// Number above which the arctangent is pi / 2: 2^60.
const HUGE: f64 = 1_152_921_504_606_846_976.0;

/// Difference of exponents beyond which the smaller coordinate does not matter beside a multiple of pi / 2.
const FAR: i32 = 60;

/// Least and greatest biased exponent of coordinates whose products and their rounding errors are normal.
const MIDDLE: core::ops::Range<i32> = 500..1500;

/// Multiple of pi / 2 from which the angle of the ratio is measured, in two parts, and the direction: for points with x > 0 next to the
/// axis of x and of y, and the same with x < 0.
const OCTANTS: [[f64; 3]; 4] = [
    [0.0, 0.0, 1.0],
    [QUARTER_HIGH, QUARTER_LOW, -1.0],
    [2.0 * QUARTER_HIGH, 2.0 * QUARTER_LOW, -1.0],
    [QUARTER_HIGH, QUARTER_LOW, 1.0],
];

/// Arctangent in rad, from -pi / 2 to pi / 2.
pub fn atan(x: f64) -> f64 {
    let size = x.abs();
    if size < TINY {
        return x;
    }
    if size <= HUGE {
        return angle_of_point(size, 1.0, false).copysign(x);
    }
    if x.is_nan() {
        return f64::NAN;
    }
    QUARTER_HIGH.copysign(x)
}

/// Angle in rad of the vector from the origin to the point (x, y), from -pi to pi.
pub fn atan2(y: f64, x: f64) -> f64 {
    let (exponent_y, exponent_x) = (biased_exponent(y), biased_exponent(x));
    let is_near = (exponent_y - exponent_x).abs() <= FAR;
    if is_near && MIDDLE.contains(&exponent_y) {
        return angle_of_point(y.abs(), x.abs(), x < 0.0).copysign(y);
    }
    special_angle(y, x)
}

/// Angle of a point with a coordinate that is not a number, infinite, 0, very large or small, or far less than the other.
#[cold]
fn special_angle(y: f64, x: f64) -> f64 {
    if x.is_nan() || y.is_nan() {
        return f64::NAN;
    }
    let (size_x, size_y) = (x.abs(), y.abs());
    let difference = biased_exponent(y) - biased_exponent(x);
    let angle = if size_x == size_y && x.is_infinite() {
        diagonal(x)
    } else if size_y == 0.0 || x.is_infinite() || difference < -FAR {
        near_axis(size_y, x)
    } else if size_x == 0.0 || y.is_infinite() || difference > FAR {
        QUARTER_HIGH
    } else {
        let factor = if biased_exponent(y) < MIDDLE.start {
            power_of_two(600)
        } else {
            power_of_two(-600)
        };
        angle_of_point(size_y * factor, size_x * factor, x < 0.0)
    };
    angle.copysign(y)
}

/// Angle of a point between the axes at infinity.
fn diagonal(x: f64) -> f64 {
    if x < 0.0 { 3.0 * FRAC_PI_4 } else { FRAC_PI_4 }
}

/// Angle of a point next to the axis of x.
fn near_axis(size_y: f64, x: f64) -> f64 {
    if x.is_sign_negative() {
        return 2.0 * QUARTER_HIGH;
    }
    // The cubic term is far below the rounding error. 0 / 0 is not wanted.
    if size_y == 0.0 { 0.0 } else { size_y / x }
}

/// Angle of a point whose coordinates differ by less than 2^61, or 2^113 for subnormal numbers, and whose x is negative
/// if it is on the `left`.
fn angle_of_point(size_y: f64, size_x: f64, left: bool) -> f64 {
    let is_steep = size_y > size_x;
    let (u, v) = if is_steep {
        (size_x, size_y)
    } else {
        (size_y, size_x)
    };
    let angle = angle_of_ratio(u, v);
    // A table instead of branches: the octants of a motion around a point alternate.
    let [high, low, sign] = OCTANTS[usize::from(left) * 2 + usize::from(is_steep)];
    let sum = Pair::ordered_sum(high, sign * angle.high);
    sum.high + (sum.low + (low + sign * angle.low))
}

/// Arctangent of u / v for 0 <= u <= v. The low part is up to 2^-8 of the high part.
fn angle_of_ratio(u: f64, v: f64) -> Pair {
    let ratio = Pair::exact(u).quotient(Pair::exact(v));
    let rounded = ratio.high + ROUNDER / 64.0;
    // Exact, with at most 26 bits.
    let d_high = ratio.high - (rounded - ROUNDER / 64.0);
    let d = d_high + ratio.low;
    let square = d * d;
    let row = (rounded.to_bits() as usize & 127).min(64);
    let [high, low] = ANGLES[row];
    let [t0, t1, t2, t3, t4, t5, t6] = ANGLE_TERMS[row];
    let terms = (t0 + t1 * d) + square * ((t2 + t3 * d) + square * ((t4 + t5 * d) + square * t6));
    let sum = Pair::ordered_sum(high, d_high);
    Pair {
        high: sum.high,
        low: sum.low + (low + (ratio.low + d * terms)),
    }
}
