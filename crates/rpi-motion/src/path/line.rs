//! Straight line of the tool.

use super::orientation::{EvenTurning, angle_between};
use nalgebra::{Translation3, Vector3};
use rpi_kin::Pose;

/// Length of way that counts as much as one radian of turning, m. It decides the length of a line on which the tool
/// turns far on a short way.
pub const TURNING_LENGTH: f64 = 0.25;

/// A straight line of the tool. Its orientation turns evenly along the way.
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

    /// Returns the length of the way of the tool, m: that of the path parameter, or shorter where the turning decides it.
    #[must_use]
    pub fn way(&self) -> f64 {
        libm::sqrt(self.direction.norm_squared()) * self.length
    }

    /// Returns the way per unit of the path parameter: a unit vector where the way decides the length, else shorter.
    #[must_use]
    pub fn direction(&self) -> Vector3<f64> {
        self.direction
    }

    /// Returns whether the path parameter of the line is the length of the way in m, rather than a measure of the
    /// turning.
    #[must_use]
    pub fn is_by_length(&self) -> bool {
        (self.direction.norm_squared() - 1.0).abs() < 1e-9
    }

    /// Returns the part of the line between two values of its path parameter.
    #[must_use]
    pub fn section(&self, from: f64, to: f64) -> Self {
        Self {
            start: self.start + self.direction * from,
            turning: self.turning.starting_at(from),
            length: to - from,
            ..*self
        }
    }

    /// Returns the pose of the tool in the base frame.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose {
        let position = self.start + self.direction * s;
        Pose::from_parts(Translation3::from(position), self.turning.at(s))
    }
}
