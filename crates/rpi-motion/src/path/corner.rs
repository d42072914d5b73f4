//! Transition between two straight lines of the tool: the corner within a zone.
//!
//! The way is a Bézier curve of degree 5 whose first and last three control points lie on the lines, so that direction
//! and curvature (0) continue at both ends. It lies in the triangle of the corner and its two ends at every speed,
//! because a Bézier curve lies in the convex hull of its control points. The orientation is the cumulative Bézier curve
//! with the same weights (Kim, Kim, Shin, A general construction scheme for unit quaternion curves, SIGGRAPH 1995).

use super::Curvature;
use super::line::Line;
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use rpi_kin::Pose;
use rpi_kin::rotation::{from_rotation_vector, rotation_vector};

/// Number of intervals of the table that maps arc length to curve parameter.
const INTERVALS: usize = 24;

/// Nodes and weights of the Gauss-Legendre quadrature with five points on [-1, 1]: pairs (node, weight).
const GAUSS: [(f64, f64); 5] = [
    (0.0, 0.568_888_888_888_888_9),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

/// Table by the angle of a corner: angle in degrees, then the distances of the two inner control points from the corner
/// as shares of the zone. They minimise the maximum curvature.
const WEIGHTS: [(f64, f64, f64); 6] = [
    (0.0, 0.57, 0.19),
    (30.0, 0.57, 0.21),
    (60.0, 0.57, 0.27),
    (90.0, 0.62, 0.35),
    (120.0, 0.69, 0.46),
    (150.0, 0.76, 0.60),
];

/// Rounded corner between two lines of a path, or a piece of a spline: a Bézier curve of degree 5.
#[derive(Clone, Copy, Debug)]
pub struct Corner {
    points: [Vector3<f64>; 6],
    start: UnitQuaternion<f64>,
    /// Rotation vectors from each control orientation to the next, in the frame of the first of both, rad.
    turns: [Vector3<f64>; 5],
    /// Arc length (m) from the start of the curve to the start of each interval of the curve parameter, and to its end.
    lengths: [f64; INTERVALS + 1],
}

/// Returns the angle between the directions of two lines, rad, from 0 to π.
#[must_use]
pub fn turn_between(first: &Vector3<f64>, second: &Vector3<f64>) -> f64 {
    let cross = first.cross(second);
    rpi_math::atan2(libm::sqrt(cross.norm_squared()), first.dot(second))
}

impl Corner {
    /// Creates the corner from `zone` (m) before the end of the line `before` to `zone` (m) behind the start of the
    /// line `after`. The path parameters of both lines must be lengths in m ([`Line::is_by_length`]).
    #[must_use]
    pub fn new(before: &Line, after: &Line, zone: f64) -> Self {
        let (p, q) = weights(turn_between(&before.direction(), &after.direction()));
        let end = before.length();
        let controls = [
            before.pose(end - zone),
            before.pose(end - p * zone),
            before.pose(end - q * zone),
            after.pose(q * zone),
            after.pose(p * zone),
            after.pose(zone),
        ];
        let turn = |k: usize| {
            let (from, to) = (controls[k].rotation, controls[k + 1].rotation);
            rotation_vector(&(from.inverse() * to))
        };
        let points = controls.map(|control| control.translation.vector);
        Self::with_controls(points, controls[0].rotation, core::array::from_fn(turn))
    }

    /// Creates the Bézier curve with these control points (m, base frame) and control orientations: the first one is
    /// `start`, and `turns` are the rotation vectors from each to the next, in the frame of the first of both (rad).
    pub(super) fn with_controls(
        points: [Vector3<f64>; 6],
        start: UnitQuaternion<f64>,
        turns: [Vector3<f64>; 5],
    ) -> Self {
        let mut corner = Self {
            points,
            start,
            turns,
            lengths: [0.0; INTERVALS + 1],
        };
        for k in 0..INTERVALS {
            let (from, to) = (interval_start(k), interval_start(k + 1));
            corner.lengths[k + 1] = corner.lengths[k] + corner.length_between(from, to);
        }
        corner
    }

    /// Returns the arc length of the curve, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.lengths[INTERVALS]
    }

    /// Returns the minimum of the derivative of the position with respect to the curve parameter, as a share of the
    /// distance between both ends, and the curve parameter (0 to 1) there.
    pub(super) fn slowest(&self) -> (f64, f64) {
        let chord = libm::sqrt((self.points[5] - self.points[0]).norm_squared());
        let places = (0..=8 * INTERVALS).map(|k| interval_start(k) / 8.0);
        let speed = |u: f64| libm::sqrt(self.derivative(u).norm_squared()) / chord;
        places.fold((f64::INFINITY, 0.0), |least, u| match speed(u) {
            speed if speed < least.0 || speed.is_nan() => (speed, u),
            _ => least,
        })
    }

    /// Returns the pose of the tool in the base frame, `s` metres behind the start of the corner.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose {
        let u = self.curve_parameter(s);
        let basis = bernstein(u);
        let position: Vector3<f64> = self.points.iter().zip(basis).map(|(p, b)| p * b).sum();
        let mut rotation = self.start;
        for (k, turn) in self.turns.iter().enumerate() {
            let share: f64 = basis[k + 1..].iter().sum();
            rotation *= from_rotation_vector(turn * share);
        }
        Pose::from_parts(Translation3::from(position), rotation)
    }

    /// Returns the curvature `s` metres behind the start of the corner.
    ///
    /// The second and third derivatives with respect to the arc length follow from those with respect to the curve
    /// parameter by the chain rule; only their parts across the direction of the curve are needed.
    #[must_use]
    pub fn curvature(&self, s: f64) -> Curvature {
        /// Curvature (1/m) below which the direction of the curvature is not defined.
        const STRAIGHT: f64 = 1e-9;
        let u = self.curve_parameter(s).clamp(0.0, 1.0);
        let first = self.derivative(u);
        let speed = libm::sqrt(first.norm_squared());
        let along = first / speed;
        let across = |v: Vector3<f64>| v - along * v.dot(&along);
        let second = self.second_derivative(u);
        let bend = across(second) / (speed * speed);
        let stretch = bend * (3.0 * speed * second.dot(&along));
        let third = (across(self.third_derivative(u)) - stretch) / (speed * speed * speed);
        let value = libm::sqrt(bend.norm_squared());
        if value < STRAIGHT {
            return Curvature {
                value,
                slope: libm::sqrt(third.norm_squared()),
                twist: 0.0,
            };
        }
        let slope = third.dot(&bend) / value;
        let twist = libm::sqrt((third - bend * (slope / value)).norm_squared());
        Curvature {
            value,
            slope,
            twist,
        }
    }

    /// Returns the curve parameter (0 to 1) at an arc length of `s` metres: from the table, improved by Newton steps on
    /// the exact length.
    fn curve_parameter(&self, s: f64) -> f64 {
        let k = self.lengths[1..INTERVALS].partition_point(|length| *length <= s);
        let (low, high) = (self.lengths[k], self.lengths[k + 1]);
        let mut u = interval_start(k) + (s - low) / (high - low) / INTERVALS as f64;
        for _ in 0..3 {
            let off = low + self.length_between(interval_start(k), u) - s;
            u -= off / libm::sqrt(self.derivative(u).norm_squared());
        }
        u
    }

    fn length_between(&self, from: f64, to: f64) -> f64 {
        let (middle, half) = ((from + to) / 2.0, (to - from) / 2.0);
        let speeds = GAUSS.iter().map(|(at, weight)| {
            weight * libm::sqrt(self.derivative(middle + half * at).norm_squared())
        });
        half * speeds.sum::<f64>()
    }

    fn derivative(&self, u: f64) -> Vector3<f64> {
        let w = 1.0 - u;
        let basis = [
            w * w * w * w,
            4.0 * u * w * w * w,
            6.0 * u * u * w * w,
            4.0 * u * u * u * w,
            u * u * u * u,
        ];
        let sides = self.points.windows(2).map(|pair| pair[1] - pair[0]);
        sides.zip(basis).map(|(side, b)| side * (5.0 * b)).sum()
    }

    fn second_derivative(&self, u: f64) -> Vector3<f64> {
        let w = 1.0 - u;
        let basis = [w * w * w, 3.0 * u * w * w, 3.0 * u * u * w, u * u * u];
        let bends = self.points.windows(3).map(|p| p[2] - p[1] * 2.0 + p[0]);
        bends.zip(basis).map(|(bend, b)| bend * (20.0 * b)).sum()
    }

    fn third_derivative(&self, u: f64) -> Vector3<f64> {
        let w = 1.0 - u;
        let basis = [w * w, 2.0 * u * w, u * u];
        let jerks = self.points.windows(4);
        let jerks = jerks.map(|p| p[3] - p[2] * 3.0 + p[1] * 3.0 - p[0]);
        jerks.zip(basis).map(|(jerk, b)| jerk * (60.0 * b)).sum()
    }
}

