//! Reduction of large angles, and of angles next to a multiple of pi / 32.
//!
//! An angle is an integer times a power of two. The integer is multiplied with those bits of 1 / (2 pi) that matter for the
//! fraction of a turn (M. Payne and R. Hanek, Radian reduction for trigonometric functions, 1983). All of this is exact
//! arithmetic of integers.

use crate::circle_tables::TURN_WORDS;
use crate::constants::{TURN_HIGH, TURN_LOW};
use crate::pair::Pair;
use crate::real::power_of_two;
use crate::sine::Angle;

/// Words of 32 bits of the fraction of a turn, the first one first. An angle is at least 2^-62 away from the multiples
/// of pi / 2, so that 224 bits leave more than 100 of the remainder.
const WORDS: usize = 7;

/// Bits of zeros before the fraction of 1 / (2 pi) in the table.
const ZEROS: i32 = 64;

/// Reduces a finite angle of at least 2^-10 rad in size.
#[cold]
pub(crate) fn reduce_large(x: f64) -> Angle {
    let bits = x.to_bits();
    let exponent = ((bits >> 52) & 0x7ff) as i32 - 1075;
    let integer = (bits & 0x000f_ffff_ffff_ffff) | 0x0010_0000_0000_0000;
    let mut fraction = turn_fraction(integer, (exponent + ZEROS) as u32);
    // The first 6 bits, rounded, are the multiple of pi / 32.
    let step = ((fraction[0] >> 25) + 1) >> 1;
    fraction[0] = fraction[0].wrapping_sub(step << 26);
    let below = fraction[0] >> 31 != 0;
    if below {
        negate(&mut fraction);
    }
    let rest = angle_of_fraction(&fraction);
    let negative = below != (bits >> 63 != 0);
    Angle {
        step: if bits >> 63 != 0 {
            step.wrapping_neg()
        } else {
            step
        },
        rest: if negative {
            Pair {
                high: -rest.high,
                low: -rest.low,
            }
        } else {
            rest
        },
    }
}

/// Fraction of `integer` times 1 / (2 pi), where the table begins `skipped` bits later.
fn turn_fraction(integer: u64, skipped: u32) -> [u32; WORDS] {
    let first = (skipped / 32) as usize;
    let shift = skipped % 32;
    let (upper, lower) = (integer >> 32, integer & 0xffff_ffff);
    let mut fraction = [0_u32; WORDS];
    let mut carry = 0_u64;
    let mut above = 0_u64;
    for k in (0..WORDS).rev() {
        let both = (u64::from(TURN_WORDS[first + k]) << 32) | u64::from(TURN_WORDS[first + k + 1]);
        let word = (both << shift) >> 32;
        // The upper half of the integer contributes one word further up.
        carry += above;
        let low = word * lower;
        let sum = (low & 0xffff_ffff) + (carry & 0xffff_ffff);
        fraction[k] = sum as u32;
        carry = (carry >> 32) + (low >> 32) + (sum >> 32);
        above = word * upper;
    }
    fraction
}

/// Two's complement of a number of several words.
fn negate(words: &mut [u32; WORDS]) {
    let mut carry = 1_u64;
    for word in words.iter_mut().rev() {
        let sum = u64::from(!*word) + carry;
        *word = sum as u32;
        carry = sum >> 32;
    }
}

/// Angle in rad of a fraction of a turn.
fn angle_of_fraction(fraction: &[u32; WORDS]) -> Pair {
    let mut first = 0;
    while first < WORDS - 4 && fraction[first] == 0 {
        first += 1;
    }
    let word = |k: usize| u64::from(fraction[first + k]);
    let (mut high, mut low) = ((word(0) << 32) | word(1), (word(2) << 32) | word(3));
    let mut exponent = -(32 * first as i32);
    while high >> 63 == 0 && exponent > -300 {
        high = (high << 1) | (low >> 63);
        low <<= 1;
        exponent -= 1;
    }
    // 53 bits each.
    let rest = ((high & 0x7ff) << 42) | (low >> 22);
    let high = (high >> 11) as f64 * power_of_two(exponent - 53);
    let low = rest as f64 * power_of_two(exponent - 106);
    let product = Pair::product(high, TURN_HIGH);
    Pair::ordered_sum(
        product.high,
        product.low + (high * TURN_LOW + low * TURN_HIGH),
    )
}
