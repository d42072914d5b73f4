//! Kinematics of serial arms: chains by Denavit-Hartenberg tables, forward and analytic inverse; motion of an axis within
//! its bounds.
//!
//! Everything here is a pure function of its arguments: no allocation, no panic, bounded time, the same bits on every
//! machine (all transcendental functions are `libm`'s). This crate must not know devices, cycles, files or clocks.
//!
//! # Conventions
//!
//! - SI units: metres, radians, seconds. Joint values in the vendor's sense of rotation.
//! - A [`Transform`] `b_T_f` maps coordinates in `f` to coordinates in `b`; "the flange in the base" is `base_T_flange`.
//! - Rotations that cross the crate's border as poses ([`Pose`]) are unit quaternions `w + xi + yj + zk` (Hamilton),
//!   stored by nalgebra in the order x, y, z, w. `q` and `-q` are the same rotation; neither sign is preferred.
//! - The base frame stands in the mounting face of the arm, z along axis 1. The flange frame stands in the flange face,
//!   z along the last axis. With all joints at zero a KUKA LBR stands upright and its flange frame is parallel to its base.
//! - "No solution" is said by a type inside the crate ([`NoSolution`]) and by NaN joints at its edge
//!   ([`ArmModel::inverse_or_nan`]), which is how nets of the reference system hand it on to the arm.
#![no_std]

pub mod angle;
mod ball;
pub mod chain;
pub mod jacobian;
pub mod limits;
pub mod model;
pub mod models;
pub mod opw;
pub mod reach;
pub mod six;
pub mod srs;
pub mod stop;
pub mod ur;

pub use chain::{Chain, Convention, Link};
pub use limits::{AxisLimits, Range};
pub use model::{ArmModel, Inverse, MAX_AXES};

/// A rigid transform with a rotation matrix: what chains multiply.
pub type Transform = nalgebra::IsometryMatrix3<f64>;

/// A rigid transform with a unit quaternion: what crosses the border.
pub type Pose = nalgebra::Isometry3<f64>;

/// Why an inverse has no joints to offer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSolution {
    /// The wrist is farther from the shoulder, or nearer to it, than the arm can be bent.
    OutOfReach,
    /// The arm reaches the pose, but only with a joint outside its range.
    OutOfLimits,
    /// A coordinate of the pose or a hint joint is NaN or infinite, or there are not as many hints as axes.
    NotFinite,
    /// No closed form is known for this arm.
    NoClosedForm,
}

/// The pose with the same rotation as a quaternion.
#[must_use]
pub fn pose_of(transform: &Transform) -> Pose {
    Pose::from_parts(
        transform.translation,
        nalgebra::UnitQuaternion::from_rotation_matrix(&transform.rotation),
    )
}

/// The transform with the same rotation as a matrix.
#[must_use]
pub fn transform_of(pose: &Pose) -> Transform {
    Transform::from_parts(pose.translation, pose.rotation.to_rotation_matrix())
}
