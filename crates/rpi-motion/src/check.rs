//! Check of a whole path before anything moves.

use crate::node_table::NodeTable;
use crate::path::{Path, ToolPath};
use crate::path_error::{PathError, PathErrorKind};
use crate::{Arm, Joints};
use rpi_kin::InverseKinematicsError;
use rpi_kin::state_to_rest::Bounds;

/// Result of checking a path: its end, its slowest place and the size of the check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathReport {
    /// Joints at the end of the path, rad.
    pub end: Joints,
    /// Lowest velocity of the path parameter that the limits of the axes enforce, and the value of the path parameter
    /// where they do.
    pub slowest: (f64, f64),
    /// Number of places at which the derivatives of the joints were computed.
    pub nodes: usize,
}

/// Number of places of a path that [`scan_path`] checks first.
const SCANNED: u32 = 16;

/// Number of bisection steps with which [`scan_path`] locates an error.
const HALVINGS: u32 = 12;

/// Looks at a few places of a path before anything moves: whether the inverse kinematics has a solution there, and
/// whether the end of a joint line lies within the ranges. For the cycle: at most 28 inverses, about 50 µs. A change of
/// configuration, a singularity, or a gap between the places is found only by [`check_path`], or on the way.
///
/// # Errors
/// The first place that the arm cannot pass, as far as this shows it.
pub fn scan_path(arm: &Arm, path: &Path, start: &Joints) -> Result<(), PathError> {
    let tool = match path {
        Path::Joints(line) => {
            return check_ranges(arm, &line.joints(line.length()), start, line.length());
        }
        Path::Tool(tool) => tool,
    };
    let angle = arm.arm_angle(start).unwrap_or(0.0);
    let (mut good, mut hint) = (0.0, *start);
    for number in 1..=SCANNED {
        let s = tool.length() * f64::from(number) / f64::from(SCANNED);
        match arm.inverse(&tool.pose(s), &hint, angle) {
            Ok((joints, _)) => (good, hint) = (s, joints),
            Err(error) => return Err(narrowed(arm, tool, start, (good, hint), (s, error))),
        }
    }
    Ok(())
}

/// Bisects between a place that can be reached and one that cannot. Returns the error at the nearest place found.
fn narrowed(
    arm: &Arm,
    tool: &ToolPath,
    start: &Joints,
    (mut good, mut hint): (f64, Joints),
    (mut bad, mut error): (f64, InverseKinematicsError),
) -> PathError {
    let angle = arm.arm_angle(start).unwrap_or(0.0);
    for _ in 0..HALVINGS {
        let s = (good + bad) / 2.0;
        match arm.inverse(&tool.pose(s), &hint, angle) {
            Ok((joints, _)) => (good, hint) = (s, joints),
            Err(other) => (bad, error) = (s, other),
        }
    }
    PathError {
        s: bad,
        kind: PathErrorKind::NoInverse(error),
    }
}

/// Checks that all axes end within their ranges, or no farther out than they start. The error names the first axis that
/// does not.
fn check_ranges(arm: &Arm, end: &Joints, start: &Joints, length: f64) -> Result<(), PathError> {
    for (axis, limits) in arm.limits().iter().enumerate() {
        let range = limits.position;
        let (lower, upper) = (range.lower.min(start[axis]), range.upper.max(start[axis]));
        if !(lower..=upper).contains(&end[axis]) {
            return Err(PathError {
                s: length,
                kind: PathErrorKind::OutOfRange { axis },
            });
        }
    }
    Ok(())
}

/// Follows a path from its start to its end: reach, ranges, configuration and singular places. `start` are joints at
/// its start, or near to them. Not for the cycle: it takes about 4 µs a node, 500 to 4 000 nodes a metre; allocates.
///
/// # Errors
/// The first place that the arm cannot pass.
pub fn check_path(
    arm: &Arm,
    path: Path,
    start: &Joints,
    requested: Bounds,
) -> Result<PathReport, PathError> {
    let mut table = NodeTable::with_capacity(64);
    table.begin(arm, path, start, requested)?;
    let mut report = PathReport {
        end: *start,
        slowest: (f64::INFINITY, 0.0),
        nodes: 1,
    };
    let mut is_growing = true;
    while is_growing {
        let newest = *table.newest();
        if newest.most.velocity < report.slowest.0 {
            report.slowest = (newest.most.velocity, newest.s);
        }
        is_growing = table.extend(arm, 1, newest.s - 1e-9) > 0;
        if let Some(error) = table.error() {
            return Err(error);
        }
        report.nodes += usize::from(is_growing);
    }
    let hint = table.newest().joints;
    report.end = table.joints_at(arm, path.length(), &hint)?;
    Ok(report)
}
