//! Spherical joint: three axes through one point (z, y, z), as in a shoulder or a wrist.

use crate::angle::SinCos;
use nalgebra::Vector3;

/// If the sine of its bend is below this value, a joint counts as straight: only the sum of the rotations before and
/// after it is defined. The value is small enough to move the flange by at most 1e-10 m and rad, and large enough to
/// distinguish the angles from rounding errors.
pub(crate) const STRAIGHT: f64 = 1e-10;

/// Rotation about z (turn), then about the new y (bend, not negative), with sines and cosines.
pub(crate) struct Ball {
    pub(crate) turn: f64,
    pub(crate) turned: SinCos,
    pub(crate) bend: f64,
    pub(crate) bent: SinCos,
}

impl Ball {
    /// Creates the rotation from its angles, in rad.
    pub(crate) fn of(turn: f64, bend: f64) -> Self {
        Self {
            turn,
            turned: SinCos::of(turn),
            bend,
            bent: SinCos::of(bend),
        }
    }

    /// Returns the rotation that maps z to the unit vector `to`. If `to` is z (within rounding), the turn is arbitrary
    /// and set to `open`.
    pub(crate) fn towards(to: &Vector3<f64>, open: f64) -> Self {
        let sin = libm::sqrt(to.x * to.x + to.y * to.y);
        let (turn, turned) = if sin > STRAIGHT {
            (
                libm::atan2(to.y, to.x),
                SinCos {
                    sin: to.y / sin,
                    cos: to.x / sin,
                },
            )
        } else {
            (open, SinCos::of(open))
        };
        Self {
            turn,
            turned,
            bend: libm::atan2(sin, to.z),
            bent: SinCos { sin, cos: to.z },
        }
    }

    /// Returns the vector `v` in the rotated frame.
    pub(crate) fn undo(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let level = self.turned.cos * v.x + self.turned.sin * v.y;
        Vector3::new(
            self.bent.cos * level - self.bent.sin * v.z,
            self.turned.cos * v.y - self.turned.sin * v.x,
            self.bent.sin * level + self.bent.cos * v.z,
        )
    }
}

/// Returns the angles of the rotation `Rz(turn) Ry(bend) Rz(roll)` with the columns `x` and `z`; the bend is not
/// negative. The other solution is (turn + π, -bend, roll + π). An arbitrary turn is set to `open`.
pub(crate) fn angles(x: &Vector3<f64>, z: &Vector3<f64>, open: f64) -> [f64; 3] {
    let ball = Ball::towards(z, open);
    let rest = ball.undo(x);
    [ball.turn, ball.bend, libm::atan2(rest.y, rest.x)]
}
