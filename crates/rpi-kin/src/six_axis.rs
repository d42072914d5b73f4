//! Common parts of the closed forms for six-axis arms: up to eight solutions, and the choice of one near to a hint.

use crate::angle::{SinCos, turn_within};
use crate::{InverseKinematicsError, Range, Transform};
use nalgebra::Matrix3;

/// Joint values of a six-axis arm, in rad.
pub type Joints = [f64; 6];

/// Up to eight solutions of the inverse kinematics of a six-axis arm. Solutions that do not exist are NaN.
pub type Solutions = [Joints; 8];

/// Placeholder for a solution that does not exist: NaN for every joint.
pub(crate) const MISSING: Joints = [f64::NAN; 6];

/// Tolerance by which rounding may raise a cosine above 1 (no unit). It moves the flange by less than 1e-9 m.
const REACH_TOLERANCE: f64 = 1e-9;

/// Search for the solution nearest to a hint with all joints in range, among solutions that are computed one at a time.
///
/// The distance is the largest difference of a joint; each joint is first moved by full turns to the value in its range
/// nearest to the hint. So the difference of the joints known so far is a lower bound, and a solution that cannot be
/// nearer than the best one need not be completed. Of equally near solutions, the one with the lowest index is chosen.
pub(crate) struct NearestSearch<'a> {
    hint: &'a Joints,
    ranges: &'a [Range; 6],
    nearest: Option<Candidate>,
}

struct Candidate {
    distance: f64,
    index: usize,
    joints: Joints,
}

impl<'a> NearestSearch<'a> {
    /// Starts a search near `hint` (rad) for joints in `ranges`.
    ///
    /// # Errors
    /// [`InverseKinematicsError::NotFinite`] if a joint of the hint is NaN or infinite.
    pub(crate) fn new(
        hint: &'a Joints,
        ranges: &'a [Range; 6],
    ) -> Result<Self, InverseKinematicsError> {
        if hint.iter().any(|joint| !joint.is_finite()) {
            return Err(InverseKinematicsError::NotFinite);
        }
        Ok(Self {
            hint,
            ranges,
            nearest: None,
        })
    }

    /// Returns the difference of one joint from the hint (rad), at least `bound`; infinite if the joint does not exist
    /// (NaN) or has no value in its range.
    pub(crate) fn lower_bound(&self, bound: f64, axis: usize, joint: f64) -> f64 {
        match turn_within(joint, self.hint[axis], self.ranges[axis]) {
            Some(turned) => bound.max((turned - self.hint[axis]).abs()),
            None => f64::INFINITY,
        }
    }

    /// Returns whether a solution with this lower bound of its distance (rad) may be chosen.
    pub(crate) fn may_be_nearest(&self, bound: f64) -> bool {
        match &self.nearest {
            // Not `<`: of equally near solutions, the index decides.
            Some(nearest) => bound <= nearest.distance,
            None => bound < f64::INFINITY,
        }
    }

    /// Takes a solution into account, which has this index among the eight.
    pub(crate) fn offer(&mut self, index: usize, joints: &Joints) {
        let Some(joints) = moved_into_range(joints, self.hint, self.ranges) else {
            return;
        };
        let distance = distance(&joints, self.hint);
        let is_nearer = self.nearest.as_ref().is_none_or(|nearest| {
            distance < nearest.distance || (distance == nearest.distance && index < nearest.index)
        });
        if is_nearer {
            self.nearest = Some(Candidate {
                distance,
                index,
                joints,
            });
        }
    }

    /// Returns the chosen solution (rad); `None` if no solution is in range.
    pub(crate) fn nearest(self) -> Option<Joints> {
        self.nearest.map(|nearest| nearest.joints)
    }
}

/// Returns why none of all solutions for a pose can be chosen. The two errors differ for users: a pose without any
/// solution is too far away, a pose with one needs other limits.
pub(crate) fn reason_for_none(all: &Solutions) -> InverseKinematicsError {
    let exists = |joints: &Joints| joints.iter().all(|joint| joint.is_finite());
    match all.iter().any(exists) {
        true => InverseKinematicsError::OutOfLimits,
        false => InverseKinematicsError::OutOfReach,
    }
}

/// Returns the indices of these distances, nearest first.
pub(crate) fn nearest_first<const N: usize>(distances: &[f64; N]) -> [usize; N] {
    let mut order = core::array::from_fn(|index| index);
    order.sort_unstable_by(|a, b| distances[*a].total_cmp(&distances[*b]));
    order
}

fn moved_into_range(joints: &Joints, hint: &Joints, ranges: &[Range; 6]) -> Option<Joints> {
    let mut turned = *joints;
    for (axis, joint) in turned.iter_mut().enumerate() {
        *joint = turn_within(*joint, hint[axis], ranges[axis])?;
    }
    Some(turned)
}

/// Returns the largest difference of a joint (rad) between two sets of joint values.
pub(crate) fn distance(joints: &[f64], hint: &[f64]) -> f64 {
    let differences = joints
        .iter()
        .zip(hint)
        .map(|(joint, hint)| (joint - hint).abs());
    // The largest difference and not the sum: the axis with the longest way determines the time of a move.
    differences.fold(0.0, f64::max)
}

/// Returns the rotation matrix of a pose.
///
/// # Errors
/// [`InverseKinematicsError::NotFinite`] if an entry of the pose is NaN or infinite.
pub(crate) fn finite_rotation(pose: &Transform) -> Result<&Matrix3<f64>, InverseKinematicsError> {
    let rotation = pose.rotation.matrix();
    let mut entries = pose.translation.vector.iter().chain(rotation.iter());
    match entries.all(|entry| entry.is_finite()) {
        true => Ok(rotation),
        false => Err(InverseKinematicsError::NotFinite),
    }
}

/// Returns the two angles (rad) by which the second of two limbs with the lengths `first` and `second` (m) bends
/// against the first, if its end is at the given distance from the start of the first (law of cosines); NaN if there
/// are none.
pub(crate) fn elbow_bends(first: f64, second: f64, distance_squared: f64) -> [f64; 2] {
    let cos = (distance_squared - first * first - second * second) / (2.0 * first * second);
    if cos.abs() > 1.0 + REACH_TOLERANCE {
        return [f64::NAN; 2];
    }
    let cos = cos.clamp(-1.0, 1.0);
    let bend = SinCos {
        // The product keeps the digits that `1 - cos * cos` would lose for a cosine near 1.
        sin: libm::sqrt((1.0 - cos) * (1.0 + cos)),
        cos,
    }
    .angle();
    [bend, -bend]
}
