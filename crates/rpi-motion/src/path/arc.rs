//! Circular arc of the tool.

use super::Curvature;
use super::line::TURNING_LENGTH;
use super::orientation::EvenTurning;
use core::f64::consts::TAU;
use nalgebra::{Translation3, Vector3};
use rpi_kin::Pose;

/// Circular arc of the tool, along which the tool turns evenly. The path parameter is the length of the arc (m), or a
/// longer one if the tool turns far on a short arc.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    centre: Vector3<f64>,
    /// Unit vector from the centre of the arc to its start, in the base frame.
    outwards: Vector3<f64>,
    /// Unit tangent of the arc at its start, in the base frame.
    forwards: Vector3<f64>,
    radius: f64,
    /// Angle about the centre per unit of the path parameter, rad/m.
    rate: f64,
    turning: EvenTurning,
    length: f64,
}

/// Orientation of the tool along an arc that is given by axis and angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcOrientation {
    /// The orientation of the tool in the base frame stays the same.
    Fixed,
    /// The tool turns with the arc: its orientation relative to the path stays the same.
    Turning,
}

/// Reason why points, or a centre or an axis, do not define an arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcError {
    /// The points lie on a line, or two of them coincide, or a number is not finite.
    Colinear,
    /// Start and end differ in their distance from the centre by too much.
    UnequalRadii,
    /// The angle of the arc is 0 or not finite.
    NoAngle,
    /// The start lies on the axis of the arc, or the axis has no direction.
    OnAxis,
}

impl core::fmt::Display for ArcError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            ArcError::Colinear => "the three points of the arc lie on a line",
            ArcError::UnequalRadii => {
                "start and end of the arc are not equally far from its centre"
            }
            ArcError::NoAngle => "the angle of the arc is 0",
            ArcError::OnAxis => "the arc starts on its axis, or its axis has no direction",
        })
    }
}

impl core::error::Error for ArcError {}

/// Sine of the angle between two sides of the triangle of the given points below which the points count as lying on a
/// line.
const COLINEAR: f64 = 1e-6;

/// Maximum distance (m) of a given centre from the plane of equal distances from start and end. The centre is moved
/// there, because the start of a path is seldom exact.
const CENTRE_TOLERANCE: f64 = 1e-3;

/// Minimum radius of an arc about an axis, m. With a smaller one, the tool would turn on the spot.
const SHORTEST_RADIUS: f64 = 1e-6;

