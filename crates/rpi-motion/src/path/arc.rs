//! Circular arc of the tool.

use super::Curvature;
use super::line::TURNING_LENGTH;
use super::orientation::{EvenTurning, angle_between};
use core::f64::consts::{PI, TAU};
use nalgebra::{Translation3, Vector3};
use rpi_kin::Pose;

/// An arc of a circle with even turning. The path parameter is the length of the arc, stretched where the turning takes
/// longer.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    centre: Vector3<f64>,
    /// Unit vector from the centre of the arc to its start.
    outwards: Vector3<f64>,
    /// Unit tangent of the arc at its start.
    forwards: Vector3<f64>,
    radius: f64,
    /// Angle on the circle per unit of the path parameter, rad/m.
    rate: f64,
    turning: EvenTurning,
    length: f64,
}

/// Reason why points do not define an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcError {
    /// The points lie on a line, or two of them are the same, or a number is not finite.
    Colinear,
}

impl core::fmt::Display for ArcError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("the three points of the arc lie on a line")
    }
}

impl core::error::Error for ArcError {}

/// Sine of the angle between the sides of the triangle of the three points below which they count as colinear.
const COLINEAR: f64 = 1e-6;

impl Arc {
    /// The arc from the pose `from` through the point `via` to the pose `to`. The orientation turns evenly; that of
    /// the via point does not count.
    ///
    /// # Errors
    /// [`ArcError::Colinear`] if the points do not define a circle.
    pub fn via(from: &Pose, via: &Vector3<f64>, to: &Pose) -> Result<Self, ArcError> {
        let start = from.translation.vector;
        let (one, other) = (via - start, to.translation.vector - start);
        let normal = one.cross(&other);
        let area = normal.norm_squared();
        let sides = one.norm_squared() * other.norm_squared();
        if area <= COLINEAR * COLINEAR * sides || area.is_nan() {
            return Err(ArcError::Colinear);
        }
        let to_centre = (normal.cross(&one) * other.norm_squared()
            + other.cross(&normal) * one.norm_squared())
            / (2.0 * area);
        let centre = start + to_centre;
        let normal = normal / libm::sqrt(area);
        // The circle is passed in the sense of start, via, end, so the angle is that of the end in this sense.
        let radius = libm::sqrt(to_centre.norm_squared());
        let outwards = -to_centre / radius;
        let forwards = normal.cross(&outwards);
        let end = to.translation.vector - centre;
        let angle = libm::atan2(end.dot(&forwards), end.dot(&outwards));
        let angle = if angle <= 0.0 { angle + TAU } else { angle };
        Ok(Self::new(
            from,
            to,
            centre,
            (outwards, forwards),
            radius,
            angle,
        ))
    }

    /// The arc from the pose `from` about `centre` by `angle` (rad, not 0, any number of turns) around the axis
    /// `normal`, to the orientation of `to`.
    ///
    /// # Errors
    /// [`ArcError::Colinear`] if the start lies in the centre or on the axis.
    pub fn about(
        from: &Pose,
        centre: &Vector3<f64>,
        normal: &Vector3<f64>,
        angle: f64,
    ) -> Result<Self, ArcError> {
        let normal = normal / libm::sqrt(normal.norm_squared());
        let spoke = from.translation.vector - centre;
        let height = normal * spoke.dot(&normal);
        let level = spoke - height;
        let radius = libm::sqrt(level.norm_squared());
        if !(radius > 0.0 && angle != 0.0 && angle.is_finite()) {
            return Err(ArcError::Colinear);
        }
        let outwards = level / radius;
        let forwards = normal.cross(&outwards) * angle.signum();
        Ok(Self::new(
            from,
            from,
            centre + height,
            (outwards, forwards),
            radius,
            angle.abs(),
        ))
    }

    fn new(
        from: &Pose,
        to: &Pose,
        centre: Vector3<f64>,
        (outwards, forwards): (Vector3<f64>, Vector3<f64>),
        radius: f64,
        angle: f64,
    ) -> Self {
        let turn = angle_between(&from.rotation, &to.rotation).min(PI);
        let length = (radius * angle).max(turn * TURNING_LENGTH);
        Self {
            centre,
            outwards,
            forwards,
            radius,
            rate: angle / length,
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
        self.radius * self.rate * self.length
    }

    /// Returns the radius, m.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the pose of the tool in the base frame.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose {
        let (sin, cos) = libm::sincos(s * self.rate);
        let spoke = (self.outwards * cos + self.forwards * sin) * self.radius;
        Pose::from_parts(Translation3::from(self.centre + spoke), self.turning.at(s))
    }

    /// Returns the curvature with respect to the path parameter, 1/m.
    #[must_use]
    pub fn curvature(&self) -> Curvature {
        Curvature {
            value: self.radius * self.rate * self.rate,
            slope: 0.0,
        }
    }
}
