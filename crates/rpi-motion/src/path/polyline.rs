//! Straight lines through points, with corners within zones.

use super::corner::{Corner, turn_between};
use super::line::Line;
use super::{MAX_PIECES, Piece, ToolPath};
use core::f64::consts::PI;
use rpi_kin::Pose;

/// Reason why points and zones do not define a path of straight lines with rounded corners. Points are counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZoneError {
    /// There are fewer than two points, or the number of zones differs from the number of inner points.
    Counts,
    /// The path would have more than [`MAX_PIECES`] pieces.
    TooManyPoints,
    /// The point with this number and the next one coincide.
    SamePoint(usize),
    /// The zone at the point with this number is not positive. A path cannot turn without a zone; the motion must end
    /// there.
    NoZone(usize),
    /// The path turns back at the point with this number, by more than a rounded corner can (175°).
    Reversal(usize),
    /// The tool turns so far on the line to or from the point with this number that the turning decides the speed. A
    /// rounded corner is not possible there.
    TurningDecides(usize),
}

impl core::fmt::Display for ZoneError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            ZoneError::Counts => f.write_str(
                "a path needs two points or more, and one zone for each point between the ends",
            ),
            ZoneError::TooManyPoints => f.write_str("the path has too many points"),
            ZoneError::SamePoint(k) => write!(f, "points {k} and {} are the same", k + 1),
            ZoneError::NoZone(k) => write!(f, "the zone of point {k} is not positive"),
            ZoneError::Reversal(k) => write!(f, "the path turns back at point {k}"),
            ZoneError::TurningDecides(k) => {
                write!(
                    f,
                    "the tool turns too far beside point {k} for a zone there"
                )
            }
        }
    }
}

impl core::error::Error for ZoneError {}

/// Minimum distance between two points, and minimum length of a line between two corners, m.
const SHORTEST: f64 = 1e-9;

/// Maximum change of direction at a rounded corner, rad. Beyond it, the curvature grows without bound.
const GREATEST_TURN: f64 = PI * 175.0 / 180.0;

impl ToolPath {
    /// Creates the path through `points` (poses of the tool in the base frame) along straight lines. At each inner
    /// point, a corner within its zone (m) is rounded, at most half of the shorter line beside it. The path depends on
    /// points and zones alone, not on the speed.
    ///
    /// # Errors
    /// A [`ZoneError`] that names the point, counted from 0.
    pub fn polyline(points: &[Pose], zones: &[f64]) -> Result<Self, ZoneError> {
        if points.len() < 2 || zones.len() + 2 != points.len() {
            return Err(ZoneError::Counts);
        }
        if 2 * points.len() - 3 > MAX_PIECES {
            return Err(ZoneError::TooManyPoints);
        }
        let line = |k: usize| Line::new(&points[k], &points[k + 1]);
        let mut path = Self::empty();
        let mut begin = 0.0;
        for k in 0..points.len() - 1 {
            let here = line(k);
            if is_short(here.length()) {
                return Err(ZoneError::SamePoint(k));
            }
            let Some(zone) = zones.get(k) else {
                path.push_section(&here, begin, here.length());
                break;
            };
            let next = line(k + 1);
            let zone = checked_zone(&here, &next, *zone, k + 1)?;
            path.push_section(&here, begin, here.length() - zone);
            path.push(Piece::Corner(Corner::new(&here, &next, zone)));
            begin = zone;
        }
        Ok(path)
    }

    /// Appends the section of a line from `from` to `to` (m along it), unless it has no length, because two corners
    /// touch.
    fn push_section(&mut self, line: &Line, from: f64, to: f64) {
        if to - from > SHORTEST {
            self.push(Piece::Line(line.section(from, to)));
        }
    }
}

/// Returns true if a length (m) is too small for a line, or not a number.
fn is_short(length: f64) -> bool {
    length <= SHORTEST || length.is_nan()
}

fn checked_zone(before: &Line, after: &Line, zone: f64, point: usize) -> Result<f64, ZoneError> {
    if is_short(after.length()) {
        return Err(ZoneError::SamePoint(point));
    }
    if zone <= 0.0 || zone.is_nan() {
        return Err(ZoneError::NoZone(point));
    }
    if !(before.is_by_length() && after.is_by_length()) {
        return Err(ZoneError::TurningDecides(point));
    }
    if turn_between(&before.direction(), &after.direction()) > GREATEST_TURN {
        return Err(ZoneError::Reversal(point));
    }
    Ok(zone.min(before.length() / 2.0).min(after.length() / 2.0))
}
