//! Even turning from one orientation to another.

use nalgebra::{UnitQuaternion, Vector3};
use rpi_kin::rotation::{from_rotation_vector, rotation_vector};

/// Even turning of the tool: about a fixed axis, in proportion to the path parameter (spherical linear interpolation).
#[derive(Clone, Copy, Debug)]
pub struct EvenTurning {
    start: UnitQuaternion<f64>,
    /// Rotation vector per unit of the path parameter, in base coordinates; rad/m.
    rate: Vector3<f64>,
}

impl EvenTurning {
    /// Creates the turning from `from` to `to`, the shorter way round, while the path parameter grows by `length` (m).
    #[must_use]
    pub fn new(from: &UnitQuaternion<f64>, to: &UnitQuaternion<f64>, length: f64) -> Self {
        Self::by(from, Self::vector_between(from, to), length)
    }

    /// Creates the turning from `from` by the rotation vector `turn` (rad, base frame; any number of turns) while the
    /// path parameter grows by `length` (m).
    #[must_use]
    pub fn by(from: &UnitQuaternion<f64>, turn: Vector3<f64>, length: f64) -> Self {
        Self {
            start: *from,
            rate: if length > 0.0 {
                turn / length
            } else {
                Vector3::zeros()
            },
        }
    }

    /// Returns the rotation vector from `from` to `to`, the shorter way round, in base coordinates; rad.
    #[must_use]
    pub fn vector_between(from: &UnitQuaternion<f64>, to: &UnitQuaternion<f64>) -> Vector3<f64> {
        rotation_vector(&(to * from.inverse()))
    }

    /// Returns the same turning, with its path parameter counted from the value `s` (m) on.
    #[must_use]
    pub fn starting_at(&self, s: f64) -> Self {
        Self {
            start: self.at(s),
            rate: self.rate,
        }
    }

    /// Returns the orientation in the base frame at the value `s` (m) of the path parameter.
    #[must_use]
    pub fn at(&self, s: f64) -> UnitQuaternion<f64> {
        from_rotation_vector(self.rate * s) * self.start
    }
}
