//! An arm as the rest of the system sees it: a chain, limits and, where one is known, a closed-form inverse.

use crate::six;
use crate::{AxisLimits, Chain, NoSolution, Pose, pose_of, transform_of};
use crate::{opw, srs, ur};

/// No arm here has more axes.
pub const MAX_AXES: usize = 7;

/// The closed form that solves an arm's inverse kinematics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Inverse {
    /// Seven axes, S-R-S, by arm angle.
    Srs(srs::Geometry),
    /// Six axes, the last three meeting in a point.
    Opw(opw::Geometry),
    /// Six axes, the second to fourth parallel.
    Ur(ur::Geometry),
    /// None known.
    Unknown,
}

/// One type of arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArmModel {
    /// The name in `cell.toml`.
    pub id: &'static str,
    /// The name for people.
    pub title: &'static str,
    /// Where lengths and limits come from.
    pub source: &'static str,
    /// Base to flange.
    pub chain: Chain,
    /// One entry for each axis.
    pub limits: &'static [AxisLimits],
    /// How to invert it.
    pub inverse: Inverse,
}

impl ArmModel {
    /// The number of axes.
    #[must_use]
    pub const fn axes(&self) -> usize {
        self.chain.axes()
    }

    /// The flange in the base. NaN or infinite joints give a pose of NaN.
    #[must_use]
    pub fn forward(&self, joints: &[f64]) -> Pose {
        pose_of(&self.chain.flange(joints))
    }

    /// The joints (rad) that put the flange at `flange` (in the base), chosen by the joints `hint` within `limits`;
    /// written to the first [`axes`](Self::axes) entries of the result, the rest zero.
    ///
    /// # Errors
    /// Any [`NoSolution`]; `NotFinite` also if `hint` or `limits` have fewer entries than the arm has axes.
    pub fn inverse(
        &self,
        flange: &Pose,
        hint: &[f64],
        limits: &[AxisLimits],
    ) -> Result<[f64; MAX_AXES], NoSolution> {
        self.inverse_with_elbow(flange, hint, hint, limits)
    }

    /// As [`inverse`](Self::inverse), with the elbow of a redundant arm as in the joints `elbow`. Arms of six axes have no
    /// elbow to choose and do not look at it.
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

    /// As [`inverse`](Self::inverse), with NaN for every joint when there is no solution.
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

/// The choice of the hint among a six-axis arm's solutions.
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

/// The first `N` entries, or a refusal if there are fewer.
fn first<T: Copy, const N: usize>(all: &[T]) -> Result<[T; N], NoSolution> {
    all.first_chunk::<N>().copied().ok_or(NoSolution::NotFinite)
}
