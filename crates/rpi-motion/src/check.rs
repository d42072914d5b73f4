//! Check of a whole path before anything moves.

use crate::joint_path::JointPath;
use crate::node_table::NodeTable;
use crate::path::Path;
use crate::path_error::{PathError, PathErrorKind};
use crate::ranges::{Ranges, first_outside, path_ranges};
use crate::speed_limit::{SpeedLimit, slower};
use crate::{Arm, Joints};
use rpi_kin::state_to_rest::Bounds;

/// Result of checking a path: the end of the path, its slowest place and the size of the check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathReport {
    /// Joint positions at the end of the path, rad.
    pub end: Joints,
    /// Place at which the path is followed most slowly; `None` if the requested speed is possible everywhere.
    pub limit: Option<SpeedLimit>,
    /// Number of places on the path at which the derivatives of the joint positions were computed.
    pub nodes: usize,
}

/// Number of steps in which [`scan_path`] checks a path on which no step fails.
const STEPS: f64 = 32.0;
/// Maximum number of inverse kinematics that [`scan_path`] computes.
const PLACES: usize = 80;

/// Distance along the path (m) below which two places are next to each other, so that a failure between them is an
/// error and not a reason for a shorter step.
const ADJACENT: f64 = 1e-5;

/// Change of an axis between two places, rad, above which the arm may be in another configuration. If the places are
/// next to each other, it is.
const JUMP: f64 = 0.3;

/// Checks a few places of a path before the arm moves: whether the inverse kinematics has a solution there, whether a
/// six-axis arm stays in its configuration between them, and whether the end of a line in joint space lies within the
/// ranges. `start` are the joint positions (rad) at the start. For the cycle: at most 80 inverse kinematics, about 100
/// µs. A singularity, or a gap between the checked places, is found only by [`check_path`], or by the motion itself.
///
/// # Errors
/// The first place found that the arm cannot pass.
pub fn scan_path(arm: &Arm, path: &Path, start: &Joints) -> Result<(), PathError> {
    let length = path.length();
    if let Path::Joints(line) = path {
        let end = line.joints(length);
        return check_place(arm, &path_ranges(arm, path, start), &end, length);
    }
    let (joint_path, widest) = (JointPath::new(arm, *path, start), length / STEPS);
    let (ranges, mut outside) = (path_ranges(arm, path, start), None);
    let (mut s, mut joints, mut step) = (0.0, *start, widest);
    for _ in 0..PLACES {
        let next = (s + step).min(length);
        match step_to(arm, &joint_path, next, &joints) {
            Ok(found) => {
                // A redundant arm can change its arm angle before an axis comes near to the end of its range.
                if !joint_path.is_redundant() && outside.is_none() {
                    outside = check_place(arm, &ranges, &found, next).err();
                }
                (s, joints, step) = (next, found, widest.min(2.0 * step));
                if s >= length {
                    break;
                }
            }
            Err(error) if step < ADJACENT => {
                let error = joint_path.with_axis(arm, error, &joints);
                return Err(earlier(outside, error));
            }
            Err(_) => step /= 2.0,
        }
    }
    outside.map_or(Ok(()), Err)
}

/// Returns the error to report if a path first leads out of a range and then fails with `error`: the first one, except
/// where the arm would have to change its configuration because of the range.
fn earlier(outside: Option<PathError>, error: PathError) -> PathError {
    match error.kind {
        PathErrorKind::ConfigurationChange { .. } => error,
        _ => outside.unwrap_or(error),
    }
}

/// Returns the joint positions (rad) at the place `s` of the path, near to `from` (rad). A large change of an axis is
/// an error, except for a redundant arm, which may keep its configuration by another arm angle.
fn step_to(arm: &Arm, path: &JointPath, s: f64, from: &Joints) -> Result<Joints, PathError> {
    let joints = path.solution_at(arm, s, from)?;
    let jumps = |axis: &usize| libm::fabs(joints[*axis] - from[*axis]) > JUMP;
    match (0..arm.axes()).find(jumps) {
        Some(axis) if !path.is_redundant() => Err(PathError {
            s,
            kind: PathErrorKind::ConfigurationChange { axis },
        }),
        _ => Ok(joints),
    }
}

/// Checks that all axes are within `ranges` at the place `s` of a path, where the joint positions are `joints` (rad).
/// The error names the first axis that is not.
fn check_place(arm: &Arm, ranges: &Ranges, joints: &Joints, s: f64) -> Result<(), PathError> {
    let kind = first_outside(arm, ranges, joints).map(|axis| PathErrorKind::OutOfRange { axis });
    kind.map_or(Ok(()), |kind| Err(PathError { s, kind }))
}

/// Follows a path from its start to its end and checks reach, ranges, configuration and singularities. `start` are
/// joint positions (rad) at its start, or near to them; `requested` are the bounds of the tool along the path. Not for
/// the cycle: it takes about 4 µs for each of 500 to 4 000 places per metre, and allocates.
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
        limit: None,
        nodes: 1,
    };
    let mut is_growing = true;
    while is_growing {
        let newest = *table.newest();
        report.limit = slower(report.limit, newest.speed_limit());
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
