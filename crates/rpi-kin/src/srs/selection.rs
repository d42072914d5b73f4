//! Choice among all solutions by a hint.
//!
//! The first of these rules with a solution that has all joints in range:
//!
//! 1. The arm angle of the hint and, of the eight branches, the one nearest to the hint.
//! 2. The same branch with every joint at most half a turn from the hint and the smallest change of the arm angle.
//! 3. Any branch with the smallest change of the arm angle; of several branches, the one nearest to the hint.
//!
//! The distance is the largest difference of a joint, with each joint moved by full turns to the value nearest to the
//! hint (for rule 3, within its range). So a path that stays in range keeps its configuration. A path that meets a
//! limit moves the elbow instead of jumping.

use super::arm_angle_limits::{
    MAX_LIMIT_ARM_ANGLES, arm_angles_of_third_joint, canonical_ranges, limit_arm_angles,
};
use super::branches::{Branch, first_branch};
use super::elbow::{ElbowCircle, ElbowPosition};
use super::{ElbowTriangle, Geometry, Joints};
use crate::angle::{HALF_TURN, SinCos, nearest_turn, turn_within, wrap};
use crate::six_axis::distance;
use crate::{InverseKinematicsError, Range, Transform};

/// Distance from a limit, in rad, at which a joint is placed that would be exactly at the limit: larger than rounding
/// errors, too small to matter in practice.
const LIMIT_MARGIN: f64 = 1e-9;

/// Solution of the inverse kinematics of a seven-axis arm: joint values that reach a pose, and their arm angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Joint values, in rad.
    pub joints: Joints,
    /// Arm angle of the joint values: the angle of the elbow about the line from the shoulder to the wrist, in rad.
    pub arm_angle: f64,
    /// Change of the arm angle from that of the hint, in rad; 0 for no change.
    pub arm_angle_change: f64,
    /// Branch of the joint values: which of the axes 2, 4 and 6 bend in the negative sense.
    pub branch: Branch,
}

impl Geometry {
    /// Returns joint values (rad) for a pose of the flange in the base frame, within `ranges` (rad): with the arm angle
    /// of the joint values `hint` (rad) if possible, and near to the hint.
    ///
    /// # Errors
    /// [`InverseKinematicsError::OutOfReach`], [`InverseKinematicsError::OutOfLimits`], or
    /// [`InverseKinematicsError::NotFinite`].
    pub fn inverse(
        &self,
        flange: &Transform,
        hint: &Joints,
        ranges: &[Range; 7],
    ) -> Result<Solution, InverseKinematicsError> {
        self.inverse_with_elbow(flange, hint, hint, ranges)
    }

    /// Returns joint values (rad) for a pose of the flange in the base frame, within `ranges` (rad): with the arm angle
    /// of the joint values `elbow` (rad) if possible, and near to `hint` (rad).
    ///
    /// # Errors
    /// [`InverseKinematicsError::OutOfReach`], [`InverseKinematicsError::OutOfLimits`], or
    /// [`InverseKinematicsError::NotFinite`].
    pub fn inverse_with_elbow(
        &self,
        flange: &Transform,
        hint: &Joints,
        elbow: &Joints,
        ranges: &[Range; 7],
    ) -> Result<Solution, InverseKinematicsError> {
        if hint.iter().chain(elbow).any(|joint| !joint.is_finite()) {
            return Err(InverseKinematicsError::NotFinite);
        }
        let elbow = ElbowPosition::from_joints(self, &self.apply_sense(elbow));
        self.solve(flange, hint, ranges, |circle| {
            elbow.map_or(SinCos { sin: 0.0, cos: 1.0 }, |elbow| {
                elbow.arm_angle_on(circle)
            })
        })
    }

    /// Returns joint values (rad) for a pose of the flange in the base frame, within `ranges` (rad): with the arm angle
    /// `arm_angle` (rad) if possible, else with the nearest possible one, and near to `hint` (rad).
    ///
    /// # Errors
    /// [`InverseKinematicsError::OutOfReach`], [`InverseKinematicsError::OutOfLimits`], or
    /// [`InverseKinematicsError::NotFinite`].
    pub fn inverse_at_arm_angle(
        &self,
        flange: &Transform,
        hint: &Joints,
        arm_angle: f64,
        ranges: &[Range; 7],
    ) -> Result<Solution, InverseKinematicsError> {
        if !arm_angle.is_finite() || hint.iter().any(|joint| !joint.is_finite()) {
            return Err(InverseKinematicsError::NotFinite);
        }
        self.solve(flange, hint, ranges, |_| SinCos::from_angle(arm_angle))
    }

