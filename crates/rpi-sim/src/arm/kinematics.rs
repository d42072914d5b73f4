//! Poses, velocities and forces at the arm's tool, and the kinematic functions of the arm.
//!
//! All poses are those of the tool in the arm's base frame. The pose of the base in the cell does not matter here.

use super::Arm;
use super::limits::AxisState;
use crate::cell::ArmSpec;
use nalgebra::{SMatrix, Vector6};
use rpi_kin::chain::JointType;
use rpi_kin::model::InverseKinematics;
use rpi_kin::{ArmModel, AxisLimits, InverseKinematicsError, MAX_AXES, Pose, jacobian};

/// One value for each axis, such as a position in rad; entries beyond the axes of the arm are zero.
pub(super) type PerAxis = [f64; MAX_AXES];

/// Kinematics of an arm with its tool: joint positions and poses of the tool in the base frame.
#[derive(Clone, Debug)]
pub(super) struct ArmKinematics {
    model: &'static ArmModel,
    /// Pose of the tool in the flange frame.
    tool: Pose,
    /// Number of axes of the arm.
    axes: usize,
    /// Limits of the axes, of which the inverse kinematics uses the ranges.
    limits: [AxisLimits; MAX_AXES],
}

impl ArmKinematics {
    pub(super) fn new(spec: &ArmSpec) -> Self {
        let mut limits = [AxisLimits::from_radians(0.0, 0.0, 0.0); MAX_AXES];
        limits
            .iter_mut()
            .zip(&spec.limits)
            .for_each(|(slot, own)| *slot = *own);
        Self {
            model: spec.model,
            tool: spec.tool,
            axes: spec.joints.len().min(spec.limits.len()),
            limits,
        }
    }

    /// Returns true if the axis with this index, from 0, is linear.
    pub(super) fn is_linear(&self, axis: usize) -> bool {
        let link = self.model.chain.links.get(axis);
        link.is_some_and(|link| link.joint == JointType::Prismatic)
    }

    /// Returns the pose of the tool in the base frame for joint positions in rad (forward kinematics).
    pub(super) fn forward(&self, joints: &[f64]) -> Pose {
        self.model.forward(joints) * self.tool
    }

    /// Returns the joint positions (rad) for a pose of the tool in the base frame, near to `hint` (rad). A redundant
    /// arm keeps the position of the elbow at the joint positions `elbow` (rad).
    pub(super) fn inverse(
        &self,
        pose: &Pose,
        hint: &[f64],
        elbow: &[f64],
    ) -> Result<PerAxis, InverseKinematicsError> {
        let flange = pose * self.tool.inverse();
        self.model
            .inverse_with_elbow(&flange, hint, elbow, &self.limits[..self.axes])
    }

    /// Returns the velocity of the tool in the base frame for joint positions (rad) and velocities (rad/s): linear
    /// (m/s), then angular (rad/s).
    pub(super) fn twist(&self, joints: &PerAxis, velocities: &PerAxis) -> Vector6<f64> {
        self.jacobian(joints) * SMatrix::<f64, MAX_AXES, 1>::from(*velocities)
    }

    /// Returns the distance of the arm from its nearest singularity at these joint positions (rad), without unit; 0 at a
    /// singularity.
    pub(super) fn distance_to_singularity(&self, joints: &PerAxis) -> f64 {
        let tool = self.forward(&joints[..self.axes]).translation.vector;
        jacobian::distance_to_singularity(&self.model.chain, joints, &tool)
    }

    /// Returns the acceleration of the tool in the base frame for joint positions, velocities and accelerations (rad,
    /// s): linear (m/s²), then angular (rad/s²).
    pub(super) fn acceleration(
        &self,
        joints: &PerAxis,
        velocities: &PerAxis,
        accelerations: &PerAxis,
    ) -> Vector6<f64> {
        let tool = self.forward(&joints[..self.axes]).translation.vector;
        self.jacobian(joints) * SMatrix::<f64, MAX_AXES, 1>::from(*accelerations)
            + jacobian::velocity_product(&self.model.chain, joints, velocities, &tool)
    }

    /// Returns the limits of the axes, one entry per axis.
    pub(super) fn limits(&self) -> &[AxisLimits] {
        &self.limits[..self.axes]
    }

    /// Returns the joint torques (N m) for a force (N) and torque (N m) at the tool, in the base frame. `joints` are
    /// joint positions in rad.
    pub(super) fn torques(&self, joints: &PerAxis, wrench: &Vector6<f64>) -> PerAxis {
        (self.jacobian(joints).transpose() * wrench).into()
    }

    fn jacobian(&self, joints: &PerAxis) -> SMatrix<f64, 6, MAX_AXES> {
        let tool = self.forward(&joints[..self.axes]).translation.vector;
        jacobian::geometric(&self.model.chain, joints, &tool)
    }

    /// Returns the rate of change of the arm angle (angle of the elbow about the line from shoulder to wrist), in
    /// rad/s, for joint positions (rad) and velocities (rad/s); 0 for an arm that is not redundant.
    pub(super) fn elbow_velocity(&self, joints: &PerAxis, velocities: &PerAxis) -> f64 {
        /// Half the interval of the central difference, in s; the error grows with its square.
        const HALF: f64 = 1e-5;
        let InverseKinematics::Srs(geometry) = self.model.inverse else {
            return 0.0;
        };
        let angle = |time: f64| {
            let moved: PerAxis =
                core::array::from_fn(|axis| joints[axis] + time * velocities[axis]);
            geometry.arm_angle(&moved)
        };
        rpi_kin::angle::wrap(angle(HALF) - angle(-HALF)) / (2.0 * HALF)
    }
}

impl Arm {
    /// Returns the commanded state of one axis, counted from 0; a state at rest at 0 if the axis does not exist.
    pub(super) fn commanded_at(&self, axis: usize) -> AxisState {
        self.axes
            .get(axis)
            .map_or(AxisState::default(), |axis| axis.commanded)
    }

    /// Returns the measured state of one axis, counted from 0; a state at rest at 0 if the axis does not exist.
    pub(super) fn measured_at(&self, axis: usize) -> AxisState {
        self.sensing
            .history
            .read()
            .get(axis)
            .copied()
            .unwrap_or_default()
    }

    /// Returns one component of the commanded states of all axes, such as the velocity, chosen by `part`.
    pub(super) fn commanded(&self, part: fn(&AxisState) -> f64) -> PerAxis {
        let mut all = [0.0; MAX_AXES];
        all.iter_mut()
            .zip(&self.axes)
            .for_each(|(slot, axis)| *slot = part(&axis.commanded));
        all
    }

    /// Returns one component of the measured states of all axes, such as the velocity, chosen by `part`.
    pub(super) fn measured(&self, part: fn(&AxisState) -> f64) -> PerAxis {
        core::array::from_fn(|axis| part(&self.sensing.history.read()[axis]))
    }

    /// Returns the joint torques caused by a contact at the tool, in N m.
    pub(super) fn external_torques(&self) -> PerAxis {
        self.kinematics.torques(
            &self.measured(|state| state.position),
            &self.faults.effects.contact,
        )
    }

    /// Returns the commanded joint positions, in rad.
    pub fn joints(&self) -> impl Iterator<Item = f64> + '_ {
        self.axes.iter().map(|axis| axis.commanded.position)
    }

    /// Returns the commanded pose of the tool in the base frame.
    #[must_use]
    pub fn pose(&self) -> Pose {
        let joints = self.commanded(|state| state.position);
        self.kinematics.forward(&joints[..self.axes()])
    }
}
