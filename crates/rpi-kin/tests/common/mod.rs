//! Reproducible pseudo-random joint values, and distances.
#![allow(dead_code, reason = "each test binary uses its part")]

use rpi_kin::{AxisLimits, Pose};

/// Pseudo-random number generator SplitMix64 (Steele, Lea, Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    /// Returns a uniform number in [0, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a uniform number between two bounds.
    pub(crate) fn between(&mut self, lower: f64, upper: f64) -> f64 {
        lower + (upper - lower) * self.unit()
    }

    /// Returns uniform joint values within the position limits.
    pub(crate) fn joints<const N: usize>(&mut self, limits: &[AxisLimits]) -> [f64; N] {
        std::array::from_fn(|axis| {
            self.between(limits[axis].position.lower, limits[axis].position.upper)
        })
    }
}

/// Returns the distance of two poses: the larger of the distance of the positions (m) and the angle between the
/// rotations (rad).
pub(crate) fn distance(one: &Pose, other: &Pose) -> f64 {
    let shift = (one.translation.vector - other.translation.vector).amax();
    // The angle is computed from the vector part: exact for small angles, in contrast to `acos` of the real part.
    let turn = one.rotation.inverse() * other.rotation;
    let angle = 2.0 * rpi_math::atan2(turn.imag().norm(), turn.w.abs());
    shift.max(angle)
}

/// Returns the largest difference of two sets of joint values.
pub(crate) fn largest(one: &[f64], other: &[f64]) -> f64 {
    let differences = one
        .iter()
        .zip(other)
        .map(|(one, other)| (one - other).abs());
    differences.fold(0.0, f64::max)
}
