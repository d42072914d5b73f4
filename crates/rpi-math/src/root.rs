//! Cube root, and length of a vector.

use crate::constants::CBRT_TERMS;
use crate::pair::Pair;
use crate::power_tables::CUBE_ROOTS;
use crate::real::{biased_exponent, cubic, power_of_two, upper};

/// 2^54, which makes a subnormal number normal.
const NORMALISER: f64 = 18_014_398_509_481_984.0;

/// 2^-18, the inverse of the cube root of [`NORMALISER`].
const INVERSE_ROOT: f64 = 3.814697265625e-6;

/// Difference of exponents beyond which the shorter side does not matter.
const FAR: i32 = 60;

/// Cube root.
pub fn cbrt(x: f64) -> f64 {
    if x == 0.0 || x.is_infinite() {
        return x;
    }
    if x.is_nan() {
        return f64::NAN;
    }
    let size = x.abs();
    let root = if size < f64::MIN_POSITIVE {
        positive_cbrt(size * NORMALISER) * INVERSE_ROOT
    } else {
        positive_cbrt(size)
    };
    root.copysign(x)
}

/// Cube root of a positive normal number x = 8^q v, with v from 1 to 8.
fn positive_cbrt(x: f64) -> f64 {
    // The bias 1023 is a multiple of 3.
    let exponent = biased_exponent(x);
    let third = exponent / 3;
    let [inverse, factor] = CUBE_ROOTS[(exponent % 3) as usize];
    let m = f64::from_bits((x.to_bits() & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
    let v = m * factor;
    let t = m - 1.0;
    let estimate = inverse * cubic(&CBRT_TERMS[0], t, t * t);
    // One step of the fourth order for 1 / cbrt v: e is the relative error of the cube.
    let e = 1.0 - v * (estimate * estimate * estimate);
    let step = e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0)));
    let w = estimate + estimate * step;
    let w_square = w * w;
    // The root with 26 bits, whose square is exact, and a correction of the second order, where w is that of the exact root.
    let y = upper(v * w_square);
    let y_square = y * y;
    let square_upper = upper(y_square);
    let rest = (v - square_upper * y) - (y_square - square_upper) * y;
    let correction = rest * w_square * (1.0 / 3.0);
    let root = y + (correction + correction * correction * w);
    root * power_of_two(third - 341)
}

/// Length of the vector (x, y), without overflow of the squares. Infinite if one of them is.
pub fn hypot(x: f64, y: f64) -> f64 {
    if x.is_infinite() || y.is_infinite() {
        return f64::INFINITY;
    }
    if x.is_nan() || y.is_nan() {
        return f64::NAN;
    }
    let (size_x, size_y) = (x.abs(), y.abs());
    let (long, short) = if size_x < size_y {
        (size_y, size_x)
    } else {
        (size_x, size_y)
    };
    let exponent = biased_exponent(long);
    if short == 0.0 || exponent - biased_exponent(short) > FAR {
        return long + short;
    }
    // The scale keeps the squares and their rounding errors normal.
    if exponent > 1500 {
        length(long * power_of_two(-600), short * power_of_two(-600)) * power_of_two(600)
    } else if exponent < 600 {
        length(long * power_of_two(600), short * power_of_two(600)) * power_of_two(-600)
    } else {
        length(long, short)
    }
}

/// Square root of the sum of two squares, where the first number is the greater one.
fn length(long: f64, short: f64) -> f64 {
    let (first, second) = (Pair::square(long), Pair::square(short));
    let sum = Pair::ordered_sum(first.high, second.high);
    let low = sum.low + (first.low + second.low);
    // Half of the relative error of the sum is at most 0.36 units in the last place of the root.
    libm::sqrt(sum.high + low)
}
