//! Model of an arm: chain, limits and, if known, closed-form inverse kinematics.

use crate::six_axis;
use crate::{AxisLimits, Chain, InverseKinematicsError, Pose, to_pose, to_transform};
use crate::{opw, srs, ur};

/// Maximum number of axes of an arm model.
pub const MAX_AXES: usize = 7;

/// Closed-form solution of the inverse kinematics of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InverseKinematics {
    /// Seven axes with spherical shoulder and wrist (S-R-S), parametrised by the arm angle.
    Srs(srs::Geometry),
    /// Six axes, the last three through one point (spherical wrist).
    Opw(opw::Geometry),
    /// Six axes, the second to fourth parallel.
    Ur(ur::Geometry),
    /// No closed form is known.
    NoClosedForm,
}

/// Kinematics, ranges and limits of one type of arm, as its vendor states them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmModel {
    /// Name in `cell.toml`.
    pub id: &'static str,
    /// Name of the arm for people, as its maker writes it.
    pub display_name: &'static str,
    /// Source of lengths and limits.
    pub source: &'static str,
    /// Kinematic chain from base to flange.
    pub chain: Chain,
    /// Limits, one entry per axis.
    pub limits: &'static [AxisLimits],
    /// Closed-form inverse kinematics.
    pub inverse: InverseKinematics,
}

impl ArmModel {
    /// Returns the number of axes.
    #[must_use]
    pub const fn axes(&self) -> usize {
        self.chain.axes()
    }

    /// Returns the pose of the flange in the base frame for joint values in rad. NaN or infinite joint values give a
    /// pose of NaN.
    #[must_use]
    pub fn forward(&self, joints: &[f64]) -> Pose {
        to_pose(&self.chain.flange_pose(joints))
    }

    /// Returns the joint values (rad) for a pose of the flange in the base frame, chosen by the joint values `hint`
    /// (rad) and within `limits`. They are the first [`axes`](Self::axes) entries of the result; the other entries are
    /// 0.
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

    /// As [`inverse`](Self::inverse), but a redundant arm keeps the elbow position of the joint values `elbow` (rad).
    /// Arms with six axes ignore `elbow`.
    ///
    /// # Errors
    /// As [`inverse`](Self::inverse).
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
            InverseKinematics::Opw(geometry) => {
                solve_six_axis(hint, limits, |hint| geometry.solutions(&flange, hint))
            }
            InverseKinematics::Ur(geometry) => {
                solve_six_axis(hint, limits, |hint| geometry.solutions(&flange, hint))
            }
            InverseKinematics::NoClosedForm => Err(InverseKinematicsError::NoClosedForm),
        }
    }

    /// Returns the arm angle of joint values (rad) of a redundant arm, rad; `None` for other arms.
    #[must_use]
    pub fn arm_angle(&self, joints: &[f64]) -> Option<f64> {
        match self.inverse {
            InverseKinematics::Srs(geometry) => first_n(joints)
                .ok()
                .map(|joints| geometry.arm_angle(&joints)),
            _ => None,
        }
    }

    /// Returns the arm angles (rad, not wrapped) of a redundant arm at which axis 3 has the value `third` (rad), or half a turn
    /// more, for a pose of the flange in the base frame; NaN if there are none. `None` for other arms, and for poses out of
    /// reach.
    #[must_use]
    pub fn arm_angles_of_third_axis(&self, flange: &Pose, third: f64) -> Option<[f64; 2]> {
        let InverseKinematics::Srs(geometry) = self.inverse else {
            return None;
        };
        let found = geometry.arm_angles_of_third_joint(&to_transform(flange), third);
        found.ok()
    }

    /// Returns joint values (rad) of a redundant arm whose axis 3 has the value `third` (rad) and whose axis 1 has turned by the
    /// opposite angle: the same pose, if `third` is within rounding of the present value. `None` for other arms.
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

    /// As [`inverse`](Self::inverse), but a redundant arm gets the arm angle `arm_angle` (rad). Where no joints within
    /// the limits have it, the nearest arm angle is taken. Returns the joints, and the change of the arm angle (rad, 0
    /// if it was kept). Arms with six axes ignore `arm_angle`.
    ///
    /// # Errors
    /// As [`inverse`](Self::inverse).
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

    /// As [`inverse`](Self::inverse), but returns NaN for every joint if there is no solution.
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

/// Returns the solution of a six-axis arm nearest to the hint.
fn solve_six_axis(
    hint: &[f64],
    limits: &[AxisLimits],
    solve: impl FnOnce(&six_axis::Joints) -> Result<six_axis::Solutions, InverseKinematicsError>,
) -> Result<[f64; MAX_AXES], InverseKinematicsError> {
    let hint = first_n(hint)?;
    let ranges = first_n(limits)?.map(|axis: AxisLimits| axis.position);
    let chosen = six_axis::choose_nearest(&solve(&hint)?, &hint, &ranges)?;
    let mut joints = [0.0; MAX_AXES];
    joints[..6].copy_from_slice(&chosen);
    Ok(joints)
}

/// Returns the first `N` entries of a slice.
fn first_n<T: Copy, const N: usize>(all: &[T]) -> Result<[T; N], InverseKinematicsError> {
    all.first_chunk::<N>()
        .copied()
        .ok_or(InverseKinematicsError::NotFinite)
}
