//! Random values of all types: typical, extreme, and reals of all sizes.

use rpi_image::{Scalar, Type};

/// Deterministic pseudo-random number generator (SplitMix64).
pub(crate) struct Random(pub(crate) u64);

const EXTREME_REALS: [f64; 12] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -0.0,
    f64::MAX,
    f64::MIN_POSITIVE,
    5e-324,
    -1.0,
    1.0,
    0.5,
    9_007_199_254_740_993.0,
];
const EXTREME_INTS: [i64; 8] = [i64::MIN, i64::MAX, -1, 0, 1, 2, 63, 64];

impl Random {
    pub(crate) fn roll(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a value for a cycle: extreme in some cycles, of any size in others, else typical.
    pub(crate) fn cycle_value(&mut self, cycle: u64, ty: Type) -> Vec<u64> {
        let element = match ty {
            Type::Scalar(s) | Type::Array(s, _) => s,
            Type::Matrix(..) => Scalar::Real,
        };
        let count = ty.slots() / element.slots();
        (0..count)
            .flat_map(|_| self.element(cycle, element))
            .collect()
    }

    fn element(&mut self, cycle: u64, scalar: Scalar) -> Vec<u64> {
        match (scalar, cycle % 5) {
            (Scalar::Bool, _) => vec![self.roll() & 1],
            (Scalar::Int | Scalar::Time, kind) => vec![self.integer(kind)],
            (Scalar::Rotation, 0..=2) => self.rotation(),
            (Scalar::Pose, 0..=2) => {
                let position = [self.near(), self.near(), self.near()].map(f64::to_bits);
                [&position[..], &self.rotation()].concat()
            }
            (scalar, kind) => (0..scalar.slots()).map(|_| self.real(kind)).collect(),
        }
    }

    fn integer(&mut self, kind: u64) -> u64 {
        let roll = self.roll();
        match kind {
            3 => EXTREME_INTS[roll as usize % EXTREME_INTS.len()].cast_unsigned(),
            4 => roll
                .cast_signed()
                .wrapping_shr((roll % 64) as u32)
                .cast_unsigned(),
            _ => (roll % 21).wrapping_sub(10),
        }
    }

    fn real(&mut self, kind: u64) -> u64 {
        let roll = self.roll();
        let value = match kind {
            3 => EXTREME_REALS[roll as usize % EXTREME_REALS.len()],
            // Any bits: mostly reals of extreme size.
            4 => f64::from_bits(roll),
            2 => self.near() * 1000.0,
            _ => self.near(),
        };
        value.to_bits()
    }

    /// Returns a real between -2 and 2.
    fn near(&mut self) -> f64 {
        (self.roll() >> 11) as f64 / (1_u64 << 53) as f64 * 4.0 - 2.0
    }

    fn rotation(&mut self) -> Vec<u64> {
        let r = rpi_prims::geometry::from_abc(self.near(), self.near(), self.near());
        [r.i, r.j, r.k, r.w].map(f64::to_bits).to_vec()
    }
}