    fn solve(
        &self,
        flange: &Transform,
        hint: &Joints,
        ranges: &[Range; 7],
        kept_arm_angle: impl FnOnce(&ElbowCircle) -> SinCos,
    ) -> Result<Solution, InverseKinematicsError> {
        let reach = self.elbow_triangle(flange)?;
        let hint = self.apply_sense(hint);
        let ranges = canonical_ranges(ranges, &self.sense);
        let circle = ElbowCircle::new(reach.line);
        let kept = kept_arm_angle(&circle);
        let search = Search::new(&reach, circle, kept, &hint, &ranges);
        let found = search
            .keep_arm_angle()
            .or_else(|| search.change_arm_angle())
            .ok_or(InverseKinematicsError::OutOfLimits)?;
        Ok(Solution {
            joints: self.apply_sense(&found.joints),
            ..found
        })
    }

    /// Returns the arm angles (rad, not wrapped) at which the third joint has the value `third` (rad), or half a turn
    /// more, for a pose of the flange in the base frame; NaN if there are none.
    ///
    /// # Errors
    /// [`InverseKinematicsError::OutOfReach`] or [`InverseKinematicsError::NotFinite`].
    pub fn arm_angles_of_third_joint(
        &self,
        flange: &Transform,
        third: f64,
    ) -> Result<[f64; 2], InverseKinematicsError> {
        let reach = self.elbow_triangle(flange)?;
        let circle = ElbowCircle::new(reach.line);
        Ok(arm_angles_of_third_joint(
            &reach,
            &circle,
            self.sense[2] * third,
        ))
    }

    /// Returns the joint values with the third one set to `third` and the first one turned by the opposite angle (rad).
    ///
    /// If the upper arm is nearly upright, both joints are ill-conditioned, but their sum is not: the change then
    /// replaces the rounding error of the third joint without moving the flange.
    #[must_use]
    pub fn with_third_joint(&self, joints: &Joints, third: f64) -> Joints {
        let mut moved = *joints;
        moved[0] += self.sense[0] * self.sense[2] * (joints[2] - third);
        moved[2] = third;
        moved
    }

    /// Returns all eight solutions for a pose of the flange in the base frame and an arm angle (rad): joint values in
    /// rad, from -π to π, without regard to ranges. Angles that the pose does not determine are 0.
    ///
    /// # Errors
    /// [`InverseKinematicsError::OutOfReach`] or [`InverseKinematicsError::NotFinite`].
    pub fn branches(
        &self,
        flange: &Transform,
        arm_angle: f64,
    ) -> Result<[Joints; 8], InverseKinematicsError> {
        let reach = self.elbow_triangle(flange)?;
        let elbow = ElbowCircle::new(reach.line).direction(SinCos::from_angle(arm_angle));
        let first = first_branch(&reach, &elbow, &[0.0; 7]);
        Ok(Branch::ALL.map(|branch| self.apply_sense(&branch.apply(&first).map(wrap))))
    }

    /// Returns the arm angle of a set of joint values, in rad; 0 if the forearm is folded back to the shoulder.
    #[must_use]
    pub fn arm_angle(&self, joints: &Joints) -> f64 {
        ElbowPosition::from_joints(self, &self.apply_sense(joints))
            .map_or(0.0, |elbow| elbow.arm_angle().angle())
    }
}

/// One search for joint values of a redundant arm: pose, hint and ranges, in canonical angles (`sense * joint value`).
struct Search<'a> {
    reach: &'a ElbowTriangle,
    circle: ElbowCircle,
    hint: &'a Joints,
    ranges: &'a [Range; 7],
    kept_arm_angle: SinCos,
    nearest: Solution,
}

impl<'a> Search<'a> {
    fn new(
        reach: &'a ElbowTriangle,
        circle: ElbowCircle,
        kept: SinCos,
        hint: &'a Joints,
        ranges: &'a [Range; 7],
    ) -> Self {
        let first = first_branch(reach, &circle.direction(kept), hint);
        let turned = |branch: Branch| -> Joints {
            let joints = branch.apply(&first);
            core::array::from_fn(|axis| nearest_turn(joints[axis], hint[axis]))
        };
        let of_hint = Branch::of(hint);
        let (branch, joints) = match turned(of_hint) {
            joints if distance(&joints, hint) < SURELY_NEAREST => (of_hint, joints),
            _ => nearest(
                Branch::ALL
                    .map(|branch| (branch, turned(branch)))
                    .into_iter(),
                hint,
            )
            .unwrap_or((Branch::ALL[0], first)),
        };
        let nearest = Solution {
            joints,
            arm_angle: kept.angle(),
            arm_angle_change: 0.0,
            branch,
        };
        Self {
            reach,
            circle,
            hint,
            ranges,
            kept_arm_angle: kept,
            nearest,
        }
    }

