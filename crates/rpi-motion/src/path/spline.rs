//! Smooth curve of the tool through poses.
//!
//! The way is the natural cubic spline over the lengths of the chords (de Boor, A Practical Guide to Splines, 1978, chapter
//! IV), so direction and curvature continue everywhere. Each of its pieces is kept as a Bézier curve of degree 5, whose
//! parameter is replaced by the arc length. The orientation of a piece is a cumulative Bézier curve of degree 5, too (Kim,
//! Kim, Shin 1995): its control orientations are chosen such that angular velocity and acceleration at the points are
//! those of the same cubic spline over the rotation vectors between the points. So they continue, too.

use super::corner::Corner;
use super::line::TURNING_LENGTH;
use super::{MAX_PIECES, Piece, ToolPath};
use nalgebra::Vector3;
use rpi_kin::Pose;
use rpi_kin::rotation::{angle_between, from_rotation_vector, rotation_vector};

/// Reason why there is no spline through the given points. Points are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SplineError {
    /// There are fewer than two points, or more than [`MAX_POINTS`].
    Counts,
    /// The point with this number and the next one coincide.
    SamePoint(usize),
    /// The curve turns back so sharply near the point with this number that the tool would have to stop.
    Reversal(usize),
    /// The tool turns so far between the point with this number and the next one that the turning decides the speed.
    TurningDecides(usize),
}

impl core::fmt::Display for SplineError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            SplineError::Counts => write!(f, "a spline needs 2 to {MAX_POINTS} points"),
            SplineError::SamePoint(k) => {
                write!(f, "points {k} and {} of the spline are the same", k + 1)
            }
            SplineError::Reversal(k) => write!(f, "the spline turns back at point {k}"),
            SplineError::TurningDecides(k) => write!(
                f,
                "the tool turns too far between points {k} and {} of the spline",
                k + 1
            ),
        }
    }
}

impl core::error::Error for SplineError {}

/// Maximum number of points of a spline, including its start.
pub const MAX_POINTS: usize = MAX_PIECES + 1;

/// Minimum distance between two successive points of a spline, m.
pub const SHORTEST_CHORD: f64 = 1e-6;

/// Minimum of the derivative of the position with respect to the curve parameter, as a share of the distance between
/// the ends of a piece. A smaller one belongs to a cusp.
const SLOWEST: f64 = 0.1;

/// First and second derivatives of a spline with respect to its parameter, at its points.
struct Derivatives {
    first: [Vector3<f64>; MAX_POINTS],
    second: [Vector3<f64>; MAX_POINTS],
}

impl ToolPath {
    /// Creates the spline through `points`, which are poses of the tool in the base frame. It passes through all of
    /// them with continuous curvature, and its curvature is 0 at both ends.
    ///
    /// # Errors
    /// A [`SplineError`] that names the point, counted from 0.
    pub fn spline(points: &[Pose]) -> Result<Self, SplineError> {
        if !(2..=MAX_POINTS).contains(&points.len()) {
            return Err(SplineError::Counts);
        }
        let pieces = points.len() - 1;
        let (mut widths, mut ways, mut turns) = (
            [1.0; MAX_PIECES],
            [Vector3::zeros(); MAX_PIECES],
            [Vector3::zeros(); MAX_PIECES],
        );
        for (k, pair) in points.windows(2).enumerate() {
            widths[k] = chord(&pair[0], &pair[1], k)?;
            ways[k] = pair[1].translation.vector - pair[0].translation.vector;
            // In the frame of the tool: an even turning has the same vector in each piece.
            turns[k] = rotation_vector(&(pair[0].rotation.inverse() * pair[1].rotation));
        }
        let position = derivatives(&ways[..pieces], &widths);
        let orientation = derivatives(&turns[..pieces], &widths);
        let mut path = Self::empty();
        for (k, pair) in points.windows(2).enumerate() {
            let piece = piece(pair, k, widths[k], &position, &orientation);
            let (slowest, at) = piece.slowest();
            if slowest < SLOWEST || slowest.is_nan() {
                return Err(SplineError::Reversal(if at < 0.5 { k } else { k + 1 }));
            }
            path.push(Piece::Spline(piece));
        }
        Ok(path)
    }
}

/// Returns the distance between two successive points, m; the first one has the number `k`, for the error.
fn chord(from: &Pose, to: &Pose, k: usize) -> Result<f64, SplineError> {
    let chord = libm::sqrt((to.translation.vector - from.translation.vector).norm_squared());
    if chord < SHORTEST_CHORD || chord.is_nan() {
        return Err(SplineError::SamePoint(k));
    }
    if angle_between(&from.rotation, &to.rotation) * TURNING_LENGTH > chord {
        return Err(SplineError::TurningDecides(k));
    }
    Ok(chord)
}

/// Returns the derivatives of the natural cubic spline at its points. `steps` are the differences of its value,
/// `widths` those of its parameter between the points. Solves the tridiagonal system for the first derivatives (Thomas
/// algorithm).
fn derivatives(steps: &[Vector3<f64>], widths: &[f64; MAX_PIECES]) -> Derivatives {
    let n = steps.len();
    let slope = |k: usize| steps[k] / widths[k];
    let mut first = [Vector3::zeros(); MAX_POINTS];
    let mut upper = [0.5; MAX_POINTS];
    first[0] = slope(0) * 1.5;
    for k in 1..=n {
        let before = 1.0 / widths[k - 1];
        let after = if k < n { 1.0 / widths[k] } else { 0.0 };
        let mut right = slope(k - 1) * (3.0 * before);
        if k < n {
            right += slope(k) * (3.0 * after);
        }
        let pivot = 2.0 * (before + after) - before * upper[k - 1];
        upper[k] = after / pivot;
        first[k] = (right - first[k - 1] * before) / pivot;
    }
    for k in (0..n).rev() {
        let next = first[k + 1];
        first[k] -= next * upper[k];
    }
    let mut second = [Vector3::zeros(); MAX_POINTS];
    for k in 1..n {
        second[k] = (slope(k) * 6.0 - first[k] * 4.0 - first[k + 1] * 2.0) / widths[k];
    }
    Derivatives { first, second }
}

/// Creates the piece of the spline from point `k` to the next one, whose parameter has the length `width`: the Bézier
/// curve of position and orientation with the derivatives at both ends.
fn piece(
    pair: &[Pose],
    k: usize,
    width: f64,
    position: &Derivatives,
    orientation: &Derivatives,
) -> Corner {
    // First step of the control points at an end, and the next one: 5 b' and 20 b'' are the derivatives.
    let steps = |of: &Derivatives, at: usize, sense: f64| {
        let step = of.first[at] * (width / 5.0);
        (step, step + of.second[at] * (sense * width * width / 20.0))
    };
    let (start, end) = (pair[0].translation.vector, pair[1].translation.vector);
    let (one, two) = steps(position, k, 1.0);
    let (five, four) = steps(position, k + 1, -1.0);
    let points = [
        start,
        start + one,
        start + one + two,
        end - five - four,
        end - five,
        end,
    ];
    let (one, two) = steps(orientation, k, 1.0);
    let (five, four) = steps(orientation, k + 1, -1.0);
    let turn = from_rotation_vector;
    // The acceleration is given in the frame of the end, the rotation vector in the frame before the last turn.
    let four = turn(five) * four;
    let head = turn(one) * turn(two);
    let tail = turn(four) * turn(five);
    let between = pair[0].rotation.inverse() * pair[1].rotation;
    let three = rotation_vector(&(head.inverse() * between * tail.inverse()));
    Corner::with_controls(points, pair[0].rotation, [one, two, three, four, five])
}
