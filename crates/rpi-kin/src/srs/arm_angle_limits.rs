//! Arm angles at which a joint is at a limit of its range.
//!
//! Each entry of the rotations of the joints has the form `c + a cos(psi) + b sin(psi)`, where psi is the arm angle.
//! The condition that a joint has a given value has the same form, and therefore at most two solutions.

use super::elbow::ElbowCircle;
use super::{ElbowTriangle, Joints};
use crate::Range;
use crate::angle::SinCos;
use nalgebra::Vector3;

/// Maximum number of arm angles (positions of the elbow) at which a joint can be at a limit: two for each of the two
/// limits of six joints. The elbow joint does not depend on the arm angle.
pub const MAX_LIMIT_ARM_ANGLES: usize = 24;

/// Function `constant + cos * cos(psi) + sin * sin(psi)` of the arm angle psi, the angle of the elbow about the line
/// from shoulder to wrist.
#[derive(Clone, Copy, Debug)]
struct Sinusoid {
    constant: f64,
    cos: f64,
    sin: f64,
}

impl Sinusoid {
    fn scaled_sum(self, own: f64, other: Self, others: f64) -> Self {
        Self {
            constant: own * self.constant + others * other.constant,
            cos: own * self.cos + others * other.cos,
            sin: own * self.sin + others * other.sin,
        }
    }

    /// Returns the two arm angles (rad, not wrapped) at which the function is zero; NaN if there are none.
    fn zeros(self) -> [f64; 2] {
        let height = libm::sqrt(self.cos * self.cos + self.sin * self.sin);
        let middle = rpi_math::atan2(self.sin, self.cos);
        // The arc cosine outside its domain is NaN, which means no zero.
        let half = rpi_math::acos(-self.constant / height);
        [middle - half, middle + half]
    }
}

/// Vector in the frame of the plane through shoulder, elbow and wrist, which turns with the arm angle: components along
/// the line from shoulder to wrist, towards the elbow, and orthogonal to both.
#[derive(Clone, Copy)]
struct ElbowPlaneVector {
    along: f64,
    outward: f64,
    across: f64,
}

impl ElbowPlaneVector {
    fn dot(self, circle: &ElbowCircle, fixed: &Vector3<f64>) -> Sinusoid {
        let (up, side) = (circle.up.dot(fixed), circle.side.dot(fixed));
        Sinusoid {
            constant: self.along * circle.axis.dot(fixed),
            cos: self.outward * up + self.across * side,
            sin: self.outward * side - self.across * up,
        }
    }
}

/// Frame of the upper arm or forearm: z along the limb, y orthogonal to the plane through shoulder, elbow and wrist.
struct LimbFrame {
    x: ElbowPlaneVector,
    y: ElbowPlaneVector,
    z: ElbowPlaneVector,
}

impl LimbFrame {
    fn new(tilt: SinCos) -> Self {
        Self {
            x: ElbowPlaneVector {
                along: tilt.sin,
                outward: -tilt.cos,
                across: 0.0,
            },
            y: ElbowPlaneVector {
                along: 0.0,
                outward: 0.0,
                across: -1.0,
            },
            z: ElbowPlaneVector {
                along: tilt.cos,
                outward: tilt.sin,
                across: 0.0,
            },
        }
    }
}

