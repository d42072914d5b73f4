//! Six-axis arms with an ortho-parallel basis and a spherical wrist (OPW), such as the KR series of KUKA.
//!
//! Axis 1 is vertical, axes 2 and 3 are perpendicular to it, and the three axes of the wrist meet in one point. Source
//! of the parameters: Brandstötter, Angerer, Hofbaur, An analytical solution of the inverse kinematics problem of
//! industrial serial manipulators with an ortho-parallel basis and a spherical wrist, Austrian Robotics Workshop 2014.

use crate::Link;
use crate::angle::{HALF_TURN, SinCos};
use crate::chain::LinkTwist;
use crate::six_axis::{Joints, MISSING, Solutions, elbow_bends};
use crate::spherical_joint::{self, SphericalJoint};
use crate::{InverseKinematicsError, Transform};
use core::f64::consts::FRAC_PI_2;
use nalgebra::Vector3;

/// Lengths in m, and sense and offset of the axes as defined by the vendor: angle = `sense * joint value + offset`.
/// With all these angles at zero, the arm is upright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Distance of axis 2 in front of axis 1, in m.
    pub a1: f64,
    /// Distance of the axis of the forearm in front of axis 3, in m; negative if behind it.
    pub a2: f64,
    /// Lateral offset of the plane of the arm to the left of axis 1, m.
    pub b: f64,
    /// Height of axis 2 above the base, in m.
    pub c1: f64,
    /// Length of the upper arm, m.
    pub c2: f64,
    /// Length of the forearm, along its axis, m.
    pub c3: f64,
    /// Distance from the wrist centre to the flange, m.
    pub c4: f64,
    /// For each axis, +1, or -1 if the vendor counts its angle in the opposite direction.
    pub sense: Joints,
    /// For each axis, its angle at joint value 0, counted from the upright position of the arm, in rad.
    pub offset: Joints,
}

impl Geometry {
    /// Returns the rows of the standard Denavit-Hartenberg table of the arm. Rows rotate about z, so the rows of axes 2
    /// and 3 have offsets of a quarter turn.
    #[must_use]
    pub const fn links(&self) -> [Link; 6] {
        let [s, o] = [self.sense, self.offset];
        [
            Link::new(self.a1, LinkTwist::MINUS_90, self.c1).with_sense(s[0], o[0]),
            Link::new(self.c2, LinkTwist::NONE, self.b).with_sense(s[1], o[1] - FRAC_PI_2),
            Link::new(self.a2, LinkTwist::PLUS_90, 0.0).with_sense(s[2], o[2] + FRAC_PI_2),
            Link::new(0.0, LinkTwist::MINUS_90, self.c3).with_sense(s[3], o[3]),
            Link::new(0.0, LinkTwist::PLUS_90, 0.0).with_sense(s[4], o[4]),
            Link::new(0.0, LinkTwist::NONE, self.c4).with_sense(s[5], o[5]),
        ]
    }

    /// Returns all solutions for a pose of the flange in the base frame: joint values in rad, or NaN for each of the
    /// eight that does not exist. Angles that the pose does not determine are taken from `hint` (rad). Ranges are
    /// ignored.
    ///
    /// # Errors
    /// [`InverseKinematicsError::NotFinite`] if the pose is not finite.
    pub fn solutions(
        &self,
        flange: &Transform,
        hint: &Joints,
    ) -> Result<Solutions, InverseKinematicsError> {
        let rotation = flange.rotation.matrix();
        if !(flange.translation.vector.iter().chain(rotation.iter())).all(|entry| entry.is_finite())
        {
            return Err(InverseKinematicsError::NotFinite);
        }
        let wrist: Vector3<f64> = flange.translation.vector - rotation.column(2) * self.c4;
        let open = self.sense[3] * hint[3] + self.offset[3];
        let mut solutions = [MISSING; 8];
        for (pair, [p1, p2, p3]) in self.arm_angles(&wrist).into_iter().enumerate() {
            let forearm = SphericalJoint::new(p1, p2 + p3);
            let seen = |column: usize| forearm.inverse_rotate(&rotation.column(column).into());
            let [p4, p5, p6] = spherical_joint::zyz_angles(&seen(0), &seen(2), open);
            solutions[2 * pair] = self.joints([p1, p2, p3, p4, p5, p6]);
            solutions[2 * pair + 1] =
                self.joints([p1, p2, p3, p4 + HALF_TURN, -p5, p6 + HALF_TURN]);
        }
        Ok(solutions)
    }

    /// Returns the angles of axes 1 to 3 (rad, zero in the upright position) for a position of the wrist centre in the
    /// base frame (m), for all combinations of front or overhead and elbow up or down; NaN if there are none.
    fn arm_angles(&self, wrist: &Vector3<f64>) -> [[f64; 3]; 4] {
        // If the wrist is too near to axis 1, the root is NaN, and so are all solutions: they do not exist.
        let level = libm::sqrt(wrist.x * wrist.x + wrist.y * wrist.y - self.b * self.b);
        let towards = libm::atan2(wrist.y, wrist.x);
        let aside = libm::atan2(self.b, level);
        // The offset `a2` makes the forearm oblique: the triangle uses its true length, and `back` is the angle between
        // the two.
        let fore = libm::sqrt(self.a2 * self.a2 + self.c3 * self.c3);
        let back = libm::atan2(self.a2, self.c3);
        let up = wrist.z - self.c1;
        let sides = [
            (towards - aside, level - self.a1),
            (towards + aside + HALF_TURN, -level - self.a1),
        ];
        let arm = |(p1, out): (f64, f64), elbow: usize| {
            let bend = elbow_bends(self.c2, fore, out * out + up * up)[elbow];
            let SinCos { sin, cos } = SinCos::from_angle(bend);
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
