//! The path in joint space: the inverse kinematics along it.

use crate::arm_angle::ArmAngle;
use crate::path::Path;
use crate::path_error::{PathError, PathErrorKind};
use crate::ranges::PATH_MARGIN;
use crate::{Arm, Joints};
use rpi_kin::{InverseKinematicsError, Pose};

/// Difference of an axis from its hint, rad, above which the arm has changed its configuration.
const CONFIGURATION_STEP: f64 = 0.1;

/// Length of the path ahead of the motion for which the arm angle (position of the elbow) is planned, m.
const AHEAD: f64 = 0.1;
/// Distance between the places on the path at which the arm angle is planned, m.
const STEP: f64 = 0.01;

/// Minimum length of the path on which the arm angle changes, m.
const SHORTEST_MOVE: f64 = 0.01;

/// Bend of the shoulder (magnitude of axis 2, rad) below which a path begins with axis 3 held instead of the arm angle.
const UPRIGHT: f64 = 0.03;
/// Bend of the shoulder (magnitude of axis 2, rad) above which the arm angle is held again, after a start with axis 3
/// held.
const INCLINED: f64 = 0.15;

/// Changes of the arm angle beyond the one that the ranges demand, rad, so that the next change comes later. The
/// largest one that the ranges allow is taken.
const FARTHER: [f64; 4] = [0.3, 0.15, 0.05, 0.01];

/// Path in joint space: a path of the tool or of the joints, and the arm angle (position of the elbow) along it.
#[derive(Clone, Copy, Debug)]
pub struct JointPath {
    /// Path of the tool in space, or line in joint space.
    pub path: Path,
    arm_angle: ArmAngle,
    is_redundant: bool,
    /// Position along the path (m) up to which the arm angle has been planned, and the joint positions (rad) there.
    seen: (f64, Joints),
}

/// Distance from the ends of the ranges (rad) that places shortly before the start of a path and behind its end may
/// have: derivatives at an end need them, but the arm is never there.
const BEYOND: f64 = 0.1;

impl JointPath {
    /// Creates a path in joint space that begins with the arm angle of the joint positions `start` (rad).
    #[must_use]
    pub fn new(arm: &Arm, path: Path, start: &Joints) -> Self {
        let angle = arm.arm_angle(start);
        let is_redundant = angle.is_some() && matches!(path, Path::Tool(_));
        let mut arm_angle = ArmAngle::constant(angle.unwrap_or(0.0));
        if is_redundant && start[1].abs() < UPRIGHT {
            arm_angle.hold_axis(start[2]);
        }
        Self {
            is_redundant,
            arm_angle,
            path,
            seen: (0.0, *start),
        }
    }

    /// Creates a path in joint space with the constant arm angle 0, for paths on which it does not matter.
    pub(crate) fn still(path: Path) -> Self {
        Self {
            path,
            arm_angle: ArmAngle::default(),
            is_redundant: false,
            seen: (0.0, [0.0; rpi_kin::MAX_AXES]),
        }
    }

    /// Returns the joint positions (rad) of the path at the position `s` along it, near to `hint` (rad).
    ///
    /// # Errors
    /// A [`PathError`] if there are none, or if they belong to another configuration than `hint`.
    pub fn joints_at(&self, arm: &Arm, s: f64, hint: &Joints) -> Result<Joints, PathError> {
        let joints = self.solution_at(arm, s, hint)?;
        let is_joint_line = matches!(self.path, Path::Joints(_));
        let jump = |axis: &usize| (joints[*axis] - hint[*axis]).abs() > CONFIGURATION_STEP;
        match (0..arm.axes()).find(jump) {
            Some(axis) if !is_joint_line => {
                Err(self.error_at(s, PathErrorKind::ConfigurationChange { axis }))
            }
            _ => Ok(joints),
        }
    }

    /// Returns the joint positions (rad) of the path at the position `s` along it, nearest to `hint` (rad), whatever
    /// their configuration.
    ///
    /// # Errors
    /// A [`PathError`] if there are none.
    pub fn solution_at(&self, arm: &Arm, s: f64, hint: &Joints) -> Result<Joints, PathError> {
        let path = match &self.path {
            Path::Joints(line) => return Ok(line.joints(s)),
            Path::Tool(path) => path,
        };
        let wider;
        let arm = match (0.0..=path.length()).contains(&s) {
            true => arm,
            false => {
                wider = arm.with_margin(-BEYOND);
                &wider
            }
        };
        let found = self.inverse_at(arm, s, &path.pose(s), hint);
        found.map_err(|error| self.error_at(s, PathErrorKind::NoInverse(error)))
    }

    /// Returns the joint positions (rad) near to `hint` for the pose `pose` of the tool, which belongs to the position `s`
    /// along the path.
    fn inverse_at(
        &self,
        arm: &Arm,
        s: f64,
        pose: &Pose,
        hint: &Joints,
    ) -> Result<Joints, InverseKinematicsError> {
        let angle = self.arm_angle_at(arm, s, pose, hint);
        let found = match self.arm_angle.held_third_axis(s) {
            Some(third) => arm.inverse_with_third_axis(pose, hint, angle, third),
            None => arm.inverse(pose, hint, angle),
        };
        found.map(|(joints, _)| joints)
    }

    /// Returns the joint positions (rad), near to `hint`, at the position `s` along the path on the piece with the index
    /// `piece`, which is continued beyond its ends. `None` if there are none.
    pub(crate) fn joints_on_piece(
        &self,
        arm: &Arm,
        piece: usize,
        s: f64,
        hint: &Joints,
    ) -> Option<Joints> {
        let Path::Tool(path) = &self.path else {
            return None;
        };
        let pose = path.pose_on_piece(piece, s)?;
        let wider = arm.with_margin(-BEYOND);
        let joints = self.inverse_at(&wider, s, &pose, hint).ok()?;
        let jump = |axis: usize| (joints[axis] - hint[axis]).abs() > CONFIGURATION_STEP;
        (!(0..arm.axes()).any(jump)).then_some(joints)
    }

