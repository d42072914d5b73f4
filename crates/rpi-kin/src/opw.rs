//! Six-axis arms with an ortho-parallel basis and a spherical wrist (OPW), such as the KR series of KUKA.
//!
//! Axis 1 is vertical, axes 2 and 3 are perpendicular to it, and the three axes of the wrist meet in one point. Source
//! of the parameters: Brandstötter, Angerer, Hofbaur, An analytical solution of the inverse kinematics problem of
//! industrial serial manipulators with an ortho-parallel basis and a spherical wrist, Austrian Robotics Workshop 2014.

use crate::angle::{HALF_TURN, SinCos};
use crate::chain::LinkTwist;
use crate::six_axis::{
    Joints, MISSING, NearestSearch, Solutions, elbow_bends, finite_rotation, nearest_first,
    reason_for_none,
};
use crate::spherical_joint::{self, SphericalJoint};
use crate::{InverseKinematicsError, Link, Range, Transform};
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
        Ok(self.every_solution(&self.target(flange, hint)?))
    }

    /// Returns the solution for a pose of the flange in the base frame that is nearest to `hint` (rad) with all joints
    /// in `ranges` (rad): the same as the nearest of [`solutions`](Self::solutions). The distance is the largest
    /// difference of a joint.
    ///
    /// # Errors
    /// [`InverseKinematicsError::NotFinite`] if the pose or the hint is not finite,
    /// [`InverseKinematicsError::OutOfReach`] if there is no solution, [`InverseKinematicsError::OutOfLimits`] if no
    /// solution is in range.
    pub fn nearest_solution(
        &self,
        flange: &Transform,
        hint: &Joints,
        ranges: &[Range; 6],
    ) -> Result<Joints, InverseKinematicsError> {
        let target = self.target(flange, hint)?;
        let mut search = NearestSearch::new(hint, ranges)?;
        let arms = self.arm_angles(&target.wrist);
        let bounds = arms.map(|arm| {
            let joints = (0..3).map(|axis| (axis, self.joint(axis, arm[axis])));
            joints.fold(0.0, |bound, (axis, joint)| {
                search.lower_bound(bound, axis, joint)
            })
        });
        for pair in nearest_first(&bounds) {
            if !search.may_be_nearest(bounds[pair]) {
                break;
            }
            let [one, other] = self.both_wrists(&target, arms[pair]);
            search.offer(2 * pair, &one);
            search.offer(2 * pair + 1, &other);
        }
        let reason = || reason_for_none(&self.every_solution(&target));
        search.nearest().ok_or_else(reason)
    }

    fn every_solution(&self, target: &Target) -> Solutions {
        let mut solutions = [MISSING; 8];
        for (pair, arm) in self.arm_angles(&target.wrist).into_iter().enumerate() {
            let both = self.both_wrists(target, arm);
            solutions[2 * pair..][..2].copy_from_slice(&both);
        }
        solutions
    }

    fn target(&self, flange: &Transform, hint: &Joints) -> Result<Target, InverseKinematicsError> {
        let rotation = finite_rotation(flange)?;
        Ok(Target {
            x: rotation.column(0).into(),
            z: rotation.column(2).into(),
            wrist: flange.translation.vector - rotation.column(2) * self.c4,
            open: self.sense[3] * hint[3] + self.offset[3],
        })
    }

    /// Returns the joint values (rad) of the two solutions with these angles of axes 1 to 3 (rad).
    fn both_wrists(&self, target: &Target, [p1, p2, p3]: [f64; 3]) -> [Joints; 2] {
        let forearm = SphericalJoint::new(p1, p2 + p3);
        let (x, z) = (
            forearm.inverse_rotate(&target.x),
            forearm.inverse_rotate(&target.z),
        );
        let [p4, p5, p6] = spherical_joint::zyz_angles(&x, &z, target.open);
        let other = [p1, p2, p3, p4 + HALF_TURN, -p5, p6 + HALF_TURN];
        [[p1, p2, p3, p4, p5, p6], other].map(|angles| self.joints(angles))
    }

    /// Returns the angles of axes 1 to 3 (rad, zero in the upright position) for a position of the wrist centre in the
    /// base frame (m), for all combinations of front or overhead and elbow up or down; NaN if there are none.
    fn arm_angles(&self, wrist: &Vector3<f64>) -> [[f64; 3]; 4] {
        // If the wrist is too near to axis 1, the root is NaN, and so are all solutions: they do not exist.
        let level = libm::sqrt(wrist.x * wrist.x + wrist.y * wrist.y - self.b * self.b);
        let towards = rpi_math::atan2(wrist.y, wrist.x);
        let aside = rpi_math::atan2(self.b, level);
        // The offset `a2` makes the forearm oblique: the triangle uses its true length, and `back` is the angle between
        // the two.
        let fore = libm::sqrt(self.a2 * self.a2 + self.c3 * self.c3);
        let back = rpi_math::atan2(self.a2, self.c3);
        let up = wrist.z - self.c1;
        let both_elbows = |p1: f64, out: f64| {
            let [bend, _] = elbow_bends(self.c2, fore, out * out + up * up);
            let SinCos { sin, cos } = SinCos::from_angle(bend);
            let line = rpi_math::atan2(out, up);
            let from_line = rpi_math::atan2(fore * sin, self.c2 + fore * cos);
            [
                [p1, line - from_line, bend - back],
                [p1, line + from_line, -bend - back],
            ]
        };
        let [front_up, front_down] = both_elbows(towards - aside, level - self.a1);
        let [back_up, back_down] = both_elbows(towards + aside + HALF_TURN, -level - self.a1);
        [front_up, front_down, back_up, back_down]
    }

    fn joints(&self, canonical: Joints) -> Joints {
        core::array::from_fn(|axis| self.joint(axis, canonical[axis]))
    }

    fn joint(&self, axis: usize, canonical: f64) -> f64 {
        self.sense[axis] * (canonical - self.offset[axis])
    }
}

/// What a solution must reach, in the base frame.
struct Target {
    /// Direction of the x-axis of the flange.
    x: Vector3<f64>,
    /// Direction of the z-axis of the flange.
    z: Vector3<f64>,
    /// Position of the wrist centre, m.
    wrist: Vector3<f64>,
    /// Angle of axis 4 (rad) where the pose does not determine it.
    open: f64,
}
