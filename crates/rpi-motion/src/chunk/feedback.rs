//! Feedback of one axis: the jerk that leads it back to its curve.
//!
//! Small deviations are corrected by a linear feedback, larger ones along the fastest motion to the curve. This motion may use
//! what the curve leaves of the bounds of the axis. If it could not use as much of them as the guard does, such as at the end of the
//! range, the axis would gain a velocity there that its way back could not brake, and it would swing around its curve.

use super::state::is_within;
use crate::online::{AxisLimits, MotionOptions, OnlineMotion};
use rpi_kin::state_to_rest::{AxisState, Bounds};

/// Deviations of position (rad), velocity (rad/s) and acceleration (rad/s²) up to which a linear feedback corrects them.
pub(super) const LINEAR: [f64; 3] = [1e-6, 1e-4, 1e-2];

/// Rate of the linear feedback as a share of the rate of the set-points.
const FEEDBACK: f64 = 0.1;

/// Share of the bounds that the linear feedback may use for larger deviations, too.
const SMALL: f64 = 0.02;

/// Smallest share of the bounds with which an axis that deviates is led back to its curve.
const LEAST_LEFT: f64 = 0.2;

/// Returns the jerk (rad/s³), beside that of the curve, that leads an axis with the difference `error` back to it within `period`
/// seconds and the following ones. `used` are bounds of velocity, acceleration and jerk that the curve needs: rad/s, rad/s², rad/s³.
pub(super) fn correction(bounds: &Bounds, used: [f64; 3], error: AxisState, period: f64) -> f64 {
    let rate = FEEDBACK / period;
    let parts = [
        rate * rate * rate * error.position,
        3.0 * rate * rate * error.velocity,
        3.0 * rate * error.acceleration,
    ];
    // A motion that takes less than a period would not move the axis at all.
    let most = SMALL * bounds.jerk.min(bounds.acceleration * rate);
    if is_within(&error, LINEAR) || parts.iter().all(|part| part.abs() <= most) {
        return -parts.iter().sum::<f64>();
    }
    let left = |bound: f64, used: f64| (bound - used).max(LEAST_LEFT * bound);
    let limits = [AxisLimits::from(Bounds {
        speed: left(bounds.speed, used[0]),
        acceleration: left(bounds.acceleration, used[1]),
        jerk: left(bounds.jerk, used[2]),
    })];
    let rest = [AxisState::default()];
    match OnlineMotion::to_position(&[error], &rest, &limits, MotionOptions::default()) {
        Ok(plan) => {
            let next = plan.axes()[0].state_at(period);
            (next.acceleration - error.acceleration) / period
        }
        Err(_) => 0.0,
    }
}

/// Returns the distance (rad) of an axis with the difference `error` from its curve, with the distance in which its velocity can be
/// braked with the smallest share of the bounds.
pub(super) fn reach(bounds: &Bounds, error: &AxisState) -> f64 {
    reach_with(bounds, error, LEAST_LEFT)
}

/// Returns the distance (rad) of an axis with the difference `error` from its curve, with the distance in which its velocity can be
/// braked with a `share` of the bounds.
pub(super) fn reach_with(bounds: &Bounds, error: &AxisState, share: f64) -> f64 {
    let [most, jerk] = [bounds.acceleration, bounds.jerk].map(|bound| share * bound);
    let gain = error.acceleration * error.acceleration.abs() / (2.0 * jerk);
    let velocity = (error.velocity + gain).abs();
    error.position.abs() + velocity * (velocity / most + most / jerk) / 2.0
}
