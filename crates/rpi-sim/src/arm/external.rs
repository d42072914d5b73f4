//! What a driver sets in an arm whose controller it is connected to.

use super::Arm;
use super::axis::Axis;
use crate::error_code::ErrorCode;
use rpi_kin::MAX_AXES;

/// Sets the positions (rad or m) that a controller has measured. They replace the simulated ones from the next tick on.
pub(crate) fn set_measured(arm: &mut Arm, positions: &[f64; MAX_AXES]) {
    arm.sensing.external = Some(*positions);
}

/// Sets the failure of the controller of the arm; the code 0 clears it. With a failure, the arm brakes and rejects all
/// set-points.
pub(crate) fn set_failure(arm: &mut Arm, code: ErrorCode) {
    arm.faults.external = code;
}

/// Moves the arm at once to these joint positions (rad or m), at rest.
pub(crate) fn place(arm: &mut Arm, positions: &[f64; MAX_AXES]) {
    for (axis, position) in arm.axes.iter_mut().zip(positions) {
        let code = axis.code;
        *axis = Axis::new(*position, axis.limits);
        axis.code = code;
    }
    arm.brake = None;
    arm.ticks_left = 0;
    arm.motion.end_braking();
}

/// Returns the positions of the drives, in rad or m; 0 beyond the number of axes.
pub(crate) fn driven(arm: &Arm) -> [f64; MAX_AXES] {
    let mut positions = [0.0; MAX_AXES];
    let axes = positions.iter_mut().zip(&arm.axes);
    axes.for_each(|(position, axis)| *position = axis.driven);
    positions
}
