//! Rotations and their rotation vectors.
//!
//! nalgebra has the same functions, but with the trigonometry of another library, whose bits C does not have.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Returns the rotation around `vector` by its length, rad.
#[must_use]
pub fn from_rotation_vector(vector: Vector3<f64>) -> UnitQuaternion<f64> {
    let half = vector * 0.5;
    let size = libm::sqrt(half.norm_squared());
    if size <= f64::EPSILON {
        return UnitQuaternion::identity();
    }
    let (sin, cos) = rpi_math::sincos(size);
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, half * (sin / size)))
}

/// Returns the rotation vector of a rotation, the shorter way round: its length, from 0 to π, is the angle, rad.
#[must_use]
pub fn rotation_vector(rotation: &UnitQuaternion<f64>) -> Vector3<f64> {
    let size = libm::sqrt(rotation.imag().norm_squared());
    if size == 0.0 {
        return Vector3::zeros();
    }
    // Both signs of a quaternion are the same rotation.
    let sign = if rotation.w >= 0.0 { 1.0 } else { -1.0 };
    rotation.imag() * (sign * angle(rotation) / size)
}

/// Returns the angle of a rotation, rad, from 0 to π.
#[must_use]
pub fn angle(rotation: &UnitQuaternion<f64>) -> f64 {
    let size = libm::sqrt(rotation.imag().norm_squared());
    2.0 * rpi_math::atan2(size, libm::fabs(rotation.w))
}

/// Returns the angle between two orientations, rad, from 0 to π.
#[must_use]
pub fn angle_between(from: &UnitQuaternion<f64>, to: &UnitQuaternion<f64>) -> f64 {
    angle(&(to * from.inverse()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_vector_is_that_of_its_rotation() {
        for k in 0..200 {
            let angle = 0.015_707 * f64::from(k);
            let vector = Vector3::new(2.0, -1.0, 2.0) * (angle / 3.0);
            let rotation = from_rotation_vector(vector);
            assert!((rotation.norm() - 1.0).abs() < 1e-15);
            assert!((rotation_vector(&rotation) - vector).norm() < 1e-14);
            let opposite = UnitQuaternion::new_unchecked(-rotation.into_inner());
            assert!((rotation_vector(&opposite) - vector).norm() < 1e-14);
            let start = from_rotation_vector(Vector3::new(0.3, 0.4, 0.5));
            assert!((angle_between(&start, &(rotation * start)) - angle).abs() < 1e-14);
        }
    }

    #[test]
    fn no_rotation_has_the_vector_zero() {
        assert_eq!(
            from_rotation_vector(Vector3::zeros()),
            UnitQuaternion::identity()
        );
        assert_eq!(
            rotation_vector(&UnitQuaternion::identity()),
            Vector3::zeros()
        );
    }
}
