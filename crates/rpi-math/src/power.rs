//! Powers: x^y = exp (y log x), with the logarithm in two reals.

use crate::exponential::{Exponential, OVERFLOW, UNDERFLOW};
use crate::logarithm::logarithm;
use crate::pair::Pair;

/// Kind of an exponent: decides the sign of a power of a negative number.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Parity {
    Even,
    Odd,
    Fraction,
}

/// `x` to the power of `y`. Not a number if `x` is negative and `y` is not a whole number.
pub fn pow(x: f64, y: f64) -> f64 {
    if y == 0.0 || x == 1.0 {
        return 1.0;
    }
    if x.is_nan() || y.is_nan() {
        return f64::NAN;
    }
    let size = x.abs();
    if y.is_infinite() {
        return limit(size, y);
    }
    let parity = parity(y);
    let sign = if x.is_sign_negative() && parity == Parity::Odd {
        -1.0
    } else {
        1.0
    };
    if size == 0.0 || size == f64::INFINITY {
        let vanishes = (size == 0.0) == (y > 0.0);
        return sign * if vanishes { 0.0 } else { f64::INFINITY };
    }
    if x < 0.0 && parity == Parity::Fraction {
        return f64::NAN;
    }
    sign * positive_power(size, y)
}

/// `size` to the power of an infinite `y`.
fn limit(size: f64, y: f64) -> f64 {
    if size == 1.0 {
        1.0
    } else if (size > 1.0) == (y > 0.0) {
        f64::INFINITY
    } else {
        0.0
    }
}

/// A positive finite number to the power of a finite `y`.
fn positive_power(x: f64, y: f64) -> f64 {
    let logarithm = logarithm(x);
    let estimate = y * logarithm.high;
    if estimate > OVERFLOW {
        return f64::INFINITY;
    }
    if estimate < UNDERFLOW {
        return 0.0;
    }
    let exponent = Pair::product(y, logarithm.high);
    Exponential::new(exponent.high, exponent.low + y * logarithm.low).value()
}

/// Kind of a finite exponent other than 0.
fn parity(y: f64) -> Parity {
    let size = y.abs();
    if size >= 9_007_199_254_740_992.0 {
        return Parity::Even;
    }
    let whole = size as i64;
    if whole as f64 != size {
        Parity::Fraction
    } else if whole & 1 == 0 {
        Parity::Even
    } else {
        Parity::Odd
    }
}
