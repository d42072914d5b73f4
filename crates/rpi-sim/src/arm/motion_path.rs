//! Paths of the motion functions, from where the arm can stop.

use super::kinematics::PerAxis;
use super::motion::PathKind;
use super::path_fault::PathFault;
use super::tool_path::tool_path;
use crate::error_code::ErrorCode;
use rpi_motion::{Arm, JointState, Path, path_start, scan_path};

/// Returns the path to the target of a request, and the joint positions (rad) at its start: where the arm can stop, so
/// that it need not swing back. If the path is not possible from there, it begins at the present position.
///
/// [`scan_path`] has checked the path.
pub(super) fn path_from_stop(
    arm: &Arm,
    kind: PathKind,
    state: &JointState,
    target: &[u64],
) -> Result<(Path, PerAxis), PathFault> {
    let here = path(arm, kind, &state.position, target)?;
    let start = path_start(arm, state, &here);
    if start != state.position
        && let Ok(moved) = path(arm, kind, &start, target)
        && scan_path(arm, &moved, &start).is_ok()
    {
        return Ok((moved, start));
    }
    match scan_path(arm, &here, &state.position) {
        Ok(()) => Ok((here, state.position)),
        Err(error) => Err(PathFault::new(&error, &here, arm.limits())),
    }
}

/// Returns the path of this kind from the joint positions `from` (rad) to the target, given as slots.
fn path(arm: &Arm, kind: PathKind, from: &PerAxis, target: &[u64]) -> Result<Path, ErrorCode> {
    let path = match kind {
        PathKind::Tool(kind) => tool_path(kind, &arm.forward(from), target)?,
        PathKind::Joints => {
            let mut to = PerAxis::default();
            let slots = to.iter_mut().zip(target).take(arm.axes());
            slots.for_each(|(slot, bits)| *slot = f64::from_bits(*bits));
            Path::joint_line(from, &to, arm.axes())
        }
    };
    match path.length().is_finite() {
        true => Ok(path),
        false => Err(ErrorCode::NOT_A_NUMBER),
    }
}
