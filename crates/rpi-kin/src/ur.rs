//! Six-axis arms with parallel axes 2, 3 and 4, such as those of Universal Robots.
//!
//! Source of the method: Hawkins, Analytic inverse kinematics for the Universal Robots UR-5/UR-10 arms, Georgia Tech
//! 2013. The angles follow from the orientation, which is `Rz Ry Rz` once axis 1 is known.

use crate::angle::{HALF_TURN, SinCos};
use crate::six_axis::{Joints, MISSING, Solutions, elbow_bends};
use crate::spherical_joint;
use crate::{InverseKinematicsError, Transform};
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
        let rotation = flange.rotation.matrix();
        if !(flange.translation.vector.iter().chain(rotation.iter())).all(|entry| entry.is_finite())
        {
            return Err(InverseKinematicsError::NotFinite);
        }
        let along: Vector3<f64> = rotation.column(2).into();
        let before_last = flange.translation.vector - along * self.d6;
        let open = hint[1] + hint[2] + hint[3];
        let mut solutions = [MISSING; 8];
        for (side, q1) in self.first_axis(&before_last).into_iter().enumerate() {
            let seen = |column: usize| to_shoulder_frame(&rotation.column(column).into(), q1);
            let [turn, bend, roll] = spherical_joint::zyz_angles(&seen(0), &seen(2), open);
            let wrist = to_shoulder_frame(&(before_last - Vector3::z() * self.d1), q1);
            let hands = [
                (turn, -bend, roll),
                (turn + HALF_TURN, bend, roll + HALF_TURN),
            ];
            for (hand, (sum, q5, q6)) in hands.into_iter().enumerate() {
                for (elbow, [q2, q3]) in
                    self.shoulder_and_elbow(&wrist, sum).into_iter().enumerate()
                {
                    solutions[4 * side + 2 * hand + elbow] = [q1, q2, q3, sum - q2 - q3, q5, q6];
                }
            }
        }
        Ok(solutions)
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
        let towards = libm::atan2(before_last.y, before_last.x);
        let aside = libm::asin(sin.clamp(-1.0, 1.0));
        [towards + aside, towards + HALF_TURN - aside]
    }

    /// Returns the angles of axes 2 and 3 (rad) for both configurations of the elbow; NaN if there are none. `wrist` is
    /// the position of the origin of frame 5 in the frame of axis 2 (m), `sum` the sum of the angles of axes 2 to 4
    /// (rad).
    fn shoulder_and_elbow(&self, wrist: &Vector3<f64>, sum: f64) -> [[f64; 2]; 2] {
        let SinCos { sin, cos } = SinCos::from_angle(sum);
        let (x, y) = (wrist.x - self.d5 * sin, wrist.y + self.d5 * cos);
        let towards = libm::atan2(y, x);
        elbow_bends(self.a2, self.a3, x * x + y * y).map(|bend| {
            let SinCos { sin, cos } = SinCos::from_angle(bend);
            [
                towards - libm::atan2(self.a3 * sin, self.a2 + self.a3 * cos),
                bend,
            ]
        })
    }
}

/// Returns the vector `v` in the frame of axis 2 for the angle `q1` of axis 1 (rad): `(Rz(q1) Rx(90°))^-1 v`.
fn to_shoulder_frame(v: &Vector3<f64>, q1: f64) -> Vector3<f64> {
    let SinCos { sin, cos } = SinCos::from_angle(q1);
    Vector3::new(cos * v.x + sin * v.y, v.z, sin * v.x - cos * v.y)
}
