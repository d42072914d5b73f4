//! Exact fractions of 128-bit integers. Operations return `None` on overflow.

use std::cmp::Ordering;

/// Rational number as a fraction in lowest terms with a positive denominator.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Rational {
    numerator: i128,
    denominator: i128,
}

impl Rational {
    pub(crate) const ZERO: Rational = Rational::from_int(0);
    pub(crate) const ONE: Rational = Rational::from_int(1);

    pub(crate) const fn from_int(value: i128) -> Rational {
        Rational {
            numerator: value,
            denominator: 1,
        }
    }

    fn new(numerator: i128, denominator: i128) -> Option<Rational> {
        let shared = gcd(numerator, denominator)?.max(1);
        let sign = denominator.signum();
        Some(Rational {
            numerator: numerator.checked_div(shared)?.checked_mul(sign)?,
            denominator: denominator.checked_div(shared)?.checked_mul(sign)?,
        })
    }

    pub(crate) fn add(self, other: Rational) -> Option<Rational> {
        if self.denominator == 1 && other.denominator == 1 {
            return self
                .numerator
                .checked_add(other.numerator)
                .map(Rational::from_int);
        }
        let left = self.numerator.checked_mul(other.denominator)?;
        let right = other.numerator.checked_mul(self.denominator)?;
        let denominator = self.denominator.checked_mul(other.denominator)?;
        Rational::new(left.checked_add(right)?, denominator)
    }

    pub(crate) fn sub(self, other: Rational) -> Option<Rational> {
        self.add(other.negated()?)
    }

    pub(crate) fn mul(self, other: Rational) -> Option<Rational> {
        // Crosswise reduction keeps the products small.
        let left = Rational::new(self.numerator, other.denominator)?;
        let right = Rational::new(other.numerator, self.denominator)?;
        Rational::new(
            left.numerator.checked_mul(right.numerator)?,
            left.denominator.checked_mul(right.denominator)?,
        )
    }

    /// Returns the quotient; `None` for the divisor 0 and on overflow.
    pub(crate) fn div(self, other: Rational) -> Option<Rational> {
        if other.numerator == 0 {
            return None;
        }
        self.mul(Rational::new(other.denominator, other.numerator)?)
    }

    pub(crate) fn negated(self) -> Option<Rational> {
        Some(Rational {
            numerator: self.numerator.checked_neg()?,
            ..self
        })
    }

    pub(crate) fn is_zero(self) -> bool {
        self.numerator == 0
    }

    pub(crate) fn is_positive(self) -> bool {
        self.numerator > 0
    }

    /// Returns the value as an integer; `None` if the fraction is not an integer.
    pub(crate) fn as_int(self) -> Option<i128> {
        (self.denominator == 1).then_some(self.numerator)
    }

    pub(crate) fn denominator(self) -> i128 {
        self.denominator
    }

    /// Returns the greatest integer that is at most the fraction.
    pub(crate) fn floor(self) -> i128 {
        self.numerator.div_euclid(self.denominator)
    }

    /// Compares two fractions; `None` on overflow.
    pub(crate) fn checked_cmp(self, other: Rational) -> Option<Ordering> {
        if self.denominator == other.denominator {
            return Some(self.numerator.cmp(&other.numerator));
        }
        let left = self.numerator.checked_mul(other.denominator)?;
        let right = other.numerator.checked_mul(self.denominator)?;
        Some(left.cmp(&right))
    }
}

/// Returns the non-negative greatest common divisor; `None` on overflow.
pub(crate) fn gcd(a: i128, b: i128) -> Option<i128> {
    let (mut a, mut b) = (a.checked_abs()?, b.checked_abs()?);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    Some(a)
}
