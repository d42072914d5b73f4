//! Ranges of the axes that paths and motions keep. Check, path and motion use them alike, so that an arm never stands
//! before a place that the check has accepted.

use crate::path::Path;
use crate::{Arm, Joints};
use rpi_kin::{MAX_AXES, Range};

/// Distance that motions keep from the ends of the range of an axis, rad.
const MARGIN: f64 = 1e-4;

/// Distance that a path of the tool keeps from the ends of the range of an axis, rad. Motions keep half of it, so that
/// the arm can move on at a place where the path turns back.
pub(crate) const PATH_MARGIN: f64 = 2.0 * MARGIN;

/// Distance by which an axis may be beyond the end of its range due to rounding, rad.
const ROUNDING: f64 = 1e-12;

/// Ranges of all axes, rad.
pub type Ranges = [Range; MAX_AXES];

/// Returns the ranges that a motion keeps: the ranges of the axes, less a margin. If an axis starts nearer to the end
/// of its range, or beyond it, its start position is the end: the axis may move back, but not farther out.
#[must_use]
pub fn allowed_ranges(arm: &Arm, start: &Joints) -> Ranges {
    with_margin(arm, start, MARGIN)
}

/// Returns the ranges in which a path with the joint positions `start` (rad) at its start must lie. A path of the tool
/// keeps a margin, because its joint positions are known at its nodes only; a joint line may lead to the very end of a
/// range.
pub(crate) fn path_ranges(arm: &Arm, path: &Path, start: &Joints) -> Ranges {
    match path {
        Path::Tool(_) => with_margin(arm, start, PATH_MARGIN),
        Path::Joints(_) => with_margin(arm, start, 0.0),
    }
}

/// Returns the ranges of the axes, each extended to the position of the axis in `start` (rad).
pub(crate) fn whole_ranges(arm: &Arm, start: &Joints) -> Ranges {
    with_margin(arm, start, 0.0)
}

/// Returns the first axis (from 0) that is outside of `ranges`, or not a number, at the joint positions `joints` (rad).
pub(crate) fn first_outside(arm: &Arm, ranges: &Ranges, joints: &Joints) -> Option<usize> {
    (0..arm.axes()).find(|axis| !ranges[*axis].contains(joints[*axis]))
}

/// Extends `ranges` to the surroundings of a place `at` (rad) of a path, so that a motion can turn back there, as far
/// as they lie within the ranges of the axes.
pub(crate) fn extend_around(ranges: &mut Ranges, arm: &Arm, at: &Joints) {
    for (axis, limits) in arm.limits().iter().enumerate() {
        for place in [at[axis] - MARGIN, at[axis] + MARGIN] {
            let within = place.max(limits.position.lower).min(limits.position.upper);
            ranges[axis] = extended(ranges[axis], within);
        }
    }
}

fn with_margin(arm: &Arm, start: &Joints, margin: f64) -> Ranges {
    let mut ranges = [Range::symmetric(0.0); MAX_AXES];
    for (axis, limits) in arm.limits().iter().enumerate() {
        let inner = limits.position.shrunk(margin - ROUNDING);
        ranges[axis] = extended(inner, start[axis]);
    }
    ranges
}

fn extended(range: Range, place: f64) -> Range {
    Range {
        lower: range.lower.min(place - ROUNDING),
        upper: range.upper.max(place + ROUNDING),
    }
}
