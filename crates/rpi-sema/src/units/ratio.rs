//! Small rational numbers, used as exponents of dimensions.

use std::fmt;

/// Rational number in lowest terms with a positive denominator, used as the exponent of a unit.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Ratio {
    num: i8,
    den: i8,
}

impl Ratio {
    /// The number 0, the exponent of a base dimension that a quantity does not have.
    pub const ZERO: Ratio = Ratio { num: 0, den: 1 };
    /// The number 1, the exponent of a base dimension in its own unit.
    pub const ONE: Ratio = Ratio { num: 1, den: 1 };
    /// The number 1/2, the exponent of a square root.
    pub const HALF: Ratio = Ratio { num: 1, den: 2 };

    /// Creates the number `num / den` in lowest terms; `None` if `den` is 0 or the result is out of range.
    #[must_use]
    pub fn new(num: i32, den: i32) -> Option<Ratio> {
        let common = gcd(num.unsigned_abs(), den.unsigned_abs()).cast_signed();
        if den == 0 || common == 0 {
            return None;
        }
        let sign = den.signum();
        Some(Ratio {
            num: i8::try_from(sign * num / common).ok()?,
            den: i8::try_from(sign * den / common).ok()?,
        })
    }

    /// Creates the number from an integer; `None` if it is out of range.
    #[must_use]
    pub fn from_int(value: i32) -> Option<Ratio> {
        let num = i8::try_from(value).ok()?;
        Some(Ratio { num, den: 1 })
    }

    /// Returns the ratio with a denominator of at most 12 that differs from `value` by less than about 1e-9; `None` if
    /// there is none.
    #[must_use]
    pub fn from_real(value: f64) -> Option<Ratio> {
        (1..=12i32).find_map(|den| {
            let num = value * f64::from(den);
            let near = (num - num.round()).abs() < 1e-9 && num.abs() < 1e3;
            near.then(|| Ratio::new(num.round() as i32, den)).flatten()
        })
    }

    /// Returns the sum of two ratios; `None` if the numerator or denominator of the result is out of range.
    #[must_use]
    pub fn plus(self, other: Ratio) -> Option<Ratio> {
        if self.den == 1 && other.den == 1 {
            let num = self.num.checked_add(other.num)?;
            return Some(Ratio { num, den: 1 });
        }
        let (a, b) = (self.expr_leaves(), other.expr_leaves());
        Ratio::new(a.0 * b.1 + b.0 * a.1, a.1 * b.1)
    }

    /// Returns the product of two ratios; `None` if the numerator or denominator of the result is out of range.
    #[must_use]
    pub fn times(self, other: Ratio) -> Option<Ratio> {
        if self.den == 1 && other.den == 1 {
            let num = self.num.checked_mul(other.num)?;
            return Some(Ratio { num, den: 1 });
        }
        let (a, b) = (self.expr_leaves(), other.expr_leaves());
        Ratio::new(a.0 * b.0, a.1 * b.1)
    }

    /// Returns the number with the opposite sign.
    #[must_use]
    pub fn negate(self) -> Ratio {
        Ratio {
            num: -self.num,
            den: self.den,
        }
    }

    /// Returns whether the number is 0.
    #[must_use]
    pub fn is_zero(self) -> bool {
        self.num == 0
    }

    /// Returns whether the number is less than 0.
    #[must_use]
    pub fn is_negative(self) -> bool {
        self.num < 0
    }

    fn expr_leaves(self) -> (i32, i32) {
        (self.num.into(), self.den.into())
    }
}

impl fmt::Display for Ratio {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.den {
            1 => write!(f, "{}", self.num),
            den => write!(f, "({}/{den})", self.num),
        }
    }
}

fn gcd(a: u32, b: u32) -> u32 {
    match b {
        0 => a,
        _ => gcd(b, a % b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lowest_terms_and_positive_denominator() {
        assert_eq!(Ratio::new(2, -4), Ratio::new(-1, 2));
        assert_eq!(Ratio::new(0, 5), Some(Ratio::ZERO));
        assert_eq!(Ratio::new(1, 0), None);
        assert_eq!(Ratio::new(200, 1), None);
    }

    #[test]
    fn arithmetic() {
        let third = Ratio::new(1, 3).unwrap();
        assert_eq!(Ratio::HALF.plus(third), Ratio::new(5, 6));
        assert_eq!(Ratio::HALF.times(third), Ratio::new(1, 6));
        assert_eq!(Ratio::HALF.plus(Ratio::HALF.negate()), Some(Ratio::ZERO));
    }

    #[test]
    fn reals_with_small_denominators_are_ratios() {
        assert_eq!(Ratio::from_real(0.5), Some(Ratio::HALF));
        assert_eq!(Ratio::from_real(-2.0), Ratio::from_int(-2));
        assert_eq!(Ratio::from_real(std::f64::consts::PI), None);
        assert_eq!(Ratio::from_real(f64::NAN), None);
    }
}
