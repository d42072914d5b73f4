//! Model of an arm: chain, limits and, if known, closed-form inverse kinematics.

use crate::damped::DampedLeastSquares;
use crate::six_axis;
use crate::{AxisLimits, Chain, InverseKinematicsError, Pose, Range, to_pose, to_transform};
use crate::{opw, srs, ur};

/// Maximum number of axes of an arm model.
pub const MAX_AXES: usize = 7;

/// Method by which the inverse kinematics of an arm are solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InverseKinematics {
    /// Seven axes with spherical shoulder and wrist (S-R-S), in closed form, parametrised by the arm angle: the angle
    /// of the elbow about the line from shoulder to wrist.
    Srs(srs::Geometry),
    /// Six axes of which the last three meet in one point (spherical wrist), in closed form.
    Opw(opw::Geometry),
    /// Six axes of which the second to fourth are parallel, in closed form.
    Ur(ur::Geometry),
    /// Any chain, by iterations of [damped least squares](crate::damped) from the hint.
    DampedLeastSquares {
        /// Index of the axis, counted from 0, that keeps its value in the hint, so that the joint values of a redundant
        /// arm are determined by the pose. `None` if all axes move.
        held_axis: Option<usize>,
    },
    /// No inverse kinematics is known for the arm.
    NoClosedForm,
}

/// Kinematics, ranges and limits of one type of arm, as its vendor states them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmModel {
    /// Name of the arm model in `cell.toml`.
    pub id: &'static str,
    /// Name of the arm for people, as the vendor writes it.
    pub display_name: &'static str,
    /// Source of the lengths and limits, such as a data sheet.
    pub source: &'static str,
    /// Kinematic chain of the arm, from the base to the flange.
    pub chain: Chain,
    /// Limits of position, velocity, acceleration and jerk, one entry per axis.
    pub limits: &'static [AxisLimits],
    /// Method by which the inverse kinematics of the arm is solved.
    pub inverse: InverseKinematics,
}

impl ArmModel {
    /// Returns the number of axes of the arm.
    #[must_use]
    pub const fn axes(&self) -> usize {
        self.chain.axes()
    }

    /// Returns the pose of the flange in the base frame for joint values in rad (m for a prismatic axis). NaN or
    /// infinite joint values give a pose of NaN.
    #[must_use]
    pub fn forward(&self, joints: &[f64]) -> Pose {
        to_pose(&self.chain.flange_pose(joints))
    }

    /// Returns joint values (rad) for a pose of the flange in the base frame, within `limits`: of several solutions,
    /// one near to the joint values `hint` (rad). They are the first [`axes`](Self::axes) entries of the result; the
    /// other entries are 0.
    ///
    /// # Errors
    /// Any [`InverseKinematicsError`]. `NotFinite` also if `hint` or `limits` have fewer entries than the arm has axes.
    pub fn inverse(
        &self,
        flange: &Pose,
        hint: &[f64],
        limits: &[AxisLimits],
    ) -> Result<[f64; MAX_AXES], InverseKinematicsError> {
        self.inverse_with_elbow(flange, hint, hint, limits)
    }

    /// Returns joint values (rad) for a pose of the flange in the base frame, within `limits`: of several solutions,
    /// one near to the joint values `hint` (rad). A redundant arm keeps the position of the elbow that it has at the
    /// joint values `elbow` (rad); arms with six axes ignore `elbow`.
    ///
    /// # Errors
    /// Any [`InverseKinematicsError`]. `NotFinite` also if an array has fewer entries than the arm has axes.
    pub fn inverse_with_elbow(
        &self,
        flange: &Pose,
        hint: &[f64],
        elbow: &[f64],
        limits: &[AxisLimits],
    ) -> Result<[f64; MAX_AXES], InverseKinematicsError> {
        let flange = to_transform(flange);
        match self.inverse {
            InverseKinematics::Srs(geometry) => {
                let (hint, elbow) = (first_n(hint)?, first_n(elbow)?);
                let ranges = first_n(limits)?.map(|axis: AxisLimits| axis.position);
                let choice = geometry.inverse_with_elbow(&flange, &hint, &elbow, &ranges)?;
                Ok(choice.joints)
            }
            InverseKinematics::Opw(geometry) => solve_six_axis(hint, limits, |hint, ranges| {
                geometry.nearest_solution(&flange, hint, ranges)
            }),
            InverseKinematics::Ur(geometry) => solve_six_axis(hint, limits, |hint, ranges| {
                geometry.nearest_solution(&flange, hint, ranges)
            }),
            InverseKinematics::DampedLeastSquares { held_axis } => DampedLeastSquares {
                chain: &self.chain,
                limits,
                held_axis,
            }
            .near(&to_pose(&flange), hint),
            InverseKinematics::NoClosedForm => Err(InverseKinematicsError::NoClosedForm),
        }
    }

