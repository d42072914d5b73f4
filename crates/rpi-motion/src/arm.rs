//! The arm as seen by the motion core: model, tool and limits; and the state of all axes.

use crate::Joints;
use rpi_kin::angle::nearest_turn;
use rpi_kin::{ArmModel, AxisLimits, InverseKinematicsError, MAX_AXES, Pose};

/// Model of an arm with the tool that it holds and the limits of its axes.
#[derive(Clone, Copy, Debug)]
pub struct Arm {
    model: &'static ArmModel,
    tool: Pose,
    tool_inverse: Pose,
    limits: [AxisLimits; MAX_AXES],
}

impl Arm {
    /// Creates an arm of a model with a tool (the tool frame in the flange frame) and the limits of its axes. Missing
    /// limits are those of the model.
    #[must_use]
    pub fn new(model: &'static ArmModel, tool: Pose, limits: &[AxisLimits]) -> Self {
        let mut own = [AxisLimits::from_radians(0.0, 0.0, 0.0); MAX_AXES];
        for (axis, slot) in own.iter_mut().enumerate().take(model.axes()) {
            let given = limits.get(axis).or_else(|| model.limits.get(axis));
            *slot = given.copied().unwrap_or(*slot);
        }
        Self {
            model,
            tool,
            tool_inverse: tool.inverse(),
            limits: own,
        }
    }

    /// Returns the number of axes.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.model.axes()
    }

    /// Returns the limits of the axes.
    #[must_use]
    pub fn limits(&self) -> &[AxisLimits] {
        &self.limits[..self.axes()]
    }

    /// Returns the pose of the tool in the base frame.
    #[must_use]
    pub fn forward(&self, joints: &Joints) -> Pose {
        self.model.forward(&joints[..self.axes()]) * self.tool
    }

    /// Returns the arm angle of joints of a redundant arm, rad; `None` for other arms.
    #[must_use]
    pub fn arm_angle(&self, joints: &Joints) -> Option<f64> {
        self.model.arm_angle(&joints[..self.axes()])
    }

    /// Returns the arm angle (rad) of a redundant arm for a pose of the tool in the base frame at which axis 3 has the value
    /// `third` (rad) or half a turn more: the one nearest to that of the joints `hint`, moved by full turns to the
    /// value nearest to `near` (rad). `None` for other arms, and where there is none.
    #[must_use]
    pub fn arm_angle_of_third_axis(
        &self,
        tool: &Pose,
        third: f64,
        hint: &Joints,
        near: f64,
    ) -> Option<f64> {
        let flange = tool * self.tool_inverse;
        let angles = self.model.arm_angles_of_third_axis(&flange, third)?;
        let present = self.arm_angle(hint)?;
        let distance = |angle: &f64| libm::fabs(nearest_turn(*angle, present) - present);
        let angles = angles.into_iter().filter(|angle| angle.is_finite());
        let nearest = angles.min_by(|one, other| distance(one).total_cmp(&distance(other)))?;
        Some(nearest_turn(nearest, near))
    }

    /// As [`inverse`](Self::inverse), with the arm angle `arm_angle` (rad) at which axis 3 has the value `third` (rad): it
    /// gets exactly this value, also where axes 1 and 3 are in line.
    ///
    /// # Errors
    /// Any [`InverseKinematicsError`].
    pub fn inverse_with_third_axis(
        &self,
        tool: &Pose,
        hint: &Joints,
        arm_angle: f64,
        third: f64,
    ) -> Result<(Joints, f64), InverseKinematicsError> {
        let (joints, change) = self.inverse(tool, hint, arm_angle)?;
        let is_rounding = change == 0.0 && libm::fabs(joints[2] - third) < ROUNDING;
        let exact = match is_rounding {
            true => self.model.with_third_axis(&joints[..self.axes()], third),
            false => None,
        };
        Ok((exact.unwrap_or(joints), change))
    }

    /// Returns the joints for a pose of the tool in the base frame: those nearest to `hint`, with the arm angle
    /// `arm_angle` (rad) where the arm is redundant, or with the nearest one within the ranges of the axes. The second
    /// value is the change of the arm angle, rad.
    ///
    /// # Errors
    /// Any [`InverseKinematicsError`].
    pub fn inverse(
        &self,
        tool: &Pose,
        hint: &Joints,
        arm_angle: f64,
    ) -> Result<(Joints, f64), InverseKinematicsError> {
        let flange = tool * self.tool_inverse;
        let hint = &hint[..self.axes()];
        self.model
            .inverse_at_arm_angle(&flange, hint, arm_angle, self.limits())
    }
}

/// Greatest difference of axis 3 from its value that counts as rounding next to an upright upper arm, rad.
const ROUNDING: f64 = 1e-3;

/// Position (rad), velocity (rad/s) and acceleration (rad/s²) of all axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointState {
    /// Positions, rad.
    pub position: Joints,
    /// Velocities, rad/s.
    pub velocity: Joints,
    /// Accelerations, rad/s².
    pub acceleration: Joints,
}

impl JointState {
    /// Creates the state of an arm at rest.
    #[must_use]
    pub fn at_rest(position: Joints) -> Self {
        Self {
            position,
            ..Self::default()
        }
    }

    /// Returns whether all positions, velocities and accelerations are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let parts = [&self.position, &self.velocity, &self.acceleration];
        parts.into_iter().flatten().all(|value| value.is_finite())
    }

    /// Returns the state on the parabola through the last three set-points: `position`, with the first and second
    /// backward differences over `period` (s). A backward difference lags behind the derivative; this corrects the lag.
    /// Bounds that hold for the derivatives of a curve which continues the parabola hold for the differences, too,
    /// because a difference of order k is a weighted mean of the k-th derivative (Peano kernel).
    #[must_use]
    pub fn from_differences(
        position: Joints,
        velocity: Joints,
        acceleration: Joints,
        period: f64,
    ) -> Self {
        let corrected =
            core::array::from_fn(|axis| velocity[axis] + period * acceleration[axis] / 2.0);
        Self {
            position,
            velocity: corrected,
            acceleration,
        }
    }
}
