//! Geometric paths: lines, arcs, corners and splines of the tool, and lines in joint space.
//!
//! A path has a parameter `s` from 0 to its length: metres along the way of the tool, or, where the tool turns far on a
//! short way, the turning weighed with a length; radians of the axis that moves farthest on a joint line. Paths continue
//! smoothly a little beyond both ends, so that derivatives exist there.

pub mod arc;
pub mod corner;
pub mod joint_line;
pub mod landmark;
pub mod line;
pub mod orientation;
pub mod polyline;
pub mod spline;
pub mod twist;

use crate::Joints;
pub use arc::{Arc, ArcError, ArcOrientation};
pub use corner::Corner;
pub use joint_line::JointLine;
pub use landmark::Landmark;
pub use line::Line;
pub use polyline::ZoneError;
use rpi_kin::Pose;
pub use spline::SplineError;
pub use twist::{TwistFrame, TwistPath};

/// Maximum number of pieces of a path of the tool.
pub const MAX_PIECES: usize = 16;

/// Number of steps into which the length of a corner is divided so that its curvature is known well enough in between.
const CORNER_SAMPLES: f64 = 96.0;

/// Piece of a path of the tool. Pieces are stored by value, because paths are replaced in the cycle, where nothing may
/// be allocated.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
pub enum Piece {
    /// Straight line of the tool, along which it turns evenly.
    Line(Line),
    /// Circular arc of the tool, along which it turns evenly.
    Arc(Arc),
    /// Rounded corner between two straight lines.
    Corner(Corner),
    /// Piece of a spline: a smooth curve through given points.
    Spline(Corner),
    /// Motion with a constant linear and angular velocity, without an end of its own.
    Twist(TwistPath),
}

/// Path of the tool in space, or of the axes in joint space, stored by value.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Copy, Debug)]
pub enum Path {
    /// Path of the tool: pieces in order.
    Tool(ToolPath),
    /// Straight line in joint space.
    Joints(JointLine),
}

/// Path of the tool as a sequence of pieces, each of which begins where the previous one ends.
#[derive(Clone, Copy, Debug)]
pub struct ToolPath {
    pieces: [Option<Piece>; MAX_PIECES],
    /// Position along the path (path parameter) at the start of each piece, m.
    starts: [f64; MAX_PIECES],
    count: usize,
    length: f64,
    /// Number of points of a spline that are at its start: they name it, but begin no piece.
    points_at_start: usize,
}

/// Curvature at a point of a path, with the third derivative of the path across its direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Curvature {
    /// Curvature: the inverse of the radius, 1/m.
    pub value: f64,
    /// Derivative of the curvature along the path, 1/m².
    pub slope: f64,
    /// Product of curvature and torsion, 1/m²: the third derivative out of the plane of the curve. 0 for a plane curve.
    pub twist: f64,
}

/// Place at which two pieces of a spline meet: the derivative of the curvature jumps there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kink {
    /// Position along the path, m.
    pub(crate) s: f64,
    /// Index of the piece that ends there, from 0.
    pub(crate) piece_before: usize,
}

impl Curvature {
    /// Returns the constant curvature `value` (1/m) of a path whose direction turns by `rate` (rad/m) about a fixed axis:
    /// an arc or a helix. Its third derivative is `rate * value`, which is more than the square of `value` if the path
    /// winds, or if the tool travels less than the path parameter grows.
    pub(crate) fn constant(value: f64, rate: f64) -> Self {
        let rest = libm::fabs(rate * rate - value * value);
        // Rounding alone is no torsion.
        let is_plane = rest <= 1e-12 * rate * rate;
        Self {
            value,
            slope: 0.0,
            twist: if is_plane {
                0.0
            } else {
                value * libm::sqrt(rest)
            },
        }
    }

    /// Returns the magnitude of the third derivative of the path, 1/m² (Frenet-Serret formulas): the jerk of the tool at
    /// the constant speed 1.
    #[must_use]
    pub fn third_derivative(&self) -> f64 {
        rpi_math::hypot(
            rpi_math::hypot(self.slope, self.twist),
            self.value * self.value,
        )
    }
}

