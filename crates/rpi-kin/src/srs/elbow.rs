//! Position of the elbow on its circle about the line from shoulder to wrist.

use super::{Geometry, Joints};
use crate::angle::SinCos;
use nalgebra::Vector3;

/// Length of the horizontal part of a unit vector up to which the line from shoulder to wrist counts as vertical. For a
/// vertical line, no direction on the circle of the elbow is the upward one.
const VERTICAL_TOLERANCE: f64 = 1e-9;

/// Circle of possible elbow positions: its axis from shoulder to wrist, its upward direction, and the direction a
/// quarter turn from the upward one. All three are orthogonal unit vectors in the base frame.
#[derive(Clone, Copy, Debug)]
pub struct ElbowCircle {
    pub(super) axis: Vector3<f64>,
    pub(super) up: Vector3<f64>,
    pub(super) side: Vector3<f64>,
    vertical: bool,
}

impl ElbowCircle {
    /// Creates the circle about the unit vector `axis` in the base frame. If the axis is vertical, x of the base frame,
    /// rotated into the plane of the circle, replaces the upward direction.
    #[must_use]
    pub fn new(axis: Vector3<f64>) -> Self {
        let level = libm::sqrt(axis.x * axis.x + axis.y * axis.y);
        let vertical = level <= VERTICAL_TOLERANCE;
        let up = if vertical {
            // Perpendicular to the axis. Its length is not 0, because the axis is vertical.
            let turned = Vector3::new(axis.z, 0.0, -axis.x);
            turned / libm::sqrt(turned.norm_squared())
        } else {
            Vector3::new(-axis.z * axis.x / level, -axis.z * axis.y / level, level)
        };
        Self {
            axis,
            up,
            side: axis.cross(&up),
            vertical,
        }
    }

    /// Returns the unit vector from the line shoulder-wrist to the elbow at an arm angle, in the base frame.
    #[must_use]
    pub fn direction(&self, arm_angle: SinCos) -> Vector3<f64> {
        self.up * arm_angle.cos + self.side * arm_angle.sin
    }

    /// Returns the arm angle of a direction, without regard to its length and its part along the axis. `None` if the
    /// direction is parallel to the axis.
    #[must_use]
    pub fn arm_angle(&self, direction: &Vector3<f64>) -> Option<SinCos> {
        let (cos, sin) = (direction.dot(&self.up), direction.dot(&self.side));
        let length = libm::sqrt(cos * cos + sin * sin);
        (length > VERTICAL_TOLERANCE).then(|| SinCos {
            sin: sin / length,
            cos: cos / length,
        })
    }
}

/// Position of the elbow for a set of joint values: the circle on which the elbow can move, and its place there.
#[derive(Clone, Copy, Debug)]
pub struct ElbowPosition {
    circle: ElbowCircle,
    /// Unit vector from the line shoulder-wrist to the elbow, in the base frame. For a straight arm, the direction in
    /// which the elbow would leave the line if it bent in its present sense.
    direction: Vector3<f64>,
}

impl ElbowPosition {
    /// Computes the elbow position of the canonical angles `p` (rad, `sense * joint value`). `None` if the forearm is
    /// folded back so that the wrist is at the shoulder.
    #[must_use]
    pub fn from_joints(geometry: &Geometry, p: &Joints) -> Option<Self> {
        let (upper, front) = upper_arm(p);
        let s4 = SinCos::from_angle(p[3]);
        let along = geometry.upper + geometry.fore * s4.cos;
        let across = geometry.fore * s4.sin;
        let distance = libm::sqrt(along * along + across * across);
        if distance <= VERTICAL_TOLERANCE {
            return None;
        }
        let axis = (upper * along + front * across) / distance;
        // The sense of a straight arm is the sign of its zero.
        let away = if s4.sin.is_sign_negative() { 1.0 } else { -1.0 };
        let direction = (front * along - upper * across) * (away / distance);
        Some(Self {
            circle: ElbowCircle::new(axis),
            direction,
        })
    }

    /// Returns the arm angle of the elbow position, which is 0 if the elbow points up.
    #[must_use]
    pub fn arm_angle(&self) -> SinCos {
        self.circle
            .arm_angle(&self.direction)
            .unwrap_or(SinCos { sin: 0.0, cos: 1.0 })
    }

    /// Returns the arm angle that keeps this elbow position on the circle of another pose: the same angle. If a line
    /// from shoulder to wrist is vertical, angles are not comparable, and the direction of the elbow in space is
    /// preserved instead.
    #[must_use]
    pub fn arm_angle_on(&self, circle: &ElbowCircle) -> SinCos {
        let by_side = if self.circle.vertical || circle.vertical {
            circle.arm_angle(&self.direction)
        } else {
            None
        };
        by_side.unwrap_or_else(|| self.arm_angle())
    }
}

/// Returns the direction of the upper arm, and the orthogonal direction to which a positive bend of the elbow tilts the
/// forearm: unit vectors in the base frame, for the canonical angles `p` (rad).
fn upper_arm(p: &Joints) -> (Vector3<f64>, Vector3<f64>) {
    let (s1, s2, s3) = (
        SinCos::from_angle(p[0]),
        SinCos::from_angle(p[1]),
        SinCos::from_angle(p[2]),
    );
    let upper = Vector3::new(s1.cos * s2.sin, s1.sin * s2.sin, s2.cos);
    let front = Vector3::new(
        s1.cos * s2.cos * s3.cos - s1.sin * s3.sin,
        s1.sin * s2.cos * s3.cos + s1.cos * s3.sin,
        -s2.sin * s3.cos,
    );
    (upper, front)
}
