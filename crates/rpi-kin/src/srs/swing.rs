//! For which arm angles a joint stands at an end of its range.
//!
//! All entries of the rotations that the joints make up are of the form `c + a cos(psi) + b sin(psi)` in the arm angle
//! psi. So is the condition that a joint stands at a given value, and it has at most two solutions.

use super::elbow::Circle;
use super::{Joints, Reach};
use crate::Range;
use crate::angle::SinCos;
use nalgebra::Vector3;

/// How many arm angles there can be: two for each end of six ranges (the elbow's bend does not depend on the arm angle).
pub const CROSSINGS: usize = 24;

/// `constant + cos * cos(psi) + sin * sin(psi)`.
#[derive(Clone, Copy, Debug)]
struct Wave {
    constant: f64,
    cos: f64,
    sin: f64,
}

impl Wave {
    fn scaled_sum(self, own: f64, other: Self, others: f64) -> Self {
        Self {
            constant: own * self.constant + others * other.constant,
            cos: own * self.cos + others * other.cos,
            sin: own * self.sin + others * other.sin,
        }
    }

    /// Where it takes the value zero; NaN where it does not.
    fn zeros(self) -> [f64; 2] {
        let height = libm::sqrt(self.cos * self.cos + self.sin * self.sin);
        let middle = libm::atan2(self.sin, self.cos);
        // The arc cosine of what is out of its domain is NaN: no zero.
        let half = libm::acos(-self.constant / height);
        [middle - half, middle + half]
    }
}

/// A vector that turns with the elbow: parts along the line, towards the elbow and across both.
#[derive(Clone, Copy)]
struct Spoke {
    along: f64,
    outward: f64,
    across: f64,
}

impl Spoke {
    fn dot(self, circle: &Circle, fixed: &Vector3<f64>) -> Wave {
        let (up, side) = (circle.up.dot(fixed), circle.side.dot(fixed));
        Wave {
            constant: self.along * circle.axis.dot(fixed),
            cos: self.outward * up + self.across * side,
            sin: self.outward * side - self.across * up,
        }
    }
}

/// The frame of a limb that stands at an angle from the line: its z along the limb, its y across the arm's plane.
struct Limb {
    x: Spoke,
    y: Spoke,
    z: Spoke,
}

impl Limb {
    fn tilted(tilt: SinCos) -> Self {
        Self {
            x: Spoke {
                along: tilt.sin,
                outward: -tilt.cos,
                across: 0.0,
            },
            y: Spoke {
                along: 0.0,
                outward: 0.0,
                across: -1.0,
            },
            z: Spoke {
                along: tilt.cos,
                outward: tilt.sin,
                across: 0.0,
            },
        }
    }
}

/// The arm angles, wrapped or not, at which some joint stands at an end of its range, whatever the branch. `ranges` are
/// those of the canonical angles. Entries that do not exist are NaN.
#[must_use]
pub fn crossings(reach: &Reach, circle: &Circle, ranges: &[Range; 7]) -> [f64; CROSSINGS] {
    let upper = Limb::tilted(reach.lift);
    let fore = Limb::tilted(reach.lift.minus(reach.bend));
    let base: [Vector3<f64>; 3] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let hand: [Vector3<f64>; 3] = core::array::from_fn(|column| reach.flange.column(column).into());
    let wave = |spoke: Spoke, fixed: &Vector3<f64>| spoke.dot(circle, fixed);
    let minus = |wave: Wave| wave.scaled_sum(-1.0, wave, 0.0);
    let turns = [
        (0, wave(upper.z, &base[1]), wave(upper.z, &base[0])),
        (2, wave(upper.y, &base[2]), minus(wave(upper.x, &base[2]))),
        (4, wave(fore.y, &hand[2]), wave(fore.x, &hand[2])),
        (6, wave(fore.z, &hand[1]), minus(wave(fore.z, &hand[0]))),
    ];
    let bends = [(1, wave(upper.z, &base[2])), (5, wave(fore.z, &hand[2]))];
    let at_turns = turns
        .into_iter()
        .flat_map(|(axis, sin, cos)| ends(ranges[axis]).map(|end| turn_at(sin, cos, end)));
    let at_bends = bends
        .into_iter()
        .flat_map(|(axis, cos)| ends(ranges[axis]).map(|end| bend_at(cos, end)));
    collect(at_turns.chain(at_bends).flatten())
}

fn ends(range: Range) -> [SinCos; 2] {
    [SinCos::of(range.lower), SinCos::of(range.upper)]
}

/// Where the direction (cos, sin), of whatever length, points along `end` or away from it.
fn turn_at(sin: Wave, cos: Wave, end: SinCos) -> [f64; 2] {
    sin.scaled_sum(end.cos, cos, -end.sin).zeros()
}

/// Where a cosine is that of `end`.
fn bend_at(cos: Wave, end: SinCos) -> [f64; 2] {
    Wave {
        constant: cos.constant - end.cos,
        ..cos
    }
    .zeros()
}

fn collect(angles: impl Iterator<Item = f64>) -> [f64; CROSSINGS] {
    let mut all = [f64::NAN; CROSSINGS];
    all.iter_mut()
        .zip(angles)
        .for_each(|(slot, angle)| *slot = angle);
    all
}

/// The ranges of the canonical angles from those of the joints.
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
