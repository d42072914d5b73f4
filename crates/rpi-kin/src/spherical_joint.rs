//! Spherical joint: three axes through one point (z, y, z), as in a shoulder or a wrist.

use crate::angle::SinCos;
use nalgebra::Vector3;

/// Sine of the bend (middle angle) below which a spherical joint counts as straight: then only the sum of its first and
/// last rotations is defined. The value is small enough to move the flange by at most 1e-10 m and rad, and large enough
/// to distinguish the angles from rounding errors.
pub(crate) const STRAIGHT_TOLERANCE: f64 = 1e-10;

/// Rotation of the first two axes of a spherical joint: about z (turn), then about the new y (bend), as angles in rad
/// and as sines and cosines.
pub(crate) struct SphericalJoint {
    pub(crate) turn: f64,
    pub(crate) turn_sin_cos: SinCos,
    pub(crate) bend: f64,
    pub(crate) bend_sin_cos: SinCos,
}

impl SphericalJoint {
    /// Creates the rotation from its angles `turn` about z and `bend` about y, in rad.
    pub(crate) fn new(turn: f64, bend: f64) -> Self {
        Self {
            turn,
            turn_sin_cos: SinCos::from_angle(turn),
            bend,
            bend_sin_cos: SinCos::from_angle(bend),
        }
    }

    /// Returns the rotation that maps z to the unit vector `to`. If `to` is z (within rounding), the turn is arbitrary
    /// and set to `open` (rad).
    pub(crate) fn pointing_at(to: &Vector3<f64>, open: f64) -> Self {
        let sin = libm::sqrt(to.x * to.x + to.y * to.y);
        let (turn, turned) = if sin > STRAIGHT_TOLERANCE {
            (
                rpi_math::atan2(to.y, to.x),
                SinCos {
                    sin: to.y / sin,
                    cos: to.x / sin,
                },
            )
        } else {
            (open, SinCos::from_angle(open))
        };
        Self {
            turn,
            turn_sin_cos: turned,
            // Not `acos(to.z)`: near 0 and half a turn, the arc cosine loses half of the digits.
            bend: rpi_math::atan2(sin, to.z),
            bend_sin_cos: SinCos { sin, cos: to.z },
        }
    }

    /// Returns the vector `v` in the coordinates of the rotated frame.
    pub(crate) fn inverse_rotate(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let level = self.turn_sin_cos.cos * v.x + self.turn_sin_cos.sin * v.y;
        Vector3::new(
            self.bend_sin_cos.cos * level - self.bend_sin_cos.sin * v.z,
            self.turn_sin_cos.cos * v.y - self.turn_sin_cos.sin * v.x,
            self.bend_sin_cos.sin * level + self.bend_sin_cos.cos * v.z,
        )
    }
}

/// Returns the angles [turn, bend, roll] in rad of the rotation `Rz(turn) Ry(bend) Rz(roll)` whose matrix has the
/// columns `x` and `z`; the bend is not negative. The other solution is [turn + π, -bend, roll + π]. A turn that is
/// arbitrary is set to `open` (rad).
pub(crate) fn zyz_angles(x: &Vector3<f64>, z: &Vector3<f64>, open: f64) -> [f64; 3] {
    let ball = SphericalJoint::pointing_at(z, open);
    let rest = ball.inverse_rotate(x);
    [ball.turn, ball.bend, rpi_math::atan2(rest.y, rest.x)]
}
