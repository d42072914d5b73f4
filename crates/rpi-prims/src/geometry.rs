//! Rotations and rigid motions: Euler angles, axis and angle, exponential and logarithm.
//!
//! Trigonometric functions are those of `rpi-math`, so that results are bit-identical on every machine. Formulas: Lynch and
//! Park, Modern Robotics (2017), chapter 3.

use crate::value_types::{Rotation, Vector};
use core::f64::consts::FRAC_PI_2;
use nalgebra::{Quaternion, UnitQuaternion};

/// Returns the rotation by `a` about z, then by `b` about the new y, then by `c` about the new x (all in rad).
#[must_use]
pub fn from_abc(a: f64, b: f64, c: f64) -> Rotation {
    let half = |angle: f64| (rpi_math::sin(angle / 2.0), rpi_math::cos(angle / 2.0));
    let ((sa, ca), (sb, cb), (sc, cc)) = (half(a), half(b), half(c));
    UnitQuaternion::new_unchecked(Quaternion::new(
        ca * cb * cc + sa * sb * sc,
        ca * cb * sc - sa * sb * cc,
        ca * sb * cc + sa * cb * sc,
        sa * cb * cc - ca * sb * sc,
    ))
}

/// Returns the angles `a`, `b`, `c` (rad) of [`from_abc`], with `b` from -π/2 to π/2. If `b` is within 1e-12 of a limit
/// (gimbal lock), `a` and `c` rotate about the same axis; `c` is then 0.
#[must_use]
pub fn to_abc(rotation: Rotation) -> (f64, f64, f64) {
    let m = matrix(rotation);
    let b = rpi_math::atan2(-m[2][0], libm::sqrt(m[0][0] * m[0][0] + m[1][0] * m[1][0]));
    if libm::fabs(b) > FRAC_PI_2 - 1e-12 {
        return (rpi_math::atan2(-m[0][1], m[1][1]), b, 0.0);
    }
    let (a, c) = (
        rpi_math::atan2(m[1][0], m[0][0]),
        rpi_math::atan2(m[2][1], m[2][2]),
    );
    (a, b, c)
}

/// Returns the rotation matrix of a rotation, row by row.
#[must_use]
pub fn matrix(rotation: Rotation) -> [[f64; 3]; 3] {
    let m = rotation.to_rotation_matrix();
    [0, 1, 2].map(|r| [0, 1, 2].map(|c| m[(r, c)]))
}

/// Returns the rotation with the rotation vector `vector`: axis times angle (rad).
#[must_use]
pub fn exp(vector: Vector) -> Rotation {
    let angle = norm(vector);
    let axis = if angle > 0.0 { vector / angle } else { vector };
    let (s, c) = (rpi_math::sin(angle / 2.0), rpi_math::cos(angle / 2.0));
    UnitQuaternion::new_unchecked(Quaternion::from_parts(c, axis * s))
}

/// Returns the unit axis and the angle (rad, 0 to π) of a rotation. The axis is x for the identity.
#[must_use]
pub fn to_axis_angle(rotation: Rotation) -> (Vector, f64) {
    let sign = if rotation.w < 0.0 { -1.0 } else { 1.0 };
    let v = Vector::new(rotation.i, rotation.j, rotation.k) * sign;
    let s = norm(v);
    if s == 0.0 {
        return (Vector::x(), 0.0);
    }
    (v / s, 2.0 * rpi_math::atan2(s, rotation.w * sign))
}

/// Returns the rotation vector of a rotation: axis times angle (rad, 0 to π). Inverse of [`exp`].
#[must_use]
pub fn log(rotation: Rotation) -> Vector {
    let (axis, angle) = to_axis_angle(rotation);
    axis * angle
}

/// Interpolates between two rotations along the shortest arc: `from` for amount 0, `to` for amount 1.
#[must_use]
pub fn slerp(from: Rotation, to: Rotation, amount: f64) -> Rotation {
    from * exp(log(from.inverse() * to) * amount)
}

/// Returns true if two rotations are equal. The quaternions `q` and `-q` stand for the same rotation.
pub fn is_same(a: Rotation, b: Rotation) -> bool {
    a.coords == b.coords || a.coords == -b.coords
}

/// Returns the length of a vector.
#[must_use]
pub fn norm(v: Vector) -> f64 {
    libm::sqrt(v.dot(&v))
}

/// Returns the rotation of a quaternion after normalisation; the identity for the zero quaternion.
#[must_use]
pub fn from_quaternion(x: f64, y: f64, z: f64, w: f64) -> Rotation {
    let length = libm::sqrt(x * x + y * y + z * z + w * w);
    if length > 0.0 {
        let q = Quaternion::new(w, x, y, z) / length;
        return UnitQuaternion::new_unchecked(q);
    }
    Rotation::identity()
}
