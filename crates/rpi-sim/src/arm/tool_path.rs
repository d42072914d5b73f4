//! Paths of the tool as programs request them: from the arguments of a motion function to a path.

use super::motion::SHORTEST_WAY;
use crate::device::{pose_from, real_at};
use crate::error_code::ErrorCode;
use nalgebra::Vector3;
use rpi_kin::Pose;
use rpi_kin::rotation::angle_between;
use rpi_motion::Path;
use rpi_motion::path::line::TURNING_LENGTH;
use rpi_motion::path::spline::{MAX_POINTS, SHORTEST_CHORD};
use rpi_motion::path::{Arc, ArcError, ArcOrientation, Piece, SplineError, ToolPath};

/// Kind of a path of the tool, with the target that the calling command passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ToolPathKind {
    /// Straight line. Target: the end pose.
    Line,
    /// Arc through a point. Target: the via pose and the end pose.
    Arc,
    /// Arc about a centre. Target: the centre and the end pose.
    ArcByCentre,
    /// Arc by an angle. Target: centre, axis, angle (rad), and whether the tool turns with the arc.
    ArcByAngle,
    /// Two straight lines with a rounded corner between them. Target: the via pose, the end pose and the zone of the
    /// corner (m).
    Corner,
    /// Smooth curve through points. Target: one pose for each point.
    Spline,
}

/// Number of 64-bit slots of a vector in memory.
const VECTOR: usize = 3;
/// Number of 64-bit slots of a pose in memory.
const POSE: usize = 7;

/// Returns the path of the tool from the pose `start` to a target, given as slots.
///
/// # Errors
/// The error code of the reason why there is no such path. If a number of the target is not finite, the result may also
/// be a path whose length is not finite.
pub(super) fn tool_path(
    kind: ToolPathKind,
    start: &Pose,
    target: &[u64],
) -> Result<Path, ErrorCode> {
    match kind {
        ToolPathKind::Line => Ok(Path::line(start, &pose_from(target))),
        ToolPathKind::Arc => {
            let (via, to) = split(target, POSE);
            let via = pose_from(via).translation.vector;
            arc(Arc::via(start, &via, &pose_from(to)))
        }
        ToolPathKind::ArcByCentre => {
            let (centre, to) = split(target, VECTOR);
            arc(Arc::by_centre(start, &vector_from(centre), &pose_from(to)))
        }
        ToolPathKind::ArcByAngle => arc(arc_by_angle(start, target)),
        ToolPathKind::Corner => corner(start, target),
        ToolPathKind::Spline => spline(start, target),
    }
}

/// Splits the slots of a target before the slot `at`; missing slots make a part shorter or empty.
fn split(target: &[u64], at: usize) -> (&[u64], &[u64]) {
    target.split_at(at.min(target.len()))
}

fn vector_from(target: &[u64]) -> Vector3<f64> {
    Vector3::from_fn(|k, _| real_at(target, k))
}

fn arc(arc: Result<Arc, ArcError>) -> Result<Path, ErrorCode> {
    match arc {
        Ok(arc) => Ok(Path::Tool(ToolPath::new(Piece::Arc(arc)))),
        Err(ArcError::Colinear) => Err(ErrorCode::COLINEAR),
        Err(ArcError::UnequalRadii) => Err(ErrorCode::UNEQUAL_RADII),
        Err(ArcError::NoAngle) => Err(ErrorCode::NO_ANGLE),
        Err(ArcError::OnAxis) => Err(ErrorCode::ON_AXIS),
    }
}

fn arc_by_angle(start: &Pose, target: &[u64]) -> Result<Arc, ArcError> {
    let (centre, rest) = split(target, VECTOR);
    let (axis, rest) = split(rest, VECTOR);
    let orientation = match rest.get(1) {
        Some(0) | None => ArcOrientation::Fixed,
        Some(_) => ArcOrientation::Turning,
    };
    let (centre, axis) = (vector_from(centre), vector_from(axis));
    Arc::by_angle(start, &centre, &axis, real_at(rest, 0), orientation)
}

/// Returns the path from `start` over a via pose to an end pose with a rounded corner. The target, in slots, is via
/// pose, end pose and zone (m).
fn corner(start: &Pose, target: &[u64]) -> Result<Path, ErrorCode> {
    let (via, rest) = split(target, POSE);
    let (via, to) = (pose_from(via), pose_from(rest));
    let zone = real_at(rest, POSE);
    if (via.translation.vector - start.translation.vector).norm() < SHORTEST_WAY {
        return Ok(Path::line(start, &to));
    }
    let path = ToolPath::polyline(&[*start, via, to], &[zone]);
    path.map(Path::Tool).map_err(|_| ErrorCode::NO_CORNER)
}

/// Returns the spline from `start` through the poses of the target, given as slots. A first pose equal to `start` is
/// left out, but counts as a point of the path.
fn spline(start: &Pose, target: &[u64]) -> Result<Path, ErrorCode> {
    let mut points = [*start; MAX_POINTS];
    let (mut count, mut at_start) = (1, 0);
    for slots in target.chunks(POSE) {
        let point = pose_from(slots);
        if count == 1 && is_at(start, &point) {
            at_start += 1;
            continue;
        }
        *points.get_mut(count).ok_or(ErrorCode::TOO_MANY_POINTS)? = point;
        count += 1;
    }
    if count == 1 {
        return Ok(Path::line(start, start));
    }
    let path = ToolPath::spline(&points[..count]).map_err(|error| match error {
        SplineError::Counts => ErrorCode::TOO_MANY_POINTS,
        SplineError::SamePoint(_) => ErrorCode::SAME_POINT,
        SplineError::Reversal(_) => ErrorCode::REVERSAL,
        SplineError::TurningDecides(_) => ErrorCode::TURNING_DECIDES,
    });
    path.map(|path| Path::Tool(path.with_points_at_start(at_start)))
}

/// Returns true if two poses are equal, apart from rounding.
fn is_at(one: &Pose, other: &Pose) -> bool {
    let turn = angle_between(&one.rotation, &other.rotation);
    (one.translation.vector - other.translation.vector).norm() < SHORTEST_CHORD
        && turn * TURNING_LENGTH < SHORTEST_CHORD
}
