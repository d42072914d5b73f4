//! Where the elbow stands on its circle about the line from shoulder to wrist.

use super::{Geometry, Joints};
use crate::angle::SinCos;
use nalgebra::Vector3;

/// Below this length of its horizontal part, the line from shoulder to wrist counts as vertical: "up" is then not a
/// direction about it any more.
const VERTICAL: f64 = 1e-9;

/// The circle on which the elbow can stand: its axis, the side of it that looks up and the side a quarter turn further.
/// All three are unit vectors at right angles to each other.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    pub(super) axis: Vector3<f64>,
    pub(super) up: Vector3<f64>,
    pub(super) side: Vector3<f64>,
    vertical: bool,
}

impl Circle {
    /// About the unit vector `axis`. Where that is vertical, the base's x, turned into the circle, stands for "up".
    #[must_use]
    pub fn about(axis: Vector3<f64>) -> Self {
        let level = libm::sqrt(axis.x * axis.x + axis.y * axis.y);
        let vertical = level <= VERTICAL;
        let up = if vertical {
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

    /// The direction on the circle at an arm angle: a unit vector.
    #[must_use]
    pub fn direction(&self, arm_angle: SinCos) -> Vector3<f64> {
        self.up * arm_angle.cos + self.side * arm_angle.sin
    }

    /// The arm angle of a direction, whatever its length and its part along the axis. `None` if it has no other part.
    #[must_use]
    pub fn arm_angle(&self, direction: &Vector3<f64>) -> Option<SinCos> {
        let (cos, sin) = (direction.dot(&self.up), direction.dot(&self.side));
        let length = libm::sqrt(cos * cos + sin * sin);
        (length > VERTICAL).then(|| SinCos {
            sin: sin / length,
            cos: cos / length,
        })
    }
}

/// The elbow of a given set of joints.
#[derive(Clone, Copy, Debug)]
pub struct Elbow {
    circle: Circle,
    /// From the line to the elbow: a unit vector. For a straight arm the side to which the elbow would leave the line if
    /// it bent in its present sense.
    direction: Vector3<f64>,
}

impl Elbow {
    /// Of the canonical angles `p`. `None` if the forearm is folded back onto the shoulder.
    #[must_use]
    pub fn of(geometry: &Geometry, p: &Joints) -> Option<Self> {
        let (upper, front) = upper_arm(p);
        let s4 = SinCos::of(p[3]);
        let along = geometry.upper + geometry.fore * s4.cos;
        let across = geometry.fore * s4.sin;
        let distance = libm::sqrt(along * along + across * across);
        if distance <= VERTICAL {
            return None;
        }
        let axis = (upper * along + front * across) / distance;
        // A straight arm's sense is the sign of its zero.
        let away = if s4.sin.is_sign_negative() { 1.0 } else { -1.0 };
        let direction = (front * along - upper * across) * (away / distance);
        Some(Self {
            circle: Circle::about(axis),
            direction,
        })
    }

    /// The arm angle, zero where the elbow looks up.
    #[must_use]
    pub fn arm_angle(&self) -> SinCos {
        self.circle
            .arm_angle(&self.direction)
            .unwrap_or(SinCos { sin: 0.0, cos: 1.0 })
    }

    /// The arm angle that keeps this elbow on another circle: the same angle, or, where one of the two lines is vertical
    /// and angles do not compare, the same side in space.
    #[must_use]
    pub fn kept_on(&self, circle: &Circle) -> SinCos {
        let by_side = if self.circle.vertical || circle.vertical {
            circle.arm_angle(&self.direction)
        } else {
            None
        };
        by_side.unwrap_or_else(|| self.arm_angle())
    }
}

/// The direction of the upper arm and the side of it to which a positive bend of the elbow tilts the forearm.
fn upper_arm(p: &Joints) -> (Vector3<f64>, Vector3<f64>) {
    let (s1, s2, s3) = (SinCos::of(p[0]), SinCos::of(p[1]), SinCos::of(p[2]));
    let upper = Vector3::new(s1.cos * s2.sin, s1.sin * s2.sin, s2.cos);
    let front = Vector3::new(
        s1.cos * s2.cos * s3.cos - s1.sin * s3.sin,
        s1.sin * s2.cos * s3.cos + s1.cos * s3.sin,
        -s2.sin * s3.cos,
    );
    (upper, front)
}