impl Arc {
    /// Creates the arc from the pose `from` through the point `via` to the pose `to`, in the base frame. The tool turns
    /// evenly from the orientation of the start to that of the end.
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
        let angle = rpi_math::atan2(end.dot(&forwards), end.dot(&outwards));
        let angle = if angle <= 0.0 { angle + TAU } else { angle };
        let turning = EvenTurning::vector_between(&from.rotation, &to.rotation);
        let frame = (outwards, forwards);
        Ok(Self::new(from, turning, centre, frame, radius, angle))
    }

    /// Creates the shorter arc about `centre` from the pose `from` to the pose `to`, in the base frame. The tool turns
    /// evenly from the orientation of the start to that of the end. The centre may be up to 1 mm off the plane of equal
    /// distances from both; it is moved there.
    ///
    /// # Errors
    /// [`ArcError::Colinear`] if start, centre and end lie on a line, so that the plane of the arc is not determined;
    /// [`ArcError::UnequalRadii`] if start and end are not equally far from the centre.
    pub fn by_centre(from: &Pose, centre: &Vector3<f64>, to: &Pose) -> Result<Self, ArcError> {
        let start = from.translation.vector;
        let (one, other) = (start - centre, to.translation.vector - centre);
        let normal = one.cross(&other);
        let area = normal.norm_squared();
        let sides = one.norm_squared() * other.norm_squared();
        if area <= COLINEAR * COLINEAR * sides || !(area.is_finite() && area > 0.0) {
            return Err(ArcError::Colinear);
        }
        let chord = other - one;
        let length = libm::sqrt(chord.norm_squared());
        let shift = (other.norm_squared() - one.norm_squared()) / (2.0 * length);
        if shift.abs() > CENTRE_TOLERANCE || shift.is_nan() {
            return Err(ArcError::UnequalRadii);
        }
        let shift = chord * (shift / length);
        let (one, other) = (one - shift, other - shift);
        let radius = libm::sqrt(one.norm_squared());
        let outwards = one / radius;
        let forwards = (normal / libm::sqrt(area)).cross(&outwards);
        let angle = rpi_math::atan2(other.dot(&forwards), other.dot(&outwards));
        let turning = EvenTurning::vector_between(&from.rotation, &to.rotation);
        let frame = (outwards, forwards);
        Ok(Self::new(
            from,
            turning,
            centre + shift,
            frame,
            radius,
            angle,
        ))
    }

    /// Creates the arc from the pose `from` by `angle` (rad, not 0, any number of turns) about the axis through
    /// `centre` with the direction `normal`, in the base frame.
    ///
    /// # Errors
    /// [`ArcError::NoAngle`] if the angle is 0 or not finite; [`ArcError::OnAxis`] if the start lies on the axis, or
    /// the axis has no direction.
    pub fn by_angle(
        from: &Pose,
        centre: &Vector3<f64>,
        normal: &Vector3<f64>,
        angle: f64,
        orientation: ArcOrientation,
    ) -> Result<Self, ArcError> {
        if angle == 0.0 || !angle.is_finite() {
            return Err(ArcError::NoAngle);
        }
        let normal = normal / libm::sqrt(normal.norm_squared());
        let spoke = from.translation.vector - centre;
        let height = normal * spoke.dot(&normal);
        let level = spoke - height;
        let radius = libm::sqrt(level.norm_squared());
        if !(radius >= SHORTEST_RADIUS && radius.is_finite()) {
            return Err(ArcError::OnAxis);
        }
        let outwards = level / radius;
        let forwards = normal.cross(&outwards) * angle.signum();
        let turning = match orientation {
            ArcOrientation::Fixed => Vector3::zeros(),
            ArcOrientation::Turning => normal * angle,
        };
        let (centre, frame) = (centre + height, (outwards, forwards));
        Ok(Self::new(from, turning, centre, frame, radius, angle.abs()))
    }

    /// Creates the arc by `angle` (rad, positive) from the unit vector `outwards` in the direction `forwards`, on which
    /// the tool turns by the rotation vector `turning` (rad, base frame).
    fn new(
        from: &Pose,
        turning: Vector3<f64>,
        centre: Vector3<f64>,
        (outwards, forwards): (Vector3<f64>, Vector3<f64>),
        radius: f64,
        angle: f64,
    ) -> Self {
        let turn = libm::sqrt(turning.norm_squared());
        let length = (radius * angle).max(turn * TURNING_LENGTH);
        Self {
            centre,
            outwards,
            forwards,
            radius,
            rate: angle / length,
            turning: EvenTurning::by(&from.rotation, turning, length),
            length,
        }
    }

    /// Returns the maximum value of the path parameter, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Returns the distance that the tool travels, m. It equals the length of the path parameter, or is shorter if the
    /// tool turns far on a short arc.
    #[must_use]
    pub fn way(&self) -> f64 {
        self.radius * self.rate * self.length
    }

    /// Returns the radius of the arc, m.
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Returns the pose of the tool in the base frame at the value `s` (m) of the path parameter.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose {
        let (sin, cos) = rpi_math::sincos(s * self.rate);
        let spoke = (self.outwards * cos + self.forwards * sin) * self.radius;
        Pose::from_parts(Translation3::from(self.centre + spoke), self.turning.at(s))
    }

    /// Returns the curvature of the arc with respect to the path parameter, 1/m; it is constant.
    #[must_use]
    pub fn curvature(&self) -> Curvature {
        Curvature::constant(self.radius * self.rate * self.rate, self.rate)
    }
}
