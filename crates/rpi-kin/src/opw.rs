//! Six-axis arms with a spherical wrist: KUKA's KR series and most of their kind.
//!
//! Axis 1 is upright, axes 2 and 3 lie across it, the wrist's three axes meet in a point. Source of the parameters:
//! Brandstoetter, Angerer, Hofbaur, An analytical solution of the inverse kinematics problem of industrial serial
//! manipulators with an ortho-parallel basis and a spherical wrist, Austrian Robotics Workshop 2014.

use crate::angle::{HALF_TURN, SinCos};
use crate::ball::{self, Ball};
use crate::six::{Joints, NONE, Solutions, bends};
use crate::{NoSolution, Transform};
use nalgebra::Vector3;

/// Lengths in m, and how the vendor counts the axes: canonical angle = `sense * joint + offset`. With all canonical angles
/// zero the arm stands upright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Axis 2 in front of axis 1.
    pub a1: f64,
    /// The forearm's axis in front of axis 3; negative if behind it.
    pub a2: f64,
    /// The arm's plane to the left of axis 1.
    pub b: f64,
    /// Axis 2 above the base.
    pub c1: f64,
    /// The upper arm.
    pub c2: f64,
    /// The forearm, along its axis.
    pub c3: f64,
    /// The wrist's centre to the flange.
    pub c4: f64,
    /// +1 or -1 for each axis.
    pub sense: Joints,
    /// Canonical angle at joint value zero, in rad.
    pub offset: Joints,
}

impl Geometry {
    /// All sets of joints that put the flange at `flange` (in the base), within half a turn of zero before offsets. Turns
    /// that the pose leaves open are those of `hint` (rad).
    ///
    /// # Errors
    /// [`NoSolution::NotFinite`] if the pose is.
    pub fn solutions(&self, flange: &Transform, hint: &Joints) -> Result<Solutions, NoSolution> {
        let rotation = flange.rotation.matrix();
        if !(flange.translation.vector.iter().chain(rotation.iter())).all(|entry| entry.is_finite())
        {
            return Err(NoSolution::NotFinite);
        }
        let wrist: Vector3<f64> = flange.translation.vector - rotation.column(2) * self.c4;
        let open = self.sense[3] * hint[3] + self.offset[3];
        let mut solutions = [NONE; 8];
        for (pair, [p1, p2, p3]) in self.arms(&wrist).into_iter().enumerate() {
            let forearm = Ball::of(p1, p2 + p3);
            let seen = |column: usize| forearm.undo(&rotation.column(column).into());
            let [p4, p5, p6] = ball::angles(&seen(0), &seen(2), open);
            solutions[2 * pair] = self.joints([p1, p2, p3, p4, p5, p6]);
            solutions[2 * pair + 1] =
                self.joints([p1, p2, p3, p4 + HALF_TURN, -p5, p6 + HALF_TURN]);
        }
        Ok(solutions)
    }

    /// The first three canonical angles for the wrist's centre: to the front or over the head, elbow one way or the other.
    fn arms(&self, wrist: &Vector3<f64>) -> [[f64; 3]; 4] {
        let level = libm::sqrt(wrist.x * wrist.x + wrist.y * wrist.y - self.b * self.b);
        let towards = libm::atan2(wrist.y, wrist.x);
        let aside = libm::atan2(self.b, level);
        let fore = libm::sqrt(self.a2 * self.a2 + self.c3 * self.c3);
        let back = libm::atan2(self.a2, self.c3);
        let up = wrist.z - self.c1;
        let sides = [
            (towards - aside, level - self.a1),
            (towards + aside + HALF_TURN, -level - self.a1),
        ];
        let arm = |(p1, out): (f64, f64), elbow: usize| {
            let bend = bends(self.c2, fore, out * out + up * up)[elbow];
            let SinCos { sin, cos } = SinCos::of(bend);
            let p2 = libm::atan2(out, up) - libm::atan2(fore * sin, self.c2 + fore * cos);
            [p1, p2, bend - back]
        };
        [
            arm(sides[0], 0),
            arm(sides[0], 1),
            arm(sides[1], 0),
            arm(sides[1], 1),
        ]
    }

    fn joints(&self, canonical: Joints) -> Joints {
        core::array::from_fn(|axis| self.sense[axis] * (canonical[axis] - self.offset[axis]))
    }
}