    /// Returns joint values (rad) for a pose of the flange in the base frame, within `limits`: of several solutions,
    /// one near to the joint values `hint` (rad). If iterations from the hint do not converge to the pose, they start
    /// again from joint values spread over the ranges. Not for the cycle: up to [`STARTS`](crate::damped::STARTS) times
    /// the work of [`inverse`](Self::inverse).
    ///
    /// # Errors
    /// Any [`InverseKinematicsError`]. `NotFinite` also if an array has fewer entries than the arm has axes.
    pub fn inverse_anywhere(
        &self,
        flange: &Pose,
        hint: &[f64],
        limits: &[AxisLimits],
    ) -> Result<[f64; MAX_AXES], InverseKinematicsError> {
        let near = self.inverse(flange, hint, limits);
        match (near, self.inverse) {
            (
                Err(InverseKinematicsError::OutOfReach),
                InverseKinematics::DampedLeastSquares { .. },
            ) => DampedLeastSquares {
                chain: &self.chain,
                limits,
                held_axis: None,
            }
            .anywhere(flange, hint),
            (near, _) => near,
        }
    }

    /// Returns the arm angle of a redundant arm at `joints` (rad): the angle of the elbow about the line from shoulder
    /// to wrist, in rad. `None` for other arms.
    #[must_use]
    pub fn arm_angle(&self, joints: &[f64]) -> Option<f64> {
        match self.inverse {
            InverseKinematics::Srs(geometry) => first_n(joints)
                .ok()
                .map(|joints| geometry.arm_angle(&joints)),
            _ => None,
        }
    }

    /// Returns the arm angles of a redundant arm (positions of the elbow, rad, not wrapped) at which axis 3 has the
    /// value `third` (rad), or half a turn more, for a pose of the flange in the base frame; NaN if there are none.
    /// `None` for other arms, and for poses out of reach.
    #[must_use]
    pub fn arm_angles_of_third_axis(&self, flange: &Pose, third: f64) -> Option<[f64; 2]> {
        let InverseKinematics::Srs(geometry) = self.inverse else {
            return None;
        };
        let found = geometry.arm_angles_of_third_joint(&to_transform(flange), third);
        found.ok()
    }

    /// Returns the joint values of a redundant arm with axis 3 set to `third` and axis 1 turned by the opposite angle
    /// (rad). The pose of the flange stays the same if the upper arm is upright, or if `third` differs from the present
    /// value by rounding only. `None` for other arms.
    #[must_use]
    pub fn with_third_axis(&self, joints: &[f64], third: f64) -> Option<[f64; MAX_AXES]> {
        match self.inverse {
            InverseKinematics::Srs(geometry) => {
                let joints = first_n(joints).ok()?;
                Some(geometry.with_third_joint(&joints, third))
            }
            _ => None,
        }
    }

    /// Returns the joint values (rad) for a pose of the flange in the base frame, within `limits`, and the change of
    /// the arm angle (rad, 0 for no change). A redundant arm gets the arm angle `arm_angle` (rad, position of the
    /// elbow), or the nearest one with joints within the limits. Of several solutions, one near to `hint` (rad) is
    /// chosen. Arms with six axes ignore `arm_angle`.
    ///
    /// # Errors
    /// Any [`InverseKinematicsError`]. `NotFinite` also if an array has fewer entries than the arm has axes.
    pub fn inverse_at_arm_angle(
        &self,
        flange: &Pose,
        hint: &[f64],
        arm_angle: f64,
        limits: &[AxisLimits],
    ) -> Result<([f64; MAX_AXES], f64), InverseKinematicsError> {
        let InverseKinematics::Srs(geometry) = self.inverse else {
            return self
                .inverse(flange, hint, limits)
                .map(|joints| (joints, 0.0));
        };
        let ranges = first_n(limits)?.map(|axis: AxisLimits| axis.position);
        let flange = to_transform(flange);
        let found = geometry.inverse_at_arm_angle(&flange, &first_n(hint)?, arm_angle, &ranges)?;
        Ok((found.joints, found.arm_angle_change))
    }

    /// Returns the joint values (rad) for a pose of the flange in the base frame as [`inverse`](Self::inverse) does,
    /// but NaN for every joint if there is no solution.
    #[must_use]
    pub fn inverse_or_nan(
        &self,
        flange: &Pose,
        hint: &[f64],
        limits: &[AxisLimits],
    ) -> [f64; MAX_AXES] {
        self.inverse(flange, hint, limits)
            .unwrap_or([f64::NAN; MAX_AXES])
    }
}

/// Returns the solution of a six-axis arm nearest to `hint` (rad) within the ranges of `limits`. `solve` computes it
/// from the hint and the ranges.
fn solve_six_axis(
    hint: &[f64],
    limits: &[AxisLimits],
    solve: impl FnOnce(
        &six_axis::Joints,
        &[Range; 6],
    ) -> Result<six_axis::Joints, InverseKinematicsError>,
) -> Result<[f64; MAX_AXES], InverseKinematicsError> {
    let hint = first_n(hint)?;
    let ranges = first_n(limits)?.map(|axis: AxisLimits| axis.position);
    let chosen = solve(&hint, &ranges)?;
    let mut joints = [0.0; MAX_AXES];
    joints[..6].copy_from_slice(&chosen);
    Ok(joints)
}

/// Returns the first `N` entries of a slice; the error is `NotFinite` if the slice is shorter.
fn first_n<T: Copy, const N: usize>(all: &[T]) -> Result<[T; N], InverseKinematicsError> {
    all.first_chunk::<N>()
        .copied()
        .ok_or(InverseKinematicsError::NotFinite)
}
