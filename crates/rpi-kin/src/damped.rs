//! Inverse kinematics of any chain by damped least squares, with a bounded number of iterations.
//!
//! For arms without a closed form. Each iteration solves `(J Jᵀ + λ² I) y = e` for the error `e` of the pose and moves
//! the joints by `Jᵀ y`, within their ranges. The damping λ² grows with the square of the error (Levenberg-Marquardt), so
//! that an iteration is safe far from the pose and near singularities, and converges quadratically near the pose.
//!
//! Sources: Wampler, Manipulator inverse kinematic solutions based on vector formulations and damped least-squares
//! methods, IEEE SMC 16(1), 1986; Sugihara, Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt
//! method, IEEE T-RO 27(5), 2011.

use crate::{
    AxisLimits, Chain, InverseKinematicsError, MAX_AXES, Pose, Range, Transform, jacobian,
};
use nalgebra::{Matrix6, SMatrix, SVector, UnitQuaternion, Vector6};

/// Inverse kinematics of one chain by damped least squares: iterations from a hint, with a bounded number of steps.
#[derive(Clone, Copy, Debug)]
pub struct DampedLeastSquares<'a> {
    /// Kinematic chain of the arm, of at most [`MAX_AXES`] joints.
    pub chain: &'a Chain,
    /// Limits of the joints, of which only the ranges are used: rad, or m for a prismatic joint.
    pub limits: &'a [AxisLimits],
    /// Index of the joint that keeps its value in the hint, counted from 0; `None` if all joints move. For a redundant
    /// arm, a held joint makes the solution depend on the pose and on this joint's value only, not on the rest of the
    /// hint.
    pub held_axis: Option<usize>,
}

type Joints = [f64; MAX_AXES];

/// Maximum number of iterations from one start.
pub const ITERATIONS: usize = 32;

/// Maximum number of starts of [`DampedLeastSquares::anywhere`]: the hint, and joint values spread over the ranges.
pub const STARTS: usize = 48;

/// Maximum error of a solution: distance divided by the length of the chain, and angle in rad.
const TOLERANCE: f64 = 1e-10;

/// Error of the pose, distance divided by the length of the chain and angle in rad, below which a further iteration
/// would only change rounding errors.
const ROUNDING: f64 = 1e-14;

/// Damping λ² of the least squares, as a multiple of the square of the error of the pose (no unit).
const DAMPING: f64 = 0.1;
/// Minimum of the damping λ² of the least squares. It keeps the equations solvable at a singularity.
const LEAST_DAMPING: f64 = 1e-10;

/// Maximum change of a joint in one iteration, rad or m.
const LONGEST_STEP: f64 = 0.8;

