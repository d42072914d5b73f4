//! The path in joint space: the inverse kinematics along it.

use crate::arm_angle::ArmAngle;
use crate::path::Path;
use crate::path_error::{PathError, PathErrorKind};
use crate::{Arm, Joints};

/// A step of an axis from its hint above this is a change of configuration, rad.
const CONFIGURATION_STEP: f64 = 0.1;

/// How far ahead the arm angle is looked at, m, and in which steps.
const AHEAD: f64 = 0.1;
const STEP: f64 = 0.01;

/// Shortest stretch of the path on which the arm angle may change, m.
const SHORTEST_MOVE: f64 = 0.01;

/// Extra changes of the arm angle beyond the necessary one, rad. The largest that the ranges allow is taken.
const FARTHER: [f64; 4] = [0.3, 0.15, 0.05, 0.01];

/// A path, and the arm angle along it.
#[derive(Clone, Copy, Debug)]
pub struct JointPath {
    /// The path.
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
        Self {
            is_redundant: angle.is_some() && matches!(path, Path::Tool(_)),
            arm_angle: ArmAngle::constant(angle.unwrap_or(0.0)),
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
        let path = match &self.path {
            Path::Joints(line) => return Ok(line.joints(s)),
            Path::Tool(path) => path,
        };
        let found = arm.inverse(&path.pose(s), hint, self.arm_angle.at(s));
        let (joints, _) = found.map_err(|error| PathError {
            s,
            kind: PathErrorKind::NoInverse(error),
        })?;
        let jump = |axis: &usize| (joints[*axis] - hint[*axis]).abs() > CONFIGURATION_STEP;
        match (0..arm.axes()).find(jump) {
            None => Ok(joints),
            Some(axis) => Err(PathError {
                s,
                kind: PathErrorKind::ConfigurationChange { axis },
            }),
        }
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
        let (pose, angle) = (path.pose(s), self.arm_angle.at(s));
        let hint = self.seen.1;
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
        self.seen = (s, joints);
    }
}
