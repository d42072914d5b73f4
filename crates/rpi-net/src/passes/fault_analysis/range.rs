//! Intervals of integers, and arithmetic on them. A Boolean is 0 or 1.

use rpi_image::{Scalar, Type, Value};

/// Interval of the values of an integer or Boolean flow while it is present, both bounds included. Booleans are 0 and
/// 1.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Interval {
    pub(super) lo: i64,
    pub(super) hi: i64,
    /// Whether the value is never 0, although 0 may lie between the bounds.
    pub(super) no_zero: bool,
}

impl Interval {
    pub(super) const ALL: Interval = Interval::new(i64::MIN, i64::MAX);
    pub(super) const BOOL: Interval = Interval::new(0, 1);
    pub(super) const TRUE: Interval = Interval::new(1, 1);
    pub(super) const FALSE: Interval = Interval::new(0, 0);

    pub(super) const fn new(lo: i64, hi: i64) -> Interval {
        Interval {
            lo,
            hi,
            no_zero: false,
        }
    }

    /// Returns the interval of all values of a type; `None` for a type that is not analysed.
    pub(super) fn from_type(ty: Type) -> Option<Interval> {
        match ty {
            Type::Scalar(Scalar::Bool) => Some(Interval::BOOL),
            Type::Scalar(Scalar::Int) => Some(Interval::ALL),
            _ => None,
        }
    }

    pub(super) fn from_value(value: &Value) -> Option<Interval> {
        let number = value.as_int().or(value.as_bool().map(i64::from))?;
        Some(Interval::new(number, number))
    }

    pub(super) fn from_bool(truth: Option<bool>) -> Interval {
        match truth {
            Some(true) => Interval::TRUE,
            Some(false) => Interval::FALSE,
            None => Interval::BOOL,
        }
    }

    /// Returns the truth value of a Boolean's interval if it has only one value; `None` otherwise.
    pub(super) fn as_bool(self) -> Option<bool> {
        (self.lo == self.hi).then_some(self.lo != 0)
    }

    pub(super) fn has_zero(self) -> bool {
        !self.no_zero && self.lo <= 0 && self.hi >= 0
    }

    /// Returns the smallest interval that contains both intervals (join).
    pub(super) fn join(self, other: Interval) -> Interval {
        Interval {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
            no_zero: !self.has_zero() && !other.has_zero(),
        }
    }

    /// Returns the intersection of both intervals (meet). Returns `self` if the intersection is empty: the flow is then
    /// never present, so any interval is sound.
    pub(super) fn meet(self, other: Interval) -> Interval {
        let both = Interval {
            lo: self.lo.max(other.lo),
            hi: self.hi.min(other.hi),
            no_zero: self.no_zero || other.no_zero,
        };
        if both.lo > both.hi {
            self
        } else {
            both.trimmed()
        }
    }

    /// Returns the interval with a bound that is 0 moved by one, if the value 0 is excluded.
    fn trimmed(self) -> Interval {
        let mut range = self;
        if range.no_zero && range.lo == 0 && range.hi > 0 {
            range.lo = 1;
        }
        if range.no_zero && range.hi == 0 && range.lo < 0 {
            range.hi = -1;
        }
        range
    }

    /// Returns the interval without one value. The interval is unchanged if the value lies inside it and is not 0.
    pub(super) fn without(self, value: i64) -> Interval {
        let mut range = self;
        if value == 0 {
            range.no_zero = true;
        } else if range.lo == value && range.lo < range.hi {
            range.lo += 1;
        } else if range.hi == value && range.lo < range.hi {
            range.hi -= 1;
        }
        range.trimmed()
    }

