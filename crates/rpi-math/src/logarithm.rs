//! Natural logarithm.
//!
//! x = 2^k m with m from 0.69 to 1.38. A table has a number c near 1 / m with few bits, so that r = c m - 1 is small and
//! exact in two reals: log x = k log 2 - log c + log (1 + r).

use crate::constants::{LN_TWO_HIGH, LN_TWO_LOW, LOG_TERMS};
use crate::pair::Pair;
use crate::power_tables::LOGARITHMS;
use crate::real::quadratic;

/// Bits of the real with which the intervals of the table begin. 1 is in the middle of an interval, whose c is 1.
const FIRST: u64 = 0x3fe6_1000_0000_0000;

/// 2^54, which makes a subnormal number normal.
const NORMALISER: f64 = 18_014_398_509_481_984.0;

/// Natural logarithm: -infinity of 0, and not a number if `x` is negative.
pub fn log(x: f64) -> f64 {
    if x.is_nan() || x < 0.0 {
        return f64::NAN;
    }
    if x == 0.0 {
        return f64::NEG_INFINITY;
    }
    if x == f64::INFINITY {
        return x;
    }
    logarithm(x).high
}

/// Logarithm of a positive finite real. The error is below 2^-66 of the logarithm.
pub(crate) fn logarithm(x: f64) -> Pair {
    let (bits, bias) = if x < f64::MIN_POSITIVE {
        ((x * NORMALISER).to_bits(), 54)
    } else {
        (x.to_bits(), 0)
    };
    let offset = bits.wrapping_sub(FIRST);
    let exponent = (offset as i64 >> 52) as i32;
    let m = bits.wrapping_sub(offset & 0xfff0_0000_0000_0000);
    let [c, high, low] = LOGARITHMS[((offset >> 45) & 127) as usize];
    let k = f64::from(exponent - bias);
    let r = reduced(m, c);
    sum(
        Pair {
            high: k * LN_TWO_HIGH + high,
            low: k * LN_TWO_LOW + low,
        },
        r,
    )
}

/// c m - 1, which is exact: both parts of m have few enough bits for a product with the 13 bits of c.
fn reduced(m: u64, c: f64) -> Pair {
    let upper = f64::from_bits(m & 0xffff_ffff_0000_0000);
    let lower = f64::from_bits(m) - upper;
    Pair::ordered_sum(upper * c - 1.0, lower * c)
}

/// base + log (1 + r), where `base` is 0 or greater than r in size.
fn sum(base: Pair, r: Pair) -> Pair {
    let square = Pair::square(r.high);
    let first = Pair::ordered_sum(base.high, r.high);
    let second = Pair::ordered_sum(first.high, -0.5 * square.high);
    let [a, b] = &LOG_TERMS;
    let z = r.high * r.high;
    let terms = quadratic(a, r.high) + r.high * z * quadratic(b, r.high);
    let small = (base.low + (r.low - r.high * r.low)) + (r.high * z * terms - 0.5 * square.low);
    Pair::ordered_sum(second.high, (first.low + second.low) + small)
}