    /// Returns `error` with the axis that would leave its range there, if that is its cause. `hint` are joint positions
    /// (rad) near to the place. Takes an inverse kinematics of its own, so only for an error that is final.
    pub(crate) fn with_axis(&self, arm: &Arm, error: PathError, hint: &Joints) -> PathError {
        let outside = PathErrorKind::NoInverse(InverseKinematicsError::OutOfLimits);
        let Path::Tool(path) = &self.path else {
            return error;
        };
        if error.kind != outside {
            return error;
        }
        let pose = path.pose(error.s);
        let angle = self.arm_angle_at(arm, error.s, &pose, hint);
        let axis = arm.axis_out_of_range(&pose, hint, angle);
        let kind = axis.map_or(outside, |axis| PathErrorKind::OutOfRange { axis });
        PathError { kind, ..error }
    }

    /// Creates the error `kind` at the position `s` along the path. Places shortly before the start and behind the end,
    /// which are computed for derivatives, count as the start and the end.
    pub(crate) fn error_at(&self, s: f64, kind: PathErrorKind) -> PathError {
        PathError {
            s: s.clamp(0.0, self.path.length()),
            kind,
        }
    }

    /// Returns the joint positions (rad), near to `hint`, for the pose `displaced` of the tool beside the path, which has
    /// the pose `on_path` at the position `s` along it. The arm angle differs from that of the path by `change` (rad).
    /// `None` if there are none.
    pub(crate) fn displaced_joints(
        &self,
        arm: &Arm,
        (s, on_path): (f64, &Pose),
        displaced: &Pose,
        change: f64,
        hint: &Joints,
    ) -> Option<Joints> {
        let angle = self.arm_angle_at(arm, s, on_path, hint) + change;
        arm.inverse(displaced, hint, angle)
            .ok()
            .map(|found| found.0)
    }

    /// Returns true if axis 3 is not held at the position `s` along the path, so that the arm angle may change.
    pub(crate) fn has_free_arm_angle(&self, s: f64) -> bool {
        self.arm_angle.held_third_axis(s).is_none()
    }

    /// Returns the arm angle (rad) of the path at the position `s` along it, near to that of `hint`; 0 for an arm that
    /// is not redundant.
    pub(crate) fn arm_angle_of_path(&self, arm: &Arm, s: f64, hint: &Joints) -> f64 {
        match &self.path {
            Path::Tool(path) if self.is_redundant => self.arm_angle_at(arm, s, &path.pose(s), hint),
            _ => 0.0,
        }
    }

    /// Returns true if the arm angle can be chosen along this path: a redundant arm on a path of the tool.
    #[must_use]
    pub fn is_redundant(&self) -> bool {
        self.is_redundant
    }

    /// Returns the arm angle (rad) at the position `s` along the path, where the tool has the pose `pose`, near to that
    /// of the joint positions `hint` (rad).
    fn arm_angle_at(&self, arm: &Arm, s: f64, pose: &Pose, hint: &Joints) -> f64 {
        let of_third = |third, near| arm.arm_angle_of_third_axis(pose, third, hint, near);
        self.arm_angle.at(s, of_third)
    }

    /// Plans the arm angle further ahead, in at most `steps` steps, and changes it where the ranges of the axes will
    /// demand it. `built` is the end (m) of the part of the path that is in use and must not change.
    pub fn look_ahead(&mut self, arm: &Arm, built: f64, steps: usize) {
        if !self.is_redundant {
            return;
        }
        let last = (built + AHEAD).min(self.path.length());
        for _ in 0..steps {
            let s = (self.seen.0 + STEP).min(last);
            if s <= self.seen.0 {
                return;
            }
            self.look_at(arm, s, built);
        }
    }

    fn look_at(&mut self, arm: &Arm, s: f64, built: f64) {
        let Path::Tool(path) = &self.path else { return };
        let arm = &arm.with_margin(PATH_MARGIN);
        let (pose, hint) = (path.pose(s), self.seen.1);
        let angle = self.arm_angle_at(arm, s, &pose, &hint);
        let found = arm.inverse(&pose, &hint, angle);
        let joints = match found {
            Ok((joints, 0.0)) => joints,
            Ok((joints, change)) => {
                let allowed = |extra: &&f64| {
                    let wanted = angle + change + extra.copysign(change);
                    arm.inverse(&pose, &hint, wanted)
                        .is_ok_and(|(_, more)| more == 0.0)
                };
                let extra = FARTHER.iter().find(allowed).copied().unwrap_or(0.0);
                let from = built.max(self.arm_angle.end());
                if s - from >= SHORTEST_MOVE {
                    let _ = self.arm_angle.add(from, s, change + extra.copysign(change));
                }
                joints
            }
            Err(_) => hint,
        };
        self.pass_over(arm, s, &joints, built);
        self.seen = (s, joints);
    }

    /// Passes over from a held axis 3 to a held arm angle, behind the position `s` along the path with the joint
    /// positions `joints`, if the upper arm is inclined enough there. The part up to `built` does not change.
    fn pass_over(&mut self, arm: &Arm, s: f64, joints: &Joints, built: f64) {
        if self.arm_angle.holds_axis() && joints[1].abs() > INCLINED {
            let from = s.max(built);
            let angle = arm.arm_angle(joints).unwrap_or(0.0);
            self.arm_angle.release_axis(from, from + AHEAD, angle);
        }
    }
}
