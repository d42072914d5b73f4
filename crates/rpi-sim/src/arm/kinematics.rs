//! Poses, velocities and forces at the arm's tool, and the kinematic functions of the arm.
//!
//! All poses are those of the tool in the arm's base frame. The pose of the base in the cell does not matter here.

use super::Arm;
use super::limits::AxisState;
use crate::cell::ArmSpec;
use nalgebra::{SMatrix, Vector6};
use rpi_kin::model::InverseKinematics;
use rpi_kin::{ArmModel, AxisLimits, InverseKinematicsError, MAX_AXES, Pose, jacobian};

/// A value for each axis, with the length of the longest arm; unused entries are zero.
pub(super) type PerAxis = [f64; MAX_AXES];

/// Kinematics of an arm with a tool, in joint positions and poses of the tool.
#[derive(Clone, Debug)]
pub(super) struct ArmKinematics {
    model: &'static ArmModel,
    /// Pose of the tool in the flange frame.
    tool: Pose,
    /// Number of axes.
    axes: usize,
    /// Limits of the axes, for the inverse kinematics.
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

    /// Forward kinematics: pose of the tool in the base frame for joint positions in rad.
    pub(super) fn forward(&self, joints: &[f64]) -> Pose {
        self.model.forward(joints) * self.tool
    }

    /// Inverse kinematics: joint positions for a tool pose, near `hint`, with the arm angle of `elbow`.
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

    /// Velocity of the tool for joint positions and velocities: linear (m/s), then angular (rad/s).
    pub(super) fn twist(&self, joints: &PerAxis, velocities: &PerAxis) -> Vector6<f64> {
        self.jacobian(joints) * SMatrix::<f64, MAX_AXES, 1>::from(*velocities)
    }

    /// Acceleration of the tool for joint positions, velocities and accelerations: linear (m/s²), then angular (rad/s²).
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

    /// Limits of the axes.
    pub(super) fn limits(&self) -> &[AxisLimits] {
        &self.limits[..self.axes]
    }

    /// Joint torques, in N m, for a force and torque at the tool.
    pub(super) fn torques(&self, joints: &PerAxis, wrench: &Vector6<f64>) -> PerAxis {
        (self.jacobian(joints).transpose() * wrench).into()
    }

    fn jacobian(&self, joints: &PerAxis) -> SMatrix<f64, 6, MAX_AXES> {
        let tool = self.forward(&joints[..self.axes]).translation.vector;
        jacobian::geometric(&self.model.chain, joints, &tool)
    }

    /// Rate of change of the arm angle for joint positions and velocities, in rad/s; 0 for an arm without redundancy.
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
    /// Commanded state of one axis; at rest at 0 if the axis does not exist.
    pub(super) fn commanded_at(&self, axis: usize) -> AxisState {
        self.axes
            .get(axis)
            .map_or(AxisState::default(), |axis| axis.commanded)
    }

    /// Measured state of one axis; at rest at 0 if the axis does not exist.
    pub(super) fn measured_at(&self, axis: usize) -> AxisState {
        self.sensing
            .history
            .read()
            .get(axis)
            .copied()
            .unwrap_or_default()
    }

    /// One component of the commanded states of all axes.
    pub(super) fn commanded(&self, part: fn(&AxisState) -> f64) -> PerAxis {
        let mut all = [0.0; MAX_AXES];
        all.iter_mut()
            .zip(&self.axes)
            .for_each(|(slot, axis)| *slot = part(&axis.commanded));
        all
    }

    /// One component of the measured states of all axes.
    pub(super) fn measured(&self, part: fn(&AxisState) -> f64) -> PerAxis {
        core::array::from_fn(|axis| part(&self.sensing.history.read()[axis]))
    }

    /// Joint torques caused by a contact at the tool, in N m.
    pub(super) fn external_torques(&self) -> PerAxis {
        self.kinematics.torques(
            &self.measured(|state| state.position),
            &self.faults.effects.contact,
        )
    }

    /// Commanded joint positions, in rad.
    pub fn joints(&self) -> impl Iterator<Item = f64> + '_ {
        self.axes.iter().map(|axis| axis.commanded.position)
    }

    /// Commanded pose of the tool in the base frame.
    #[must_use]
    pub fn pose(&self) -> Pose {
        let joints = self.commanded(|state| state.position);
        self.kinematics.forward(&joints[..self.axes()])
    }
}