impl Piece {
    /// Returns the maximum value of the path parameter of the piece, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        match self {
            Piece::Line(line) => line.length(),
            Piece::Arc(arc) => arc.length(),
            Piece::Corner(curve) | Piece::Spline(curve) => curve.length(),
            Piece::Twist(twist) => twist.length(),
        }
    }

    /// Returns the distance that the tool travels on the piece, m.
    #[must_use]
    pub fn way(&self) -> f64 {
        match self {
            Piece::Line(line) => line.way(),
            Piece::Arc(arc) => arc.way(),
            Piece::Corner(curve) | Piece::Spline(curve) => curve.length(),
            Piece::Twist(twist) => twist.way(),
        }
    }

    fn pose(&self, s: f64) -> Pose {
        match self {
            Piece::Line(line) => line.pose(s),
            Piece::Arc(arc) => arc.pose(s),
            Piece::Corner(curve) | Piece::Spline(curve) => curve.pose(s),
            Piece::Twist(twist) => twist.pose(s),
        }
    }

    fn curvature(&self, s: f64) -> Curvature {
        match self {
            Piece::Line(_) => Curvature::default(),
            Piece::Arc(arc) => arc.curvature(),
            Piece::Corner(curve) | Piece::Spline(curve) => curve.curvature(s),
            Piece::Twist(twist) => twist.curvature(),
        }
    }
}

impl ToolPath {
    /// Creates a path of a single piece.
    #[must_use]
    pub fn new(piece: Piece) -> Self {
        let mut path = Self::empty();
        path.push(piece);
        path
    }

    fn empty() -> Self {
        Self {
            pieces: [None; MAX_PIECES],
            starts: [0.0; MAX_PIECES],
            count: 0,
            length: 0.0,
            points_at_start: 0,
        }
    }

    /// Appends a piece to the path. Returns false, and does nothing, if the path already has [`MAX_PIECES`] pieces.
    pub fn push(&mut self, piece: Piece) -> bool {
        let Some(slot) = self.pieces.get_mut(self.count) else {
            return false;
        };
        *slot = Some(piece);
        self.starts[self.count] = self.length;
        self.length += piece.length();
        self.count += 1;
        true
    }

    /// Returns the maximum value of the path parameter, m.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Returns true if a piece of the path belongs to a spline, whose curvature changes along its whole length.
    #[must_use]
    pub fn has_spline(&self) -> bool {
        self.pieces().any(|piece| matches!(piece, Piece::Spline(_)))
    }

    fn pieces(&self) -> impl Iterator<Item = &Piece> {
        self.pieces.iter().flatten()
    }