fn interval_start(k: usize) -> f64 {
    k as f64 / INTERVALS as f64
}

/// Returns the six Bernstein polynomials of degree 5 at `u` (0 to 1).
fn bernstein(u: f64) -> [f64; 6] {
    let w = 1.0 - u;
    let (u2, w2) = (u * u, w * w);
    [
        w2 * w2 * w,
        5.0 * u * w2 * w2,
        10.0 * u2 * w2 * w,
        10.0 * u2 * u * w2,
        5.0 * u2 * u2 * w,
        u2 * u2 * u,
    ]
}

/// Returns the distances of the two inner control points from a corner with the angle `turn` (rad), as shares of the
/// zone, interpolated linearly in the table.
fn weights(turn: f64) -> (f64, f64) {
    let degrees = turn.to_degrees();
    let behind = WEIGHTS.partition_point(|entry| entry.0 <= degrees);
    let (Some(low), high) = (WEIGHTS.get(behind.saturating_sub(1)), WEIGHTS.get(behind)) else {
        return (WEIGHTS[0].1, WEIGHTS[0].2);
    };
    let Some(high) = high else {
        return (low.1, low.2);
    };
    let share = (degrees - low.0) / (high.0 - low.0);
    (
        low.1 + share * (high.1 - low.1),
        low.2 + share * (high.2 - low.2),
    )
}
