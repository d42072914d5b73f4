//! The arm's poses, velocities and forces at its tool, and the functions that it offers.
//!
//! Everything is the tool in the arm's base, in base coordinates; where the base stands in the cell does not matter here.

use super::Arm;
use super::guard::State;
use nalgebra::{SMatrix, Vector6};
use rpi_kin::model::Inverse;
use rpi_kin::{MAX_AXES, NoSolution, Pose, jacobian};

/// A value for each axis, as long as the longest arm; unused entries are zero.
pub(super) type PerAxis = [f64; MAX_AXES];

impl Arm {
    /// The tool's pose for joint positions in rad.
    #[must_use]
    pub fn forward(&self, joints: &[f64]) -> Pose {
        self.model.forward(joints) * self.tool
    }

    /// The joints that bring the tool to a pose, near to `hint`, the elbow as in `elbow`.
    pub(super) fn inverse(
        &self,
        pose: &Pose,
        hint: &[f64],
        elbow: &[f64],
    ) -> Result<PerAxis, NoSolution> {
        let flange = pose * self.tool.inverse();
        self.model
            .inverse_with_elbow(&flange, hint, elbow, &self.limits[..self.axes()])
    }

    /// The tool's velocity for joint positions and velocities: linear (m/s), then angular (rad/s).
    pub(super) fn twist(&self, joints: &PerAxis, velocities: &PerAxis) -> Vector6<f64> {
        self.jacobian(joints) * SMatrix::<f64, MAX_AXES, 1>::from(*velocities)
    }

    /// What a force and a torque at the tool mean for each joint, in N m.
    pub(super) fn torques(&self, joints: &PerAxis, wrench: &Vector6<f64>) -> PerAxis {
        (self.jacobian(joints).transpose() * wrench).into()
    }

    fn jacobian(&self, joints: &PerAxis) -> SMatrix<f64, 6, MAX_AXES> {
        let tool = self.forward(&joints[..self.axes()]).translation.vector;
        jacobian::geometric(&self.model.chain, joints, &tool)
    }

    /// How fast the arm angle changes for joint positions and velocities, in rad/s; 0 for an arm without one.
    pub(super) fn elbow_velocity(&self, joints: &PerAxis, velocities: &PerAxis) -> f64 {
        /// Half the time over which the angle is compared, in s: its square is the error.
        const HALF: f64 = 1e-5;
        let Inverse::Srs(geometry) = self.model.inverse else {
            return 0.0;
        };
        let angle = |time: f64| {
            let moved: PerAxis =
                core::array::from_fn(|axis| joints[axis] + time * velocities[axis]);
            geometry.arm_angle(&moved)
        };
        rpi_kin::angle::wrap(angle(HALF) - angle(-HALF)) / (2.0 * HALF)
    }

    /// The state of one axis as it was last commanded; at rest at 0 if there is no such axis.
    pub(super) fn commanded_at(&self, axis: usize) -> State {
        self.axes
            .get(axis)
            .map_or(State::default(), |axis| axis.commanded)
    }

    /// The same as measured.
    pub(super) fn measured_at(&self, axis: usize) -> State {
        self.history.read().get(axis).copied().unwrap_or_default()
    }

    /// The states of all axes as they were last commanded, one part of each.
    pub(super) fn commanded(&self, part: fn(&State) -> f64) -> PerAxis {
        let mut all = [0.0; MAX_AXES];
        all.iter_mut()
            .zip(&self.axes)
            .for_each(|(slot, axis)| *slot = part(&axis.commanded));
        all
    }

    /// The same as measured.
    pub(super) fn measured(&self, part: fn(&State) -> f64) -> PerAxis {
        core::array::from_fn(|axis| part(&self.history.read()[axis]))
    }

    /// What the joints feel of a contact at the tool, in N m.
    pub(super) fn external_torques(&self) -> PerAxis {
        self.torques(&self.measured(|state| state.position), &self.state.contact)
    }

    /// The joint positions as they were last commanded, in rad.
    pub fn joints(&self) -> impl Iterator<Item = f64> + '_ {
        self.axes.iter().map(|axis| axis.commanded.position)
    }

    /// The tool's pose as it was last commanded.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.forward(&self.commanded(|state| state.position)[..self.axes()])
    }
}
