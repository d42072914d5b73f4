//! Straight line of the tool.

use super::orientation::{EvenTurning, angle_between};
use nalgebra::{Translation3, Vector3};
use rpi_kin::Pose;

/// Length of way that counts as much as one radian of turning, m. It decides the path parameter where the tool turns
/// far on a short way.
pub const TURNING_LENGTH: f64 = 0.25;

/// A straight line with even turning.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    start: Vector3<f64>,
    /// Way per unit of the path parameter: a unit vector, or shorter where the turning decides the length.
    direction: Vector3<f64>,
    turning: EvenTurning,
    length: f64,
}

impl Line {
    /// The line from one pose of the tool to another, in base coordinates.
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

    /// Returns the length, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Returns the pose of the tool in the base frame.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose {
        let position = self.start + self.direction * s;
        Pose::from_parts(Translation3::from(position), self.turning.at(s))
    }
}
