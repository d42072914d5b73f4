//! The path in joint space: the inverse kinematics along it.

use crate::arm_angle::ArmAngle;
use crate::path::Path;
use crate::path_error::{PathError, PathErrorKind};
use crate::{Arm, Joints};
use rpi_kin::Pose;

/// A step of an axis from its hint above this is a change of configuration, rad.
const CONFIGURATION_STEP: f64 = 0.1;

/// How far ahead the arm angle is looked at, m, and in which steps.
const AHEAD: f64 = 0.1;
const STEP: f64 = 0.01;

/// Shortest stretch of the path on which the arm angle may change, m.
const SHORTEST_MOVE: f64 = 0.01;

/// Bend of the shoulder (axis 2, rad) below which a path begins with axis 3 held instead of the arm angle, and above which
/// the arm angle is held again.
const UPRIGHT: f64 = 0.03;
const INCLINED: f64 = 0.15;

/// Extra changes of the arm angle beyond the necessary one, rad. The largest that the ranges allow is taken.
const FARTHER: [f64; 4] = [0.3, 0.15, 0.05, 0.01];

/// A path, and the arm angle along it.
#[derive(Clone, Copy, Debug)]
pub struct JointPath {
    /// Path of the tool in space.
    pub path: Path,
    arm_angle: ArmAngle,
    is_redundant: bool,
    /// Place (value of the path parameter) up to which the arm angle has been planned, and the joints there.
    seen: (f64, Joints),
}

impl JointPath {
    /// Begins a path with the arm angle of joints at its start.
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

    /// Creates a path whose arm angle is constant at 0, for arms or uses in which it does not matter.
    pub(crate) fn still(path: Path) -> Self {
        Self {
            path,
            arm_angle: ArmAngle::default(),
            is_redundant: false,
            seen: (0.0, [0.0; rpi_kin::MAX_AXES]),
        }
    }

    /// Returns the joints of the path at a place, near to `hint`.
    ///
    /// # Errors
    /// A [`PathError`] if there are none, or if they belong to another configuration.
    pub fn joints_at(&self, arm: &Arm, s: f64, hint: &Joints) -> Result<Joints, PathError> {
        let joints = self.solution_at(arm, s, hint)?;
        let is_joint_line = matches!(self.path, Path::Joints(_));
        let jump = |axis: &usize| (joints[*axis] - hint[*axis]).abs() > CONFIGURATION_STEP;
        match (0..arm.axes()).find(jump) {
            Some(axis) if !is_joint_line => Err(PathError {
                s,
                kind: PathErrorKind::ConfigurationChange { axis },
            }),
            _ => Ok(joints),
        }
    }

    /// Returns the joints of the path at a place, of whatever configuration: the nearest ones to `hint`.
    ///
    /// # Errors
    /// A [`PathError`] if there are none.
    pub fn solution_at(&self, arm: &Arm, s: f64, hint: &Joints) -> Result<Joints, PathError> {
        let path = match &self.path {
            Path::Joints(line) => return Ok(line.joints(s)),
            Path::Tool(path) => path,
        };
        let pose = path.pose(s);
        let angle = self.arm_angle_at(arm, s, &pose, hint);
        let found = match self.arm_angle.held_third_axis(s) {
            Some(third) => arm.inverse_with_third_axis(&pose, hint, angle, third),
            None => arm.inverse(&pose, hint, angle),
        };
        found.map(|(joints, _)| joints).map_err(|error| PathError {
            s,
            kind: PathErrorKind::NoInverse(error),
        })
    }

    /// Returns the joints near to `hint` for a pose of the tool that is displaced from the path at a place, with an arm angle
    /// that differs from that of the path by `change` (rad). `None` if there are none.
    pub(crate) fn displaced_joints(
        &self,
        arm: &Arm,
        s: f64,
        pose: &Pose,
        change: f64,
        hint: &Joints,
    ) -> Option<Joints> {
        let Path::Tool(path) = &self.path else {
            return None;
        };
        let angle = self.arm_angle_at(arm, s, &path.pose(s), hint) + change;
        arm.inverse(pose, hint, angle).ok().map(|found| found.0)
    }

    /// Whether the arm angle is free at a place: axis 3 is not held there.
    pub(crate) fn has_free_arm_angle(&self, s: f64) -> bool {
        self.arm_angle.held_third_axis(s).is_none()
    }

    /// Returns the arm angle of the path at a place, rad; 0 for an arm without.
    pub(crate) fn arm_angle_of_path(&self, arm: &Arm, s: f64, hint: &Joints) -> f64 {
        match &self.path {
            Path::Tool(path) if self.is_redundant => self.arm_angle_at(arm, s, &path.pose(s), hint),
            _ => 0.0,
        }
    }

    /// Whether the arm has an arm angle to choose on this path.
    #[must_use]
    pub fn is_redundant(&self) -> bool {
        self.is_redundant
    }

    /// The arm angle at a place of the path with this pose of the tool, near to the joints `hint`, rad.
    fn arm_angle_at(&self, arm: &Arm, s: f64, pose: &Pose, hint: &Joints) -> f64 {
        let of_third = |third, near| arm.arm_angle_of_third_axis(pose, third, hint, near);
        self.arm_angle.at(s, of_third)
    }

    /// Looks ahead of `built` (the end of the part that is in use), at most `steps` steps, and moves the arm angle where
    /// the ranges of the axes will demand it.
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

    /// Passes over to a held arm angle behind a place `s` with these joints, if the upper arm is inclined enough there.
    fn pass_over(&mut self, arm: &Arm, s: f64, joints: &Joints, built: f64) {
        if self.arm_angle.holds_axis() && joints[1].abs() > INCLINED {
            let from = s.max(built);
            let angle = arm.arm_angle(joints).unwrap_or(0.0);
            self.arm_angle.release_axis(from, from + AHEAD, angle);
        }
    }
}
