//! Bits of reals.

/// Addition of this number rounds a real below 2^51 to a whole number, which is in the lower bits of the sum.
pub(crate) const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// Bits of the exponent of a real.
const EXPONENT: u64 = 0x7ff;

/// The real with its upper 26 significant bits only: products of two such numbers are exact.
pub(crate) fn upper(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0xffff_ffff_f800_0000)
}

/// Exponent of a real, biased by 1023: 0 for a subnormal number, 2047 for infinity.
pub(crate) fn biased_exponent(x: f64) -> i32 {
    ((x.to_bits() >> 52) & EXPONENT) as i32
}

/// 2 to the power of n, for n from -1022 to 1023.
pub(crate) fn power_of_two(n: i32) -> f64 {
    f64::from_bits(((n + 1023) as u64) << 52)
}

/// `x` times 2 to the power of n, rounded once.
///
/// `x` is between 1/2 and 4, and `n` between -1100 and 1024.
pub(crate) fn scale(x: f64, n: i32) -> f64 {
    if n > 1022 {
        return x * power_of_two(1022) * power_of_two(n - 1022);
    }
    if n < -1000 {
        // The first product is normal, so that only the second one rounds.
        return x * power_of_two(n + 200) * power_of_two(-200);
    }
    x * power_of_two(n)
}

/// Polynomial of the second degree.
pub(crate) fn quadratic(terms: &[f64; 3], z: f64) -> f64 {
    terms[0] + z * (terms[1] + z * terms[2])
}

/// Polynomial of the third degree at `z`, whose square is `square`, with few dependent operations.
pub(crate) fn cubic(terms: &[f64; 4], z: f64, square: f64) -> f64 {
    (terms[0] + terms[1] * z) + square * (terms[2] + terms[3] * z)
}
