//! A path with the time law and the residuals with which the arm follows it.

use crate::node_table::NodeTable;
use crate::path::Path;
use crate::residual::Residual;
use crate::set_point::{MotionError, SetPoint};
use crate::time_law::HeldBrake;
use crate::tool_residual::ToolResidual;
use crate::{Arm, JointState, Joints};
use rpi_kin::MAX_AXES;

/// Path, time law and residuals of a motion: what gives its set-points as long as nothing new is planned.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    pub table: NodeTable,
    pub residual: Residual,
    /// Residual of the tool, in place of that of the axes.
    pub tool: Option<ToolResidual>,
    pub held: HeldBrake,
    /// Joints of the inverse in the last cycle: the hint of the next one.
    pub hint: Joints,
}

impl Course {
    /// Creates the course of an arm that stands. Allocates.
    pub(crate) fn new(nodes: usize) -> Self {
        Self {
            table: NodeTable::with_capacity(nodes),
            residual: Residual::default(),
            tool: None,
            held: HeldBrake::standing(0.0, 0.0),
            hint: [0.0; MAX_AXES],
        }
    }

    pub(crate) fn path(&self) -> &Path {
        self.table.path()
    }

    /// Stands at the start of the path, without a residual.
    pub(crate) fn stand(&mut self, hint: Joints) {
        self.held = HeldBrake::standing(0.0, 0.0);
        self.residual = Residual::default();
        self.tool = None;
        self.hint = hint;
    }

    /// Returns the time at which the arm is on the path, s.
    pub(crate) fn residual_end(&self) -> f64 {
        let tool = self.tool.map_or(0.0, |tool| tool.end());
        self.residual.end().max(tool)
    }

    /// Returns the joints at a time of the motion, near to `hint`, and those of the inverse: without the residual of the
    /// axes.
    pub(crate) fn joints_at(
        &self,
        arm: &Arm,
        time: f64,
        hint: &Joints,
    ) -> Result<(Joints, Joints), MotionError> {
        let s = self.held.state_at(time).s;
        let tool = self.tool.filter(|tool| time < tool.end());
        let displaced = tool.zip(self.tool_pose(s));
        let on_path = match displaced {
            Some((tool, pose)) => {
                let (pose, angle) = (tool.displaced(&pose, time), tool.arm_angle_at(time));
                let path = self.table.joint_path();
                path.displaced_joints(arm, s, &pose, angle, hint)
                    .ok_or(MotionError::NotFinite)?
            }
            None => self.table.joints_at(arm, s, hint)?,
        };
        let mut joints = on_path;
        self.residual.add_to(&mut joints, time);
        Ok((joints, on_path))
    }

    fn tool_pose(&self, s: f64) -> Option<rpi_kin::Pose> {
        match self.path() {
            Path::Tool(path) => Some(path.pose(s)),
            Path::Joints(_) => None,
        }
    }

    /// Returns the set-point of a time of the motion.
    pub(crate) fn set_point(&mut self, arm: &Arm, time: f64) -> Result<SetPoint, MotionError> {
        let path = self.held.state_at(time);
        let (joints, hint) = self.joints_at(arm, time, &self.hint)?;
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

/// Returns the state on the parabola through the last set-points, `period` seconds apart.
pub(crate) fn state_of(last: &[Joints; 4], period: f64) -> JointState {
    let [_, b, c, d] = last;
    let velocity = core::array::from_fn(|axis| (d[axis] - c[axis]) / period);
    let acceleration =
        core::array::from_fn(|axis| (d[axis] - 2.0 * c[axis] + b[axis]) / (period * period));
    JointState::from_differences(*d, velocity, acceleration, period)
}
