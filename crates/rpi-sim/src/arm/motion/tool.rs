//! Frame that moves along the path of a motion: the arm's own tool, or one that the program chooses.

use super::Motion;
use super::call::Request;
use crate::arm::kinematics::PerAxis;
use crate::arm::path_fault::PathFault;
use crate::error_code::ErrorCode;
use rpi_kin::Pose;

/// Tools of an arm, as poses in the flange frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tools {
    /// The arm's own tool.
    own: Pose,
    /// Tool that the program has chosen for its motion, also if the arm still follows another motion, or the motion was
    /// rejected.
    chosen: Pose,
}

impl Tools {
    pub(super) fn new(own: Pose) -> Self {
        Self { own, chosen: own }
    }

    /// Takes over the tool of a request, given in the frame of the arm's own tool.
    fn choose(&mut self, tool: &Pose) {
        // Without a tool of its own, the motion has exactly that of the arm.
        self.chosen = match *tool == Pose::identity() {
            true => self.own,
            false => self.own * tool,
        };
    }
}

impl Motion {
    /// Makes the tool that the program requests the one of the next motion. The tool of a motion is read at its beginning: a
    /// motion that begins again by itself keeps it.
    ///
    /// # Errors
    /// `NOT_A_NUMBER` if a number of the tool is not finite; then the present motion keeps its tool.
    pub(super) fn choose_tool(&mut self, request: &Request<'_>) -> Result<(), PathFault> {
        if request.motion == 0 {
            self.tools.choose(&request.tool);
        }
        let tool = self.tools.chosen;
        let position = tool.translation.vector;
        let mut numbers = position.iter().chain(tool.rotation.coords.iter());
        if !numbers.all(|number| number.is_finite()) {
            return Err(ErrorCode::NOT_A_NUMBER.into());
        }
        self.set_tool(tool);
        Ok(())
    }

    /// Sets the tool that moves along the path of the next motion, as a pose in the flange frame.
    pub(super) fn set_tool(&mut self, tool: Pose) {
        self.arm.set_tool(tool);
        self.core.set_tool(tool);
    }

    /// Returns the pose in the base frame of the tool that the program has chosen, for joint positions in rad.
    pub(super) fn pose_of_tool(&self, joints: &PerAxis) -> Pose {
        self.arm.flange(joints) * self.tools.chosen
    }
}
