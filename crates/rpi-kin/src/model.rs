//! Model of an arm: chain, limits and, if known, closed-form inverse kinematics.

use crate::six;
use crate::{AxisLimits, Chain, NoSolution, Pose, pose_of, transform_of};
use crate::{opw, srs, ur};

/// Maximum number of axes of an arm model.
pub const MAX_AXES: usize = 7;

/// Closed-form solution of the inverse kinematics of an arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inverse {
    /// Seven axes with spherical shoulder and wrist (S-R-S), parametrised by the arm angle.
    Srs(srs::Geometry),
    /// Six axes, the last three through one point (spherical wrist).
    Opw(opw::Geometry),
    /// Six axes, the second to fourth parallel.
    Ur(ur::Geometry),
    /// No closed form is known.
    Unknown,
}

/// Model of a type of arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmModel {
    /// Name in `cell.toml`.
    pub id: &'static str,
    /// Display name.
    pub title: &'static str,
    /// Source of lengths and limits.
    pub source: &'static str,
    /// Kinematic chain from base to flange.
    pub chain: Chain,
    /// Limits, one entry per axis.
    pub limits: &'static [AxisLimits],
    /// Closed-form inverse kinematics.
    pub inverse: Inverse,
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
        pose_of(&self.chain.flange(joints))
    }

    /// Returns the joint values (rad) for a pose of the flange in the base frame, chosen by the joint values `hint`
    /// (rad) and within `limits`. They are the first [`axes`](Self::axes) entries of the result; the other entries are
    /// 0.
    ///
    /// # Errors
    /// Any [`NoSolution`]. `NotFinite` also if `hint` or `limits` have fewer entries than the arm has axes.
    pub fn inverse(
        &self,
        flange: &Pose,
        hint: &[f64],
        limits: &[AxisLimits],
    ) -> Result<[f64; MAX_AXES], NoSolution> {
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
    ) -> Result<[f64; MAX_AXES], NoSolution> {
        let flange = transform_of(flange);
        match self.inverse {
            Inverse::Srs(geometry) => {
                let (hint, elbow) = (first(hint)?, first(elbow)?);
                let ranges = first(limits)?.map(|axis: AxisLimits| axis.position);
                let choice = geometry.inverse_with_elbow(&flange, &hint, &elbow, &ranges)?;
                Ok(choice.joints)
            }
            Inverse::Opw(geometry) => {
                six_axes(hint, limits, |hint| geometry.solutions(&flange, hint))
            }
            Inverse::Ur(geometry) => {
                six_axes(hint, limits, |hint| geometry.solutions(&flange, hint))
            }
            Inverse::Unknown => Err(NoSolution::NoClosedForm),
        }
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
fn six_axes(
    hint: &[f64],
    limits: &[AxisLimits],
    solve: impl FnOnce(&six::Joints) -> Result<six::Solutions, NoSolution>,
) -> Result<[f64; MAX_AXES], NoSolution> {
    let hint = first(hint)?;
    let ranges = first(limits)?.map(|axis: AxisLimits| axis.position);
    let chosen = six::choose(&solve(&hint)?, &hint, &ranges)?;
    let mut joints = [0.0; MAX_AXES];
    joints[..6].copy_from_slice(&chosen);
    Ok(joints)
}

/// Returns the first `N` entries.
fn first<T: Copy, const N: usize>(all: &[T]) -> Result<[T; N], NoSolution> {
    all.first_chunk::<N>().copied().ok_or(NoSolution::NotFinite)
}
