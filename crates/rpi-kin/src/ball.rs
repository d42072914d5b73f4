//! Three axes through one point: z, then y, then z again, as in a shoulder or a wrist.

use crate::angle::SinCos;
use nalgebra::Vector3;

/// Below this sine of its bend a joint counts as straight: only the sum of the turns on both sides of it is defined. Small
/// enough to move the flange by no more than 1e-10 m and rad, large enough for the turns to stand out from rounding.
pub(crate) const STRAIGHT: f64 = 1e-10;

/// A turn about z and a bend about the new y, not negative, with their sines and cosines.
pub(crate) struct Ball {
    pub(crate) turn: f64,
    pub(crate) turned: SinCos,
    pub(crate) bend: f64,
    pub(crate) bent: SinCos,
}

impl Ball {
    /// Of known angles.
    pub(crate) fn of(turn: f64, bend: f64) -> Self {
        Self {
            turn,
            turned: SinCos::of(turn),
            bend,
            bent: SinCos::of(bend),
        }
    }

    /// What points z along the unit vector `to`; the turn is `open` if z points there already.
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

    /// The vector `v` as seen after turn and bend.
    pub(crate) fn undo(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let level = self.turned.cos * v.x + self.turned.sin * v.y;
        Vector3::new(
            self.bent.cos * level - self.bent.sin * v.z,
            self.turned.cos * v.y - self.turned.sin * v.x,
            self.bent.sin * level + self.bent.cos * v.z,
        )
    }
}

/// The angles of the rotation `Rz(turn) Ry(bend) Rz(roll)` with these columns x and z; the bend is not negative. The other
/// solution is half a turn more, minus the bend, half a turn more.
pub(crate) fn angles(x: &Vector3<f64>, z: &Vector3<f64>, open: f64) -> [f64; 3] {
    let ball = Ball::towards(z, open);
    let rest = ball.undo(x);
    [ball.turn, ball.bend, libm::atan2(rest.y, rest.x)]
}
