//! A path with the time law and the residuals with which the arm follows it.

use crate::node_table::NodeTable;
use crate::path::Path;
use crate::residual::Residual;
use crate::set_point::{MotionError, SetPoint};
use crate::time_law::{HeldBrake, PathState};
use crate::tool_residual::ToolResidual;
use crate::{Arm, JointState, Joints};
use rpi_kin::{MAX_AXES, Pose};

/// Path, time law and residuals (decaying differences between arm and path) of a motion. They determine its set-points
/// until a new time law is planned.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    pub table: NodeTable,
    pub residual: Residual,
    /// Residual of the tool while the tool approaches the path as a whole; `None` if each axis approaches it on its
    /// own.
    pub tool: Option<ToolResidual>,
    pub held: HeldBrake,
    /// Joint positions (rad) that the inverse kinematics gave for the last set-point: the hint for the next one.
    pub hint: Joints,
    /// Pose in the flange frame of the tool that moves along the path.
    pub moved_tool: Pose,
}

impl Course {
    /// Creates the course of an arm at rest, with memory for `nodes` places of a path. Allocates.
    pub(crate) fn new(nodes: usize) -> Self {
        Self {
            table: NodeTable::with_capacity(nodes),
            residual: Residual::default(),
            tool: None,
            held: HeldBrake::standing(0.0, 0.0),
            hint: [0.0; MAX_AXES],
            moved_tool: Pose::identity(),
        }
    }

    pub(crate) fn path(&self) -> &Path {
        self.table.path()
    }

    /// Puts the motion of `arm` at rest at the start of its path, without residuals. `hint` are the joint positions there,
    /// rad.
    pub(crate) fn stand(&mut self, arm: &Arm, hint: Joints) {
        self.moved_tool = arm.tool();
        self.held = HeldBrake::standing(0.0, 0.0);
        self.residual = Residual::default();
        self.tool = None;
        self.hint = hint;
    }

    /// Returns the time of the motion (s) from which the arm is on the path: all residuals have decayed.
    pub(crate) fn residual_end(&self) -> f64 {
        let tool = self.tool.map_or(0.0, |tool| tool.end());
        self.residual.end().max(tool)
    }

    /// Returns the joint positions (rad) at a time of the motion (s), near to `hint`, and those of the inverse
    /// kinematics alone, without the residual of the axes.
    pub(crate) fn joints_at(
        &self,
        arm: &Arm,
        time: f64,
        hint: &Joints,
    ) -> Result<(Joints, Joints), MotionError> {
        self.joints_on(arm, time, &self.held.state_at(time), hint)
    }

    /// As [`joints_at`](Self::joints_at), with the known state `path` of the motion along the path at that time.
    fn joints_on(
        &self,
        arm: &Arm,
        time: f64,
        path: &PathState,
        hint: &Joints,
    ) -> Result<(Joints, Joints), MotionError> {
        let on_path = self.inverse_near(arm, (time, path.s), 0.0, hint)?;
        let mut joints = on_path;
        self.residual.add_to(&mut joints, time);
        Ok((joints, on_path))
    }

    /// Returns the state of the axes at a time of the motion (s), near to the joint positions `hint` (rad).
    ///
    /// Velocity and acceleration are derivatives of the time law and of the residuals. Only the derivatives of the path
    /// are computed by differences, along a curve without a jump of its jerk: differences of set-points, between which
    /// the jerk jumps, would give the acceleration with an error of up to one period of jerk.
    pub(crate) fn state_at(
        &self,
        arm: &Arm,
        time: f64,
        hint: &Joints,
    ) -> Result<JointState, MotionError> {
        /// Step of the differences, s. With a shorter one, rounding errors of the inverse kinematics would matter; with
        /// a longer one, a jump of the third derivative of the path, as at the start of a corner.
        const STEP: f64 = 3e-5;
        let path = self.held.state_at(time);
        let near = |steps: f64| {
            let ahead = steps * STEP;
            self.inverse_near(arm, (time, path.advanced(ahead, 0.0).s), ahead, hint)
        };
        let (a, b, c, d, e) = (near(-2.0)?, near(-1.0)?, near(0.0)?, near(1.0)?, near(2.0)?);
        let mut state = JointState::at_rest(c);
        for axis in 0..arm.axes() {
            let rest = self.residual.state_at(axis, time);
            let [a, b, c, d, e] = [&a, &b, &c, &d, &e].map(|joints| joints[axis] - c[axis]);
            state.position[axis] += rest.position;
            state.velocity[axis] = rest.velocity + (8.0 * (d - b) - (e - a)) / (12.0 * STEP);
            state.acceleration[axis] =
                rest.acceleration + (16.0 * (b + d) - (a + e) - 30.0 * c) / (12.0 * STEP * STEP);
        }
        Ok(state)
    }

    /// Returns the joint positions (rad) of the inverse kinematics `ahead` seconds after a time of the motion (s), near
    /// to `hint`; `s` is the position along the path then. The residual of the tool is continued with the acceleration
    /// that it has at `time`.
    fn inverse_near(
        &self,
        arm: &Arm,
        (time, s): (f64, f64),
        ahead: f64,
        hint: &Joints,
    ) -> Result<Joints, MotionError> {
        let tool = self.tool.filter(|tool| time < tool.end());
        let Some((tool, on_path)) = tool.zip(self.tool_pose(s)) else {
            return Ok(self.table.joints_at(arm, s, hint)?);
        };
        let displaced = tool.displaced(&on_path, time, ahead);
        let angle = tool.arm_angle_at(time, ahead);
        let path = self.table.joint_path();
        path.displaced_joints(arm, (s, &on_path), &displaced, angle, hint)
            .ok_or(MotionError::NotFinite)
    }

    fn tool_pose(&self, s: f64) -> Option<rpi_kin::Pose> {
        match self.path() {
            Path::Tool(path) => Some(path.pose(s)),
            Path::Joints(_) => None,
        }
    }

    /// Returns the set-point at a time of the motion (s).
    pub(crate) fn set_point(&mut self, arm: &Arm, time: f64) -> Result<SetPoint, MotionError> {
        let path = self.held.state_at(time);
        let (joints, hint) = self.joints_on(arm, time, &path, &self.hint)?;
        self.hint = hint;
        let on_path = time >= self.residual_end();
        let at_end = path.s >= self.path().length() - 1e-10 && path.velocity.abs() < 1e-8;
        Ok(SetPoint {
            joints,
            path,
            on_path,
            done: on_path && at_end,
        })
    }
}
