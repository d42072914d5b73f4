//! The arm as seen by the motion core: model, tool and limits; and the state of all axes.

use crate::Joints;
use nalgebra::Vector3;
use rpi_kin::angle::nearest_turn;
use rpi_kin::state_to_rest::AxisState;
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
    /// Creates an arm from its model, the pose of the tool in the flange frame, and the limits of its axes. Axes
    /// without an entry in `limits` have the limits of the model.
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

    /// Returns the pose of the tool in the flange frame.
    #[must_use]
    pub fn tool(&self) -> Pose {
        self.tool
    }

    /// Sets the pose of the tool in the flange frame.
    pub fn set_tool(&mut self, tool: Pose) {
        self.tool = tool;
        self.tool_inverse = tool.inverse();
    }

    /// Returns the same arm with ranges that are smaller by `margin` (rad) at both ends.
    pub(crate) fn with_margin(&self, margin: f64) -> Self {
        let mut arm = *self;
        for limits in &mut arm.limits[..self.model.axes()] {
            limits.position = limits.position.shrunk(margin);
        }
        arm
    }

    /// Returns the number of axes of the arm.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.model.axes()
    }

    /// Returns the limits of position, velocity, acceleration and jerk, one entry per axis.
    #[must_use]
    pub fn limits(&self) -> &[AxisLimits] {
        &self.limits[..self.axes()]
    }

    /// Returns the pose of the tool in the base frame for joint positions in rad (m for a linear axis).
    #[must_use]
    pub fn forward(&self, joints: &Joints) -> Pose {
        self.flange(joints) * self.tool
    }

    /// Returns the pose of the flange in the base frame for joint positions in rad (m for a linear axis).
    #[must_use]
    pub fn flange(&self, joints: &Joints) -> Pose {
        self.model.forward(&joints[..self.axes()])
    }

    /// Returns the position of the tool in the base frame (m) for joint positions in rad (m for a linear axis).
    #[must_use]
    pub fn tool_position(&self, joints: &Joints) -> Vector3<f64> {
        let flange = self.model.chain.flange_pose(&joints[..self.axes()]);
        flange.translation.vector + flange.rotation * self.tool.translation.vector
    }

    /// Returns the arm angle of a redundant arm at these joint positions (rad): the angle of the elbow about the line
    /// from shoulder to wrist, rad. `None` for other arms.
    #[must_use]
    pub fn arm_angle(&self, joints: &Joints) -> Option<f64> {
        self.model.arm_angle(&joints[..self.axes()])
    }

    /// Returns the arm angle (position of the elbow, rad) of a redundant arm at which axis 3 has the value `third`
    /// (rad) or half a turn more, for a pose of the tool in the base frame. Of several, the one nearest to the arm
    /// angle of the joint positions `hint` is taken, and moved by full turns to the value nearest to `near` (rad).
    /// `None` for other arms, and if there is no such arm angle.
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

    /// Returns the joint positions (rad) for a pose of the tool in the base frame, nearest to `hint` (rad). `arm_angle`
    /// (rad) is the arm angle at which axis 3 has the value `third` (rad); axis 3 gets exactly this value, also where
    /// axes 1 and 3 are in line. The second value of the result is the change of the arm angle that the ranges of the
    /// axes demand, rad.
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

    /// Returns the joint positions (rad) for a pose of the tool in the base frame, nearest to `hint` (rad). A redundant
    /// arm gets the arm angle `arm_angle` (position of the elbow, rad), or the nearest one with joints within the
    /// ranges. The second value of the result is the change of the arm angle, rad.
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

    /// Returns the first axis (from 0) that a pose of the tool in the base frame puts outside of its range, in the
    /// configuration nearest to `hint` (rad) with the arm angle `arm_angle` (rad). `None` if there is none, or if the
    /// pose is out of reach.
    pub(crate) fn axis_out_of_range(
        &self,
        tool: &Pose,
        hint: &Joints,
        arm_angle: f64,
    ) -> Option<usize> {
        let free = self.with_margin(-UNLIMITED);
        let (joints, _) = free.inverse(tool, hint, arm_angle).ok()?;
        (0..self.axes()).find(|axis| !self.limits[*axis].position.contains(joints[*axis]))
    }
}

/// Distance beyond the ends of its range up to which an axis is not limited, rad.
const UNLIMITED: f64 = 4.0 * core::f64::consts::PI;

/// Maximum difference of axis 3 from its intended value that counts as rounding where the upper arm is nearly upright,
/// rad. There, small errors of the pose change axis 3 a lot.
const ROUNDING: f64 = 1e-3;

/// Position, velocity and acceleration of all axes, in rad and s (m and s for a linear axis).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointState {
    /// Positions of all axes, rad.
    pub position: Joints,
    /// Velocities of all axes, rad/s.
    pub velocity: Joints,
    /// Accelerations of all axes, rad/s².
    pub acceleration: Joints,
}

impl JointState {
    /// Creates the state of an arm at rest at these joint positions (rad).
    #[must_use]
    pub fn at_rest(position: Joints) -> Self {
        Self {
            position,
            ..Self::default()
        }
    }

    /// Creates the state of all axes from that of each axis.
    #[must_use]
    pub fn from_axes(axes: &[AxisState; MAX_AXES]) -> Self {
        Self {
            position: axes.map(|axis| axis.position),
            velocity: axes.map(|axis| axis.velocity),
            acceleration: axes.map(|axis| axis.acceleration),
        }
    }

    /// Returns the state of each axis.
    #[must_use]
    pub fn to_axes(&self) -> [AxisState; MAX_AXES] {
        core::array::from_fn(|axis| AxisState {
            position: self.position[axis],
            velocity: self.velocity[axis],
            acceleration: self.acceleration[axis],
        })
    }

    /// Returns true if all positions, velocities and accelerations are finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        let parts = [&self.position, &self.velocity, &self.acceleration];
        parts.into_iter().flatten().all(|value| value.is_finite())
    }

    /// Returns the state on the parabola through the last three set-points. `position` is the last one; `velocity` and
    /// `acceleration` are the first and second backward differences over `period` (s). A backward difference lags
    /// behind the derivative, which is corrected. Bounds that hold for the derivatives of a curve which continues the
    /// parabola hold for the differences, too, because a difference of order k is a weighted mean of the k-th
    /// derivative (Peano kernel).
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
