//! Common parts of the closed forms for six-axis arms: up to eight solutions, and the choice by a hint.

use crate::angle::{SinCos, turn_within};
use crate::{InverseKinematicsError, Range};

/// Joint values of a six-axis arm, in rad.
pub type Joints = [f64; 6];

/// Up to eight solutions of the inverse kinematics of a six-axis arm. Solutions that do not exist are NaN.
pub type Solutions = [Joints; 8];

/// Placeholder for a solution that does not exist: NaN for every joint.
pub(crate) const MISSING: Joints = [f64::NAN; 6];

/// Tolerance by which rounding may raise a cosine above 1 (no unit). It moves the flange by less than 1e-9 m.
const REACH_TOLERANCE: f64 = 1e-9;

/// Returns the solution nearest to `hint` (rad) with all joints in `ranges`. The distance is the largest difference of
/// a joint; each joint is first moved by full turns to the value in its range nearest to the hint.
///
/// # Errors
/// [`InverseKinematicsError::NotFinite`] if a hint is NaN or infinite, [`InverseKinematicsError::OutOfReach`] if there is no solution,
/// [`InverseKinematicsError::OutOfLimits`] if no solution is in range.
pub fn choose_nearest(
    solutions: &Solutions,
    hint: &Joints,
    ranges: &[Range; 6],
) -> Result<Joints, InverseKinematicsError> {
    if hint.iter().any(|joint| !joint.is_finite()) {
        return Err(InverseKinematicsError::NotFinite);
    }
    let mut existing = solutions
        .iter()
        .filter(|joints| joints.iter().all(|joint| joint.is_finite()))
        .peekable();
    // The two errors differ for users: a pose without any solution is too far away, a pose with one needs other limits.
    if existing.peek().is_none() {
        return Err(InverseKinematicsError::OutOfReach);
    }
    let fitting = existing.filter_map(|joints| moved_into_range(joints, hint, ranges));
    let nearest =
        fitting.min_by(|one, other| distance(one, hint).total_cmp(&distance(other, hint)));
    nearest.ok_or(InverseKinematicsError::OutOfLimits)
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
