//! Straight line of the tool.

use super::orientation::EvenTurning;
use nalgebra::{Translation3, Vector3};
use rpi_kin::Pose;
use rpi_kin::rotation::angle_between;

/// Distance (m) that counts as much as turning the tool by one radian, when the length of a path is determined: on a
/// short distance, the turning decides.
pub const TURNING_LENGTH: f64 = 0.25;

/// Straight line of the tool, along which the tool turns evenly. The path parameter is the length of the line (m), or a
/// longer one if the tool turns far on a short line.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    start: Vector3<f64>,
    /// Displacement per unit of the path parameter, in the base frame: a unit vector, or shorter if the turning decides
    /// the length.
    direction: Vector3<f64>,
    turning: EvenTurning,
    length: f64,
}

impl Line {
    /// Creates the line from one pose of the tool to another, both in the base frame.
    #[must_use]
    pub fn new(from: &Pose, to: &Pose) -> Self {
        let way = to.translation.vector - from.translation.vector;
        let turn = angle_between(&from.rotation, &to.rotation);
        let length = libm::sqrt(way.norm_squared()).max(turn * TURNING_LENGTH);
        Self {
            start: from.translation.vector,
            direction: if length > 0.0 {
                way / length
            } else {
                Vector3::zeros()
            },
            turning: EvenTurning::new(&from.rotation, &to.rotation, length),
            length,
        }
    }

    /// Returns the maximum value of the path parameter, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Returns the distance that the tool travels, m. It equals the length of the path parameter, or is shorter if the
    /// turning decides.
    #[must_use]
    pub fn way(&self) -> f64 {
        libm::sqrt(self.direction.norm_squared()) * self.length
    }

    /// Returns the displacement per unit of the path parameter, in the base frame: a unit vector, or shorter if the
    /// turning decides the length.
    #[must_use]
    pub fn direction(&self) -> Vector3<f64> {
        self.direction
    }

    /// Returns true if the path parameter of the line is the distance travelled in m, and not a measure of the turning.
    #[must_use]
    pub fn is_by_length(&self) -> bool {
        (self.direction.norm_squared() - 1.0).abs() < 1e-9
    }

    /// Returns the part of the line between two values of its path parameter (m).
    #[must_use]
    pub fn section(&self, from: f64, to: f64) -> Self {
        Self {
            start: self.start + self.direction * from,
            turning: self.turning.starting_at(from),
            length: to - from,
            ..*self
        }
    }

    /// Returns the pose of the tool in the base frame at the value `s` (m) of the path parameter.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose {
        let position = self.start + self.direction * s;
        Pose::from_parts(Translation3::from(position), self.turning.at(s))
    }
}
