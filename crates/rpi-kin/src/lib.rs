//! Kinematics of serial arms (Denavit-Hartenberg chains, forward kinematics, analytic inverse kinematics) and
//! trajectories of single axes.
//!
//! All functions are pure: no allocation, no panic, bounded time, and bit-identical results on every machine (all
//! transcendental functions are those of `rpi-math`). The crate has no knowledge of devices, cycles, files or clocks.
//!
//! # Conventions
//!
//! - Units are SI: metres, radians, seconds. Joint values have the sense of rotation of the vendor.
//! - A [`Transform`] `b_T_f` maps coordinates in `f` to coordinates in `b`. "The flange in the base" is
//!   `base_T_flange`.
//! - Rotations in the public interface are part of a [`Pose`]: unit quaternions `w + xi + yj + zk` (Hamilton), stored
//!   by nalgebra in the order x, y, z, w. `q` and `-q` are the same rotation; neither sign is preferred.
//! - The base frame lies in the mounting face of the arm, with z along axis 1. The flange frame lies in the flange
//!   face, with z along the last axis. With all joints at zero, a KUKA LBR is upright and its flange frame is parallel
//!   to its base frame.
//! - Inside the crate, "no solution" is the error [`InverseKinematicsError`]. At its interface, it can also be NaN joints
//!   ([`ArmModel::inverse_or_nan`]), which nets of the reference system pass on to the arm.
#![no_std]

pub mod angle;
pub mod chain;
pub mod damped;
pub mod jacobian;
pub mod limits;
pub mod model;
pub mod models;
pub mod opw;
pub mod rotation;
pub mod six_axis;
mod spherical_joint;
pub mod srs;
pub mod state_to_rest;
pub mod stop_profile;
pub mod ur;

pub use chain::{Chain, Convention, Link};
pub use limits::{AxisLimits, Range};
pub use model::{ArmModel, InverseKinematics, MAX_AXES};

/// Rigid transform with a rotation matrix, in m. Kinematic chains compute with this type.
pub type Transform = nalgebra::IsometryMatrix3<f64>;

/// Rigid transform with a unit quaternion, in m. The public interface uses this type.
pub type Pose = nalgebra::Isometry3<f64>;

/// Reason why the inverse kinematics has no joint values for a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InverseKinematicsError {
    /// The pose is too far from the shoulder of the arm, or too near to it, or iterations did not converge to the pose.
    OutOfReach,
    /// The pose is reachable only with a joint outside its range.
    OutOfLimits,
    /// A coordinate of the pose or a joint value of the hint is NaN or infinite, or there are fewer values in the hint
    /// or fewer limits than axes.
    NotFinite,
    /// No inverse kinematics is known for this arm.
    NoClosedForm,
}

impl core::fmt::Display for InverseKinematicsError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            InverseKinematicsError::OutOfReach => "the pose is out of reach",
            InverseKinematicsError::OutOfLimits => {
                "the pose is reachable only with a joint outside its range"
            }
            InverseKinematicsError::NotFinite => "the pose or the hint is incomplete or not finite",
            InverseKinematicsError::NoClosedForm => "this arm has no inverse kinematics",
        })
    }
}

impl core::error::Error for InverseKinematicsError {}

/// Converts a transform to a pose with a quaternion.
#[must_use]
pub fn to_pose(transform: &Transform) -> Pose {
    Pose::from_parts(
        transform.translation,
        nalgebra::UnitQuaternion::from_rotation_matrix(&transform.rotation),
    )
}

/// Converts a pose to a transform with a rotation matrix.
#[must_use]
pub fn to_transform(pose: &Pose) -> Transform {
    Transform::from_parts(pose.translation, pose.rotation.to_rotation_matrix())
}
