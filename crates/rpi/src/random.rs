//! Made-up inputs for a node: the same seed gives the same values on every machine.

use rpi_image::{Scalar, Type, Value};
use rpi_net::Column;

/// A stream of made-up values (Marsaglia, Xorshift RNGs, 2003).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Random {
        // Any state but 0 will do.
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 >> 11
    }

    /// Whether a value stays: three times of four.
    pub(crate) fn keeps(&mut self) -> bool {
        !self.next().is_multiple_of(4)
    }

    /// The cells of one value; of four that may be absent, one is.
    pub(crate) fn given(&mut self, column: &Column) -> Option<Vec<u64>> {
        match column.optional && self.next().is_multiple_of(4) {
            true => None,
            false => Some(self.cells(column)),
        }
    }

    /// A value of a subrange, small or near one of its ends.
    fn within(&mut self, [least, most]: [i64; 2]) -> i64 {
        let step = i64::try_from(self.next() % 5).unwrap_or(0);
        let (begin, step) = match self.next() % 3 {
            0 if least > i64::MIN => (least, step),
            1 if most < i64::MAX => (most, -step),
            _ => (0, step),
        };
        begin.saturating_add(step).clamp(least, most)
    }

    /// The cells of one value: small integers or those at an end of the subrange, values of the enum, reals between -5 and 5.
    fn cells(&mut self, column: &Column) -> Vec<u64> {
        match column.ty {
            Scalar::Bool => vec![self.next() % 2],
            Scalar::Int => match (column.range, column.values.len() as u64) {
                (Some(range), _) => vec![self.within(range).cast_unsigned()],
                (None, 0) => vec![self.next() % 5],
                (None, values) => vec![self.next() % values],
            },
            Scalar::Real => vec![((self.next() % 1000) as f64 / 100.0 - 5.0).to_bits()],
            other => Value::neutral(Type::One(other)).cells().to_vec(),
        }
    }
}
