//! Unevaluated sums of two reals, with about 106 bits.

use crate::real::upper;

/// The sum `high + low`, where `low` is much less than `high` in size: a rounding error, or as stated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    /// The nearest real, or a real near it.
    pub(crate) high: f64,
    /// The rest.
    pub(crate) low: f64,
}

impl Pair {
    /// The pair of a real.
    pub(crate) fn exact(x: f64) -> Pair {
        Pair { high: x, low: 0.0 }
    }

    /// The exact sum of two reals. `large` is 0, or not less than `small` in size, or a multiple of the last place of
    /// `small`.
    pub(crate) fn ordered_sum(large: f64, small: f64) -> Pair {
        let high = large + small;
        Pair {
            high,
            low: (large - high) + small,
        }
    }

    /// The exact sum of two reals.
    pub(crate) fn sum(a: f64, b: f64) -> Pair {
        let high = a + b;
        let part = high - a;
        Pair {
            high,
            low: (a - (high - part)) + (b - part),
        }
    }

    /// The product of two reals. The error is below 2^-105 of the product.
    pub(crate) fn product(a: f64, b: f64) -> Pair {
        let (ah, bh) = (upper(a), upper(b));
        let (al, bl) = (a - ah, b - bh);
        let high = a * b;
        Pair {
            high,
            low: (((ah * bh - high) + ah * bl) + al * bh) + al * bl,
        }
    }

    /// The square of a real, with 52 bits in the high part. The error is below 2^-78 of the square.
    pub(crate) fn square(x: f64) -> Pair {
        let upper = upper(x);
        Pair {
            high: upper * upper,
            low: (x - upper) * (x + upper),
        }
    }

    /// The quotient of two pairs, with 26 bits in the high part. The error is below 2^-70 of the quotient.
    ///
    /// The low parts may be up to 2^-17 of the high parts.
    pub(crate) fn quotient(self, divisor: Pair) -> Pair {
        let inverse = 1.0 / divisor.value();
        let high = upper(self.high * inverse);
        // The product of the two upper parts is exact.
        let divisor_upper = upper(divisor.high);
        let divisor_rest = (divisor.high - divisor_upper) + divisor.low;
        let rest = (self.high - high * divisor_upper) + (self.low - high * divisor_rest);
        Pair {
            high,
            low: rest * inverse,
        }
    }

    /// The square root of a pair whose low part is a rounding error. The error is below 2^-70 of the root.
    pub(crate) fn root(self) -> Pair {
        let high = libm::sqrt(self.high);
        let square = Pair::square(high);
        let rest = ((self.high - square.high) - square.low) + self.low;
        Pair {
            high,
            low: rest * (0.5 / high),
        }
    }

    /// The nearest real.
    pub(crate) fn value(self) -> f64 {
        self.high + self.low
    }
}