    /// Returns the interval of the results of an operation that is monotonic in each operand, computed from the bounds
    /// of both intervals; `None` on overflow.
    pub(super) fn combine_bounds(
        self,
        other: Interval,
        op: impl Fn(i128, i128) -> i128,
    ) -> Option<Interval> {
        let all = [self.lo, self.hi].into_iter().flat_map(|a| {
            let op = &op;
            [other.lo, other.hi].map(move |b| op(a.into(), b.into()))
        });
        let (mut lo, mut hi) = (i128::MAX, i128::MIN);
        for value in all {
            (lo, hi) = (lo.min(value), hi.max(value));
        }
        Some(Interval::new(
            i64::try_from(lo).ok()?,
            i64::try_from(hi).ok()?,
        ))
    }

    /// Returns the interval of the quotients; the divisor 0 is ignored. `None` on overflow.
    pub(super) fn div(self, by: Interval) -> Option<Interval> {
        let mut parts = [(by.lo, by.hi.min(-1)), (by.lo.max(1), by.hi)]
            .into_iter()
            .filter(|(lo, hi)| lo <= hi)
            .map(|(lo, hi)| self.combine_bounds(Interval::new(lo, hi), |a, b| a / b));
        let first = parts.next().unwrap_or(Some(Interval::FALSE))?;
        parts.try_fold(first, |all, part| Some(all.join(part?)))
    }

    /// Returns the interval of the remainders; the divisor 0 is ignored. Remainders have the sign of the dividend.
    /// Their absolute value is less than that of the divisor and at most that of the dividend.
    pub(super) fn modulo(self, by: Interval) -> Interval {
        let size = by.lo.unsigned_abs().max(by.hi.unsigned_abs());
        let size = i64::try_from(size.saturating_sub(1)).unwrap_or(i64::MAX);
        Interval::new(
            if self.lo < 0 { self.lo.max(-size) } else { 0 },
            if self.hi > 0 { self.hi.min(size) } else { 0 },
        )
    }

    /// Returns the interval of the powers; `None` on overflow, or if an exponent may be negative.
    pub(super) fn power(self, by: Interval) -> Option<Interval> {
        if by.lo < 0 {
            return None;
        }
        let exponent = u32::try_from(by.hi).ok()?;
        let most = self.lo.unsigned_abs().max(self.hi.unsigned_abs()).max(1);
        let most = i64::try_from(most).ok()?.checked_pow(exponent)?;
        Some(Interval::new(if self.lo < 0 { -most } else { 0 }, most))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_stay_within_the_ranges() {
        let some = [-7_i64, -3, -1, 0, 1, 2, 5, 9];
        for (a, b) in pairs(&some) {
            for (c, d) in pairs(&some) {
                let (left, right) = (Interval::new(a, b), Interval::new(c, d).without(0));
                for x in a..=b {
                    for y in (c..=d).filter(|y| *y != 0) {
                        holds(left.div(right), x / y);
                        holds(Some(left.modulo(right)), x % y);
                        holds(left.combine_bounds(right, |a, b| a * b), x * y);
                        if right.lo >= 0 && y < 5 {
                            let power = left.power(Interval::new(right.lo, right.hi.min(4)));
                            holds(power, x.pow(u32::try_from(y).unwrap_or(0)));
                        }
                    }
                }
            }
        }
    }

    fn pairs(all: &[i64]) -> Vec<(i64, i64)> {
        let pairs = all.iter().flat_map(|a| all.iter().map(|b| (*a, *b)));
        pairs.filter(|(a, b)| a <= b).collect()
    }

    fn holds(range: Option<Interval>, value: i64) {
        assert!(
            range.is_none_or(|range| range.lo <= value && value <= range.hi),
            "{range:?} {value}"
        );
    }

    #[test]
    fn what_does_not_fit_has_no_range() {
        assert_eq!(
            Interval::ALL.combine_bounds(Interval::TRUE, |a, b| a + b),
            None
        );
        assert_eq!(Interval::ALL.div(Interval::new(-1, 1).without(0)), None);
        assert!(Interval::new(0, 10).div(Interval::new(2, 5)) == Some(Interval::new(0, 5)));
    }
}
