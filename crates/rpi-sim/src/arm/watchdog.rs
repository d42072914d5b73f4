//! Watchdog of an arm: the number of missing set-points that the arm bridges before it brakes.

use super::Arm;
use super::axis::Axis;

/// Continues the moving axes that have no set-point in this tick with their accelerations, as the controllers of Franka
/// arms do. Returns false, and the arm must brake, if set-points have been missing for as many periods as the watchdog
/// allows, or if the continued motion would exceed a limit.
pub(super) fn bridge_missing_set_points(arm: &mut Arm) -> bool {
    arm.missed_periods = arm.missed_periods.saturating_add(1);
    if arm.missed_periods >= arm.watchdog_periods {
        return false;
    }
    let period = arm.tick * f64::from(arm.set_point_ticks);
    for axis in arm.axes.iter_mut().filter(|axis| axis.lacks_set_point()) {
        let target = continued_position(axis, period);
        let Ok(next) = axis.check_set_point(target, period, arm.enforced) else {
            return false;
        };
        axis.staged = Some(next);
    }
    arm.axes.iter_mut().for_each(Axis::apply_set_point);
    arm.ticks_left = arm.set_point_ticks;
    arm.motion.set_accepted_period(period);
    true
}

/// Returns the position (rad or m) of an axis after a further period of `period` seconds with its present acceleration.
/// A decelerating axis stops instead of reversing.
fn continued_position(axis: &Axis, period: f64) -> f64 {
    let state = &axis.commanded;
    let velocity = state.velocity + state.acceleration * period;
    match velocity * state.velocity > 0.0 {
        true => state.position + velocity * period,
        false => state.position,
    }
}