/// Returns the arm angles (rad, not wrapped) at which a joint is at a limit of its range, whatever the signs of the
/// bends of shoulder, elbow and wrist. `ranges` are those of the canonical angles (`sense * joint value`). Unused
/// entries are NaN.
#[must_use]
pub fn limit_arm_angles(
    reach: &ElbowTriangle,
    circle: &ElbowCircle,
    ranges: &[Range; 7],
) -> [f64; MAX_LIMIT_ARM_ANGLES] {
    let upper = LimbFrame::new(reach.shoulder_angle);
    let fore = LimbFrame::new(reach.shoulder_angle.difference(reach.elbow_bend));
    let base: [Vector3<f64>; 3] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let hand: [Vector3<f64>; 3] =
        core::array::from_fn(|column| reach.flange_rotation.column(column).into());
    let wave = |spoke: ElbowPlaneVector, fixed: &Vector3<f64>| spoke.dot(circle, fixed);
    let minus = |wave: Sinusoid| wave.scaled_sum(-1.0, wave, 0.0);
    let [third_sin, third_cos] = third_joint(&upper, circle);
    let turns = [
        (0, wave(upper.z, &base[1]), wave(upper.z, &base[0])),
        (2, third_sin, third_cos),
        (4, wave(fore.y, &hand[2]), wave(fore.x, &hand[2])),
        (6, wave(fore.z, &hand[1]), minus(wave(fore.z, &hand[0]))),
    ];
    let bends = [(1, wave(upper.z, &base[2])), (5, wave(fore.z, &hand[2]))];
    let at_turns = turns.into_iter().flat_map(|(axis, sin, cos)| {
        limits_sin_cos(ranges[axis]).map(|end| zeros_of_turn(sin, cos, end))
    });
    let at_bends = bends
        .into_iter()
        .flat_map(|(axis, cos)| limits_sin_cos(ranges[axis]).map(|end| zeros_of_bend(cos, end)));
    collect(at_turns.chain(at_bends).flatten())
}

/// Returns the arm angles (rad, not wrapped) at which the third joint has the canonical angle (`sense * joint value`)
/// `third` (rad), or half a turn more with the opposite bend of the shoulder; NaN if there are none.
///
/// These arm angles stay well defined where the shoulder is straight and axes 1 and 3 are in line. There, a constant
/// arm angle would make both axes jump.
#[must_use]
pub fn arm_angles_of_third_joint(
    reach: &ElbowTriangle,
    circle: &ElbowCircle,
    third: f64,
) -> [f64; 2] {
    let upper = LimbFrame::new(reach.shoulder_angle);
    let [sin, cos] = third_joint(&upper, circle);
    zeros_of_turn(sin, cos, SinCos::from_angle(third))
}

/// Returns the sine and the cosine of the angle of the third joint, both multiplied by the same positive number, as
/// functions of the arm angle. `upper` is the frame of the upper arm.
fn third_joint(upper: &LimbFrame, circle: &ElbowCircle) -> [Sinusoid; 2] {
    let vertical = Vector3::z();
    let cos = upper.x.dot(circle, &vertical);
    [
        upper.y.dot(circle, &vertical),
        cos.scaled_sum(-1.0, cos, 0.0),
    ]
}

fn limits_sin_cos(range: Range) -> [SinCos; 2] {
    [
        SinCos::from_angle(range.lower),
        SinCos::from_angle(range.upper),
    ]
}

/// Returns the arm angles (rad) at which a joint that turns about a limb has the angle `end`, or half a turn more.
/// `sin` and `cos` are proportional to the sine and the cosine of the joint's angle.
fn zeros_of_turn(sin: Sinusoid, cos: Sinusoid, end: SinCos) -> [f64; 2] {
    sin.scaled_sum(end.cos, cos, -end.sin).zeros()
}

/// Returns the arm angles (rad) at which the cosine `cos` of the angle of a bending joint equals the cosine of the
/// limit `end`.
fn zeros_of_bend(cos: Sinusoid, end: SinCos) -> [f64; 2] {
    Sinusoid {
        constant: cos.constant - end.cos,
        ..cos
    }
    .zeros()
}

fn collect(angles: impl Iterator<Item = f64>) -> [f64; MAX_LIMIT_ARM_ANGLES] {
    let mut all = [f64::NAN; MAX_LIMIT_ARM_ANGLES];
    all.iter_mut()
        .zip(angles)
        .for_each(|(slot, angle)| *slot = angle);
    all
}

/// Converts ranges of joint values to ranges of canonical angles (`sense * joint value`): a negative sense swaps the
/// ends.
#[must_use]
pub fn canonical_ranges(ranges: &[Range; 7], sense: &Joints) -> [Range; 7] {
    core::array::from_fn(|axis| {
        let Range { lower, upper } = ranges[axis];
        if sense[axis] < 0.0 {
            Range {
                lower: -upper,
                upper: -lower,
            }
        } else {
            ranges[axis]
        }
    })
}
