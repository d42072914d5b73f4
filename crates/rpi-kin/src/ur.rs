//! Six-axis arms with parallel axes 2, 3 and 4, such as those of Universal Robots.
//!
//! Source of the method: Hawkins, Analytic inverse kinematics for the Universal Robots UR-5/UR-10 arms, Georgia Tech
//! 2013. The angles follow from the orientation, which is `Rz Ry Rz` once axis 1 is known.

use crate::angle::{HALF_TURN, SinCos};
use crate::six_axis::{
    Joints, MISSING, NearestSearch, Solutions, elbow_bends, finite_rotation, nearest_first,
    reason_for_none,
};
use crate::spherical_joint;
use crate::{InverseKinematicsError, Range, Transform};
use nalgebra::Vector3;

/// Lengths of an arm as in its standard Denavit-Hartenberg table, in m. `a2` and `a3` are negative by the convention of
/// the vendor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Distance from the base to axis 2 (shoulder) along axis 1, in m.
    pub d1: f64,
    /// Length of the upper arm, m; negative by the convention of the vendor.
    pub a2: f64,
    /// Length of the forearm, m; negative by the convention of the vendor.
    pub a3: f64,
    /// Offset along axis 4, in m.
    pub d4: f64,
    /// Offset along axis 5, in m.
    pub d5: f64,
    /// Offset along axis 6 to the flange, in m.
    pub d6: f64,
}

/// Amount by which rounding may raise a sine or cosine above 1 (no unit). Up to this amount, the pose counts as reached
/// with the arm outstretched.
const REACH_TOLERANCE: f64 = 1e-9;

impl Geometry {
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
        let sides = self.first_axis(&target.before_last);
        let bounds = sides.map(|q1| search.lower_bound(0.0, 0, q1));
        for side in nearest_first(&bounds) {
            if search.may_be_nearest(bounds[side]) {
                self.search_side(&target, side, sides[side], &mut search);
            }
        }
        let reason = || reason_for_none(&self.every_solution(&target));
        search.nearest().ok_or_else(reason)
    }

    /// Offers those solutions with the angle `q1` (rad) of axis 1 that may be the nearest ones.
    fn search_side(&self, target: &Target, side: usize, q1: f64, search: &mut NearestSearch<'_>) {
        let wrist = to_shoulder_frame(&target.from_shoulder, q1);
        let hands = target.hands(q1);
        let bounds = hands.map(|[_, q5, q6]| {
            let bound = search.lower_bound(0.0, 4, q5);
            search.lower_bound(bound, 5, q6)
        });
        for hand in nearest_first(&bounds) {
            if !search.may_be_nearest(bounds[hand]) {
                break;
            }
            let [sum, q5, q6] = hands[hand];
            let elbows = self.shoulder_and_elbow(&wrist, sum);
            for (elbow, [q2, q3]) in elbows.into_iter().enumerate() {
                let joints = [q1, q2, q3, sum - q2 - q3, q5, q6];
                search.offer(4 * side + 2 * hand + elbow, &joints);
            }
        }
    }

    fn every_solution(&self, target: &Target) -> Solutions {
        let mut solutions = [MISSING; 8];
        for (side, q1) in self.first_axis(&target.before_last).into_iter().enumerate() {
            let wrist = to_shoulder_frame(&target.from_shoulder, q1);
            for (hand, [sum, q5, q6]) in target.hands(q1).into_iter().enumerate() {
                let elbows = self.shoulder_and_elbow(&wrist, sum);
                for (elbow, [q2, q3]) in elbows.into_iter().enumerate() {
                    solutions[4 * side + 2 * hand + elbow] = [q1, q2, q3, sum - q2 - q3, q5, q6];
                }
            }
        }
        solutions
    }

    fn target(&self, flange: &Transform, hint: &Joints) -> Result<Target, InverseKinematicsError> {
        let rotation = finite_rotation(flange)?;
        let z: Vector3<f64> = rotation.column(2).into();
        let before_last = flange.translation.vector - z * self.d6;
        Ok(Target {
            x: rotation.column(0).into(),
            z,
            before_last,
            from_shoulder: before_last - Vector3::z() * self.d1,
            open: hint[1] + hint[2] + hint[3],
        })
    }

    /// Returns the two angles of axis 1 (rad) at which the origin of frame 5, `before_last` (m, in the base frame), has
    /// the distance `d4` from the plane of the arm; NaN if there are none.
    fn first_axis(&self, before_last: &Vector3<f64>) -> [f64; 2] {
        let level = libm::sqrt(before_last.x * before_last.x + before_last.y * before_last.y);
        let sin = self.d4 / level;
        // A comparison with NaN is false, so the limit alone would accept it.
        if sin.is_nan() || sin.abs() > 1.0 + REACH_TOLERANCE {
            return [f64::NAN; 2];
        }
        let towards = rpi_math::atan2(before_last.y, before_last.x);
        let aside = rpi_math::asin(sin.clamp(-1.0, 1.0));
        [towards + aside, towards + HALF_TURN - aside]
    }

    /// Returns the angles of axes 2 and 3 (rad) for both configurations of the elbow; NaN if there are none. `wrist` is
    /// the position of the origin of frame 5 in the frame of axis 2 (m), `sum` the sum of the angles of axes 2 to 4
    /// (rad).
    fn shoulder_and_elbow(&self, wrist: &Vector3<f64>, sum: f64) -> [[f64; 2]; 2] {
        let SinCos { sin, cos } = SinCos::from_angle(sum);
        let (x, y) = (wrist.x - self.d5 * sin, wrist.y + self.d5 * cos);
        let towards = rpi_math::atan2(y, x);
        let [bend, _] = elbow_bends(self.a2, self.a3, x * x + y * y);
        let SinCos { sin, cos } = SinCos::from_angle(bend);
        let from_line = rpi_math::atan2(self.a3 * sin, self.a2 + self.a3 * cos);
        [[towards - from_line, bend], [towards + from_line, -bend]]
    }
}

/// What a solution must reach, in the base frame.
struct Target {
    /// Direction of the x-axis of the flange.
    x: Vector3<f64>,
    /// Direction of the z-axis of the flange.
    z: Vector3<f64>,
    /// Position of the origin of frame 5, m.
    before_last: Vector3<f64>,
    /// Position of the origin of frame 5 from the origin of the frame of axis 2, m.
    from_shoulder: Vector3<f64>,
    /// Sum of the angles of axes 2 to 4 (rad) where the pose does not determine it.
    open: f64,
}

impl Target {
    /// Returns, for both signs of axis 5, the sum of the angles of axes 2 to 4 and the angles of axes 5 and 6 (rad), for
    /// the angle `q1` of axis 1 (rad).
    fn hands(&self, q1: f64) -> [[f64; 3]; 2] {
        let (x, z) = (
            to_shoulder_frame(&self.x, q1),
            to_shoulder_frame(&self.z, q1),
        );
        let [turn, bend, roll] = spherical_joint::zyz_angles(&x, &z, self.open);
        [
            [turn, -bend, roll],
            [turn + HALF_TURN, bend, roll + HALF_TURN],
        ]
    }
}

/// Returns the vector `v` in the frame of axis 2 for the angle `q1` of axis 1 (rad): `(Rz(q1) Rx(90°))^-1 v`.
fn to_shoulder_frame(v: &Vector3<f64>, q1: f64) -> Vector3<f64> {
    let SinCos { sin, cos } = SinCos::from_angle(q1);
    Vector3::new(cos * v.x + sin * v.y, v.z, sin * v.x - cos * v.y)
}
