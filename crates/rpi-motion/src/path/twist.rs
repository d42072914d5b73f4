//! Path of a tool that moves with a constant twist: without an end of its own.

use super::Curvature;
use super::line::TURNING_LENGTH;
use nalgebra::{Translation3, Vector3};
use rpi_kin::Pose;
use rpi_kin::rotation::from_rotation_vector;

/// Frame in which the components of a twist (linear and angular velocity) are constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TwistFrame {
    /// The base frame: the tool moves on a straight line, and turns about an axis that keeps its direction.
    Base,
    /// The tool frame: the tool moves on a helix, which is a line or a circle in special cases.
    Tool,
}

/// Path of a tool that moves with a constant twist (linear and angular velocity). Its length is greater than any arm
/// can travel.
#[derive(Clone, Copy, Debug)]
pub struct TwistPath {
    start: Pose,
    /// Displacement per unit of the path parameter, in the frame of the twist (no unit).
    linear: Vector3<f64>,
    /// Rotation vector per unit of the path parameter, in the frame of the twist; rad/m.
    angular: Vector3<f64>,
    frame: TwistFrame,
}

/// Maximum value of the path parameter, m. The operator ends such a motion long before the arm could follow it to its
/// end.
const LENGTH: f64 = 100.0;

/// Returns the speed along the path (m/s) for a twist: the linear velocity (m/s), or the angular velocity (rad/s) times
/// [`TURNING_LENGTH`], whichever is greater.
#[must_use]
pub fn twist_speed(linear: &Vector3<f64>, angular: &Vector3<f64>) -> f64 {
    let (way, turn) = (linear.norm_squared(), angular.norm_squared());
    libm::sqrt(way).max(TURNING_LENGTH * libm::sqrt(turn))
}

impl TwistPath {
    /// Creates the path from the pose `start` in the direction of a twist: linear (m/s) and angular velocity (rad/s) in
    /// `frame`. `None` if the twist is zero or not finite.
    #[must_use]
    pub fn new(
        start: &Pose,
        linear: &Vector3<f64>,
        angular: &Vector3<f64>,
        frame: TwistFrame,
    ) -> Option<Self> {
        let speed = twist_speed(linear, angular);
        (speed > 1e-12 && speed.is_finite()).then(|| Self {
            start: *start,
            linear: linear / speed,
            angular: angular / speed,
            frame,
        })
    }

    /// Returns the maximum value of the path parameter, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        LENGTH
    }

    /// Returns the distance that the tool would travel along the whole path, m.
    #[must_use]
    pub fn way(&self) -> f64 {
        LENGTH * libm::sqrt(self.linear.norm_squared())
    }

    /// Returns the pose of the tool in the base frame at the value `s` (m) of the path parameter.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose {
        let turn = from_rotation_vector(self.angular * s);
        let (at, rotation) = (self.start.translation.vector, self.start.rotation);
        match self.frame {
            TwistFrame::Base => {
                let place = at + self.linear * s;
                Pose::from_parts(Translation3::from(place), turn * rotation)
            }
            TwistFrame::Tool => {
                let place = at + rotation * self.way_in_tool(s);
                Pose::from_parts(Translation3::from(place), rotation * turn)
            }
        }
    }

    /// Returns the displacement of the tool (m) at the value `s` of the path parameter, in the frame of the tool at the
    /// start: the exponential map of the screw.
    fn way_in_tool(&self, s: f64) -> Vector3<f64> {
        let (v, w) = (self.linear * s, self.angular * s);
        let angle_squared = w.norm_squared();
        let angle = libm::sqrt(angle_squared);
        // (1 - cos x) / x² and (x - sin x) / x³
        let (one, other) = if angle < 1e-2 {
            let x = angle_squared;
            (
                0.5 - x / 24.0 + x * x / 720.0,
                1.0 / 6.0 - x / 120.0 + x * x / 5040.0,
            )
        } else {
            let (sin, cos) = rpi_math::sincos(angle);
            (
                (1.0 - cos) / angle_squared,
                (angle - sin) / (angle_squared * angle),
            )
        };
        let across = w.cross(&v);
        v + across * one + w.cross(&across) * other
    }

    /// Returns the curvature of the path with respect to the path parameter, 1/m; it is constant. In the frame of the
    /// tool the path is a helix, which winds about its axis.
    #[must_use]
    pub fn curvature(&self) -> Curvature {
        match self.frame {
            TwistFrame::Base => Curvature::default(),
            TwistFrame::Tool => {
                let value = libm::sqrt(self.angular.cross(&self.linear).norm_squared());
                Curvature::constant(value, libm::sqrt(self.angular.norm_squared()))
            }
        }
    }
}