impl DampedLeastSquares<'_> {
    /// Returns the joint values (rad, m) for a pose of the flange in the base frame to which the iterations from `hint`
    /// (rad, m) converge: usually the solution nearest to the hint. At most [`ITERATIONS`] iterations, about 1 µs each.
    ///
    /// # Errors
    /// [`InverseKinematicsError::NotFinite`] if a number of the pose or of the hint is not finite, or hint or limits
    /// have too few entries; [`InverseKinematicsError::OutOfReach`] if the iterations do not converge to the pose.
    pub fn near(&self, flange: &Pose, hint: &[f64]) -> Result<Joints, InverseKinematicsError> {
        let hint = self.checked(flange, hint)?;
        let target = crate::to_transform(flange);
        self.iterated(&target, flange, hint)
            .ok_or(InverseKinematicsError::OutOfReach)
    }

    /// Returns the joint values (rad, m) for a pose of the flange in the base frame. If the iterations from `hint`
    /// (rad, m) do not converge to the pose, they start again from joint values spread over the ranges. Not for the
    /// cycle: up to [`STARTS`] times the work of [`near`](Self::near).
    ///
    /// # Errors
    /// [`InverseKinematicsError::NotFinite`] if a number of the pose or of the hint is not finite, or hint or limits
    /// have too few entries; [`InverseKinematicsError::OutOfReach`] if no start leads to the pose.
    pub fn anywhere(&self, flange: &Pose, hint: &[f64]) -> Result<Joints, InverseKinematicsError> {
        let hint = self.checked(flange, hint)?;
        let target = crate::to_transform(flange);
        let starts = (0..STARTS).map(|number| self.start(number, &hint));
        starts
            .filter_map(|start| self.iterated(&target, flange, start))
            .next()
            .ok_or(InverseKinematicsError::OutOfReach)
    }

    fn checked(&self, flange: &Pose, hint: &[f64]) -> Result<Joints, InverseKinematicsError> {
        let axes = self.chain.axes();
        let is_complete = axes <= MAX_AXES && hint.len() >= axes && self.limits.len() >= axes;
        let is_finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let pose = flange.translation.vector.as_slice();
        let rotation = flange.rotation.coords.as_slice();
        if !(is_complete && is_finite(pose) && is_finite(rotation) && is_finite(&hint[..axes])) {
            return Err(InverseKinematicsError::NotFinite);
        }
        let mut joints = [0.0; MAX_AXES];
        joints[..axes].copy_from_slice(&hint[..axes]);
        Ok(self.clamped(joints))
    }

    /// Returns the joint values (rad, m) at which the search with index `number` starts: the hint for 0, else a point
    /// of an additive recurrence with low discrepancy (Roberts, 2018).
    fn start(&self, number: usize, hint: &Joints) -> Joints {
        /// Base of the low-discrepancy sequence for seven joints: the root of x^8 = x + 1 (Roberts, 2018).
        const GENERATOR: f64 = 1.096_981_557_798_56;
        let mut joints = *hint;
        let (mut share, count) = (1.0, number as f64);
        for axis in (0..self.chain.axes()).filter(|_| number > 0) {
            share /= GENERATOR;
            let part = 0.5 + count * share;
            if self.held_axis != Some(axis) {
                let Range { lower, upper } = self.searched(axis);
                joints[axis] = lower + (upper - lower) * (part - libm::floor(part));
            }
        }
        joints
    }

    /// Returns the part of a joint's range in which searches start: at most one turn, from -π to π.
    fn searched(&self, axis: usize) -> Range {
        let range = self.limits[axis].position;
        Range {
            lower: range.lower.max(-crate::angle::HALF_TURN),
            upper: range.upper.min(crate::angle::HALF_TURN),
        }
    }

    fn clamped(&self, mut joints: Joints) -> Joints {
        let free = |axis: &usize| self.held_axis != Some(*axis);
        for axis in (0..self.chain.axes()).filter(free) {
            let range = self.limits[axis].position;
            joints[axis] = joints[axis].max(range.lower).min(range.upper);
        }
        joints
    }

    /// Returns the joint values (rad, m) to which the iterations from `start` converge; `None` if their flange does not
    /// reach the pose. `target` and `goal` are the same pose; `start` is a set of joint values.
    fn iterated(&self, target: &Transform, goal: &Pose, start: Joints) -> Option<Joints> {
        let reach = self.reach();
        let (mut best, mut least) = (start, f64::INFINITY);
        let mut joints = start;
        for _ in 0..ITERATIONS {
            let error = self.error(target, goal, &joints, reach);
            let size = error.norm();
            if size < least {
                (best, least) = (joints, size);
            } else if least < TOLERANCE {
                break;
            }
            if size < ROUNDING {
                break;
            }
            joints = self.advanced(&joints, &error, reach)?;
        }
        (least < TOLERANCE).then_some(best)
    }

    /// Returns the length by which distances are divided to compare them with angles: the sum of the lengths of the
    /// chain, at least 0.1 m.
    fn reach(&self) -> f64 {
        self.chain.length().max(0.1)
    }

    /// Returns the error of the flange at `joints` against the pose: the distance in the base frame divided by `reach`
    /// (m), then the rotation vector (rad). `target` and `goal` are the same pose.
    fn error(&self, target: &Transform, goal: &Pose, joints: &Joints, reach: f64) -> Vector6<f64> {
        let here = self.chain.flange_pose(&joints[..self.chain.axes()]);
        let way = (target.translation.vector - here.translation.vector) / reach;
        let rotation = UnitQuaternion::from_rotation_matrix(&here.rotation);
        let turn = (goal.rotation * rotation.inverse()).scaled_axis();
        Vector6::new(way.x, way.y, way.z, turn.x, turn.y, turn.z)
    }

    /// Returns the joint values after one iteration. A joint at an end of its range that would leave the range stays
    /// there. `None` if a number is not finite.
    fn advanced(&self, joints: &Joints, error: &Vector6<f64>, reach: f64) -> Option<Joints> {
        let mut jacobian = self.jacobian(joints, reach);
        let mut step = damped_step(&jacobian, error)?;
        let mut blocked = false;
        for axis in 0..self.chain.axes() {
            let (range, moved) = (self.limits[axis].position, joints[axis] + step[axis]);
            let is_at_end = joints[axis] <= range.lower && moved < range.lower
                || joints[axis] >= range.upper && moved > range.upper;
            if is_at_end {
                jacobian.column_mut(axis).fill(0.0);
                blocked = true;
            }
        }
        if blocked {
            step = damped_step(&jacobian, error)?;
        }
        let scale = (LONGEST_STEP / step.amax()).min(1.0);
        let next = core::array::from_fn(|axis| joints[axis] + scale * step[axis]);
        Some(self.clamped(next))
    }

    fn jacobian(&self, joints: &Joints, reach: f64) -> SMatrix<f64, 6, MAX_AXES> {
        let here = self.chain.flange_pose(&joints[..self.chain.axes()]);
        let mut jacobian = jacobian::geometric(self.chain, joints, &here.translation.vector);
        jacobian.fixed_rows_mut::<3>(0).scale_mut(1.0 / reach);
        if let Some(axis) = self.held_axis.filter(|axis| *axis < MAX_AXES) {
            jacobian.column_mut(axis).fill(0.0);
        }
        jacobian
    }
}

/// Returns the change of the joint values in one iteration of damped least squares; `None` if a number is not finite.
fn damped_step(
    jacobian: &SMatrix<f64, 6, MAX_AXES>,
    error: &Vector6<f64>,
) -> Option<SVector<f64, MAX_AXES>> {
    let damping = DAMPING * error.norm_squared() + LEAST_DAMPING;
    let squared = jacobian * jacobian.transpose() + Matrix6::identity() * damping;
    Some(jacobian.transpose() * squared.cholesky()?.solve(error))
}
