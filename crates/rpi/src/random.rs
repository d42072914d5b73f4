//! Reproducible random inputs of a node: a seed gives the same values on every machine.

use rpi_image::{Scalar, Type, Value};
use rpi_net::Column;

/// Generator of random inputs of a node: a Xorshift pseudo-random number generator (Marsaglia, Xorshift RNGs, 2003).
/// Its state is never 0.
pub(crate) struct InputGenerator(u64);

impl InputGenerator {
    pub(crate) fn new(seed: u64) -> InputGenerator {
        // Xorshift needs a state other than 0.
        InputGenerator(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        // The low bits of xorshift are its weakest.
        self.0 >> 11
    }

    /// Returns true with probability 3/4: the input then has the same value as in the previous cycle.
    pub(crate) fn keeps_previous(&mut self) -> bool {
        !self.next().is_multiple_of(4)
    }

    /// Returns a random value of an input as memory slots. An optional input is absent (`None`) with probability 1/4.
    pub(crate) fn value(&mut self, column: &Column) -> Option<Vec<u64>> {
        match column.optional && self.next().is_multiple_of(4) {
            true => None,
            false => Some(self.slots(column)),
        }
    }

    /// Returns a random integer of the subrange from `least` to `most`: near 0, or near an end of the subrange.
    fn integer_in(&mut self, [least, most]: [i64; 2]) -> i64 {
        let step = i64::try_from(self.next() % 5).unwrap_or(0);
        let (begin, step) = match self.next() % 3 {
            0 if least > i64::MIN => (least, step),
            1 if most < i64::MAX => (most, -step),
            _ => (0, step),
        };
        begin.saturating_add(step).clamp(least, most)
    }

    /// Returns a random value of an input as memory slots: an integer from 0 to 4 or near an end of its subrange, an
    /// enum value, or a real from -5 to 5. Inputs of other types have their neutral value.
    fn slots(&mut self, column: &Column) -> Vec<u64> {
        match column.scalar {
            Scalar::Bool => vec![self.next() % 2],
            Scalar::Int => match (column.range, column.enum_values.len() as u64) {
                (Some(range), _) => vec![self.integer_in(range).cast_unsigned()],
                (None, 0) => vec![self.next() % 5],
                (None, values) => vec![self.next() % values],
            },
            Scalar::Real => vec![((self.next() % 1000) as f64 / 100.0 - 5.0).to_bits()],
            other => Value::neutral(Type::Scalar(other)).slots().to_vec(),
        }
    }
}