    /// Returns the solution nearest to the hint with the arm angle that is to be preserved (rule 1 of the module);
    /// `None` if its joints are not all within their ranges.
    fn keep_arm_angle(&self) -> Option<Solution> {
        self.fits(&self.nearest.joints).then_some(self.nearest)
    }

    /// Returns the solution with the smallest change of the arm angle (rules 2 and 3 of the module); `None` if there is
    /// none within the ranges.
    fn change_arm_angle(&self) -> Option<Solution> {
        let near = core::array::from_fn(|axis| self.near_hint(axis));
        let own = [self.nearest.branch];
        let mut angles = self.candidates(&near).into_iter();
        angles
            .find_map(|angle| self.at(angle, &own, &near))
            .or_else(|| {
                let kept = core::iter::once(self.nearest.arm_angle);
                let mut angles = kept.chain(self.candidates(self.ranges));
                angles.find_map(|angle| self.at(angle, &Branch::ALL, self.ranges))
            })
    }

    /// Returns the part of the range of an axis (counted from 0) that is at most half a turn from the hint.
    fn near_hint(&self, axis: usize) -> Range {
        let (range, hint) = (self.ranges[axis], self.hint[axis]);
        Range {
            lower: range.lower.max(hint - HALF_TURN),
            upper: range.upper.min(hint + HALF_TURN),
        }
    }

    /// Returns the arm angles (rad) at which a joint enters its range in `ranges`, in order of their distance from the
    /// arm angle to keep. Unused entries are NaN, at the end.
    fn candidates(&self, ranges: &[Range; 7]) -> [f64; MAX_LIMIT_ARM_ANGLES] {
        let inner = ranges.map(|range| range.shrunk(LIMIT_MARGIN));
        let mut angles = limit_arm_angles(self.reach, &self.circle, &inner);
        // Unused entries are NaN. `abs` makes their distance a positive NaN, which `total_cmp` orders last.
        angles.sort_unstable_by(|one, other| self.distance(*one).total_cmp(&self.distance(*other)));
        angles
    }

    fn distance(&self, arm_angle: f64) -> f64 {
        wrap(arm_angle - self.nearest.arm_angle).abs()
    }

    /// Returns, among `branches`, the solution nearest to the hint at the arm angle `arm_angle` (rad), with all joints
    /// in `ranges`; `None` if there is none.
    fn at(&self, arm_angle: f64, branches: &[Branch], ranges: &[Range; 7]) -> Option<Solution> {
        if arm_angle.is_nan() {
            return None;
        }
        let moved = wrap(arm_angle - self.nearest.arm_angle);
        // The kept sine and cosine are used unchanged: computed again from the angle they would differ in the last
        // bits.
        let elbow = if moved == 0.0 {
            self.kept_arm_angle
        } else {
            SinCos::from_angle(arm_angle)
        };
        let first = first_branch(self.reach, &self.circle.direction(elbow), self.hint);
        let fitting = branches.iter().filter_map(|branch| {
            Some((
                *branch,
                self.moved_into_range(ranges, &branch.apply(&first))?,
            ))
        });
        let (branch, joints) = nearest(fitting, self.hint)?;
        Some(Solution {
            joints,
            arm_angle: wrap(arm_angle),
            arm_angle_change: moved,
            branch,
        })
    }

    fn moved_into_range(&self, ranges: &[Range; 7], joints: &Joints) -> Option<Joints> {
        let mut turned = *joints;
        for (axis, joint) in turned.iter_mut().enumerate() {
            *joint = turn_within(*joint, self.hint[axis], ranges[axis])?;
        }
        Some(turned)
    }

    fn fits(&self, joints: &Joints) -> bool {
        joints
            .iter()
            .zip(self.ranges)
            .all(|(joint, range)| range.contains(*joint))
    }
}

/// Distance of a solution from the hint, rad, below which it is the nearest of all: every other branch has an axis that is
/// turned by half a turn, and so is at least half a turn less this distance away. The rest is for rounding.
const SURELY_NEAREST: f64 = HALF_TURN / 2.0 - 1e-6;

/// Returns the candidate whose joint values have the smallest distance from `hint` (largest difference of a joint,
/// rad); the first one of several equal ones.
fn nearest(
    candidates: impl Iterator<Item = (Branch, Joints)>,
    hint: &Joints,
) -> Option<(Branch, Joints)> {
    candidates.min_by(|(_, one), (_, other)| distance(one, hint).total_cmp(&distance(other, hint)))
}