    /// Returns the places with `from < s <= to` at which two pieces of a spline meet, in order.
    pub(crate) fn kinks_between(&self, from: f64, to: f64) -> impl Iterator<Item = Kink> + '_ {
        let is_spline = |k: usize| matches!(self.pieces[k], Some(Piece::Spline(_)));
        let borders = (1..self.count).map(|k| Kink {
            s: self.starts[k],
            piece_before: k - 1,
        });
        borders.filter(move |kink| {
            kink.s > from
                && kink.s <= to
                && is_spline(kink.piece_before)
                && is_spline(kink.piece_before + 1)
        })
    }

    /// Returns the pose of the tool in the base frame at the position `s` (m) along the path on the piece with the index
    /// `piece`, which is continued beyond its ends; `None` if there is no such piece.
    pub(crate) fn pose_on_piece(&self, piece: usize, s: f64) -> Option<Pose> {
        let own = s - self.starts.get(piece)?;
        Some(self.pieces[piece].as_ref()?.pose(own))
    }

    /// Returns the curvature on both sides of a kink.
    pub(crate) fn curvatures_beside(&self, kink: Kink) -> impl Iterator<Item = Curvature> + '_ {
        let pieces = [kink.piece_before, kink.piece_before + 1];
        pieces.into_iter().filter_map(move |k| {
            let own = kink.s - self.starts.get(k)?;
            Some(self.pieces[k].as_ref()?.curvature(own))
        })
    }

    fn piece_at(&self, s: f64) -> Option<(&Piece, f64)> {
        let behind = self.starts[..self.count].partition_point(|start| *start <= s);
        let k = behind.saturating_sub(1);
        let piece = self.pieces[k].as_ref()?;
        Some((piece, s - self.starts[k]))
    }

    /// Returns the pose of the tool in the base frame at the position `s` (m) along the path.
    #[must_use]
    pub fn pose(&self, s: f64) -> Pose {
        self.piece_at(s)
            .map_or_else(Pose::identity, |(piece, own)| piece.pose(own))
    }

    /// Returns the maximum distance (m) between two places near `s` for which the curvature is known well enough in
    /// between.
    fn resolution(&self, s: f64) -> f64 {
        match self.piece_at(s) {
            Some((Piece::Corner(corner), _)) => corner.length() / CORNER_SAMPLES,
            Some((Piece::Spline(curve), own)) => spline_resolution(curve.curvature(own)),
            _ => f64::INFINITY,
        }
    }

    fn curvature(&self, s: f64) -> Curvature {
        self.piece_at(s)
            .map_or_else(Curvature::default, |(piece, own)| piece.curvature(own))
    }
}

/// Returns the maximum distance (m) between two places on a spline with this curvature for which it is known well enough
/// in between; infinite for gentle curves, which the usual distance of nodes resolves.
fn spline_resolution(curvature: Curvature) -> f64 {
    /// Maximum relative change of the curvature between two places. The error of a linear interpolation is about a
    /// quarter of its square.
    const CHANGE: f64 = 0.06;
    /// Curvature (1/m) below which only its absolute change counts: at a point of inflection it is 0.
    const GENTLE: f64 = 30.0;
    /// Distance from which on the curve is gentle, m.
    const WIDE: f64 = 2e-3;
    let distance = CHANGE * curvature.value.max(GENTLE) / libm::fabs(curvature.slope);
    if distance < WIDE {
        distance
    } else {
        f64::INFINITY
    }
}

impl Path {
    /// Creates the path of one straight line of the tool from one pose to another, both in the base frame.
    #[must_use]
    pub fn line(from: &Pose, to: &Pose) -> Self {
        Path::Tool(ToolPath::new(Piece::Line(Line::new(from, to))))
    }

    /// Creates the straight line in joint space between two sets of joint positions (rad), of which the `axes` first
    /// ones move.
    #[must_use]
    pub fn joint_line(from: &Joints, to: &Joints, axes: usize) -> Self {
        Path::Joints(JointLine::new(from, to, axes))
    }

    /// Returns the maximum value of the path parameter: m, or rad of the axis that moves farthest on a joint line.
    #[must_use]
    pub fn length(&self) -> f64 {
        match self {
            Path::Tool(path) => path.length(),
            Path::Joints(line) => line.length(),
        }
    }

    /// Returns the distance that the tool travels, m; for a joint line, the distance of the axis that moves farthest,
    /// rad.
    #[must_use]
    pub fn way(&self) -> f64 {
        match self {
            Path::Tool(path) => path.pieces().map(Piece::way).sum(),
            Path::Joints(line) => line.length(),
        }
    }

    /// Returns the maximum distance between two places near `s` for which the curvature is known well enough in
    /// between, m; infinite if the curvature is known everywhere.
    #[must_use]
    pub fn resolution(&self, s: f64) -> f64 {
        match self {
            Path::Tool(path) => path.resolution(s),
            Path::Joints(_) => f64::INFINITY,
        }
    }

    /// Returns the curvature of the path of the tool at the position `s` (m) along it; 0 for a joint line.
    #[must_use]
    pub fn curvature(&self, s: f64) -> Curvature {
        match self {
            Path::Tool(path) => path.curvature(s),
            Path::Joints(_) => Curvature::default(),
        }
    }
}
