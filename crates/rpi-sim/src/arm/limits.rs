//! Limit checks of a controller for the set-points of one axis.
//!
//! Velocity, acceleration and jerk are backward differences of the set-points over their period. Franka's control
//! interface checks motions by the same definition (frankarobotics.github.io, robot specifications).

use crate::cell::EnforcedLimits;
use crate::error_code::ErrorCode;
use rpi_kin::AxisLimits;

/// Position, velocity and acceleration of an axis, in rad, rad/s and rad/s² (m instead of rad for a linear axis).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxisState {
    /// Position of the axis, rad.
    pub position: f64,
    /// Velocity of the axis, rad/s.
    pub velocity: f64,
    /// Acceleration of the axis, rad/s².
    pub acceleration: f64,
}

/// Violation of a limit by a set-point, or another error with its values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// Error code of the violated limit.
    pub code: ErrorCode,
    /// Value that violates the limit, in rad and s (m and s for a linear axis).
    pub value: f64,
    /// Violated limit, in rad and s (m and s for a linear axis).
    pub limit: f64,
}

/// Velocity in rad/s up to which an axis counts as at rest: a nanometre per millisecond at a distance of one metre.
const REST_VELOCITY: f64 = 1e-6;

/// Share by which a velocity, acceleration or jerk may exceed its limit, so that rounding does not reject a set-point
/// on the limit.
const LIMIT_TOLERANCE: f64 = 1e-6;
/// Angle by which a position may exceed its range, rad, so that rounding does not reject a set-point at the end of the
/// range.
const POSITION_TOLERANCE: f64 = 1e-9;

impl Violation {
    /// Creates the violation for an error code that has no value and no limit.
    #[must_use]
    pub const fn from_code(code: ErrorCode) -> Self {
        Self {
            code,
            value: 0.0,
            limit: 0.0,
        }
    }
}

impl AxisState {
    /// Creates the state of an axis at rest at `position` (rad).
    #[must_use]
    pub const fn at_rest(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
        }
    }

    /// Returns the state after the set-point `target` (rad), which follows the previous one after `period` (s).
    /// Velocity and acceleration are backward differences.
    #[must_use]
    pub fn after_set_point(&self, target: f64, period: f64) -> Self {
        let velocity = (target - self.position) / period;
        Self {
            position: target,
            velocity,
            acceleration: (velocity - self.velocity) / period,
        }
    }

    /// True if the velocity of the axis is not zero, apart from rounding.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.velocity.abs() > REST_VELOCITY
    }
}

/// Checks the set-point `target` (rad), which follows the state `before` after `period` (s), against the enforced ones
/// among the limits. Returns the state that it leads to, or the violated limit.
pub(super) fn check_set_point(
    before: &AxisState,
    target: f64,
    period: f64,
    limits: &AxisLimits,
    enforced: EnforcedLimits,
) -> Result<AxisState, Violation> {
    if !target.is_finite() {
        return Err(Violation {
            value: target,
            ..Violation::from_code(ErrorCode::NOT_A_NUMBER)
        });
    }
    let after = before.after_set_point(target, period);
    let jerk = (after.acceleration - before.acceleration) / period;
    // An axis at rest that violates the velocity limit was usually given a set-point far from its position.
    let too_fast = if before.is_moving() {
        ErrorCode::VELOCITY
    } else {
        ErrorCode::DISCONTINUITY
    };
    let beyond = beyond_range(before.position, target, limits);
    let magnitudes = [
        (enforced.velocity, too_fast, after.velocity, limits.velocity),
        (
            enforced.acceleration,
            ErrorCode::ACCELERATION,
            after.acceleration,
            limits.acceleration,
        ),
        (enforced.jerk, ErrorCode::JERK, jerk, limits.jerk),
    ];
    let broken = magnitudes.into_iter().find(|(enforced, _, value, limit)| {
        *enforced && value.abs() > limit * (1.0 + LIMIT_TOLERANCE)
    });
    match (beyond.filter(|_| enforced.position), broken) {
        (Some(violation), _) => Err(violation),
        (None, Some((_, code, value, limit))) => Err(Violation { code, value, limit }),
        (None, None) => Ok(after),
    }
}

/// Returns the violation of the range of an axis by the set-point `target` (rad); `None` if there is none. An axis
/// outside its range may stay where it is or move back, but not farther out: otherwise, an arm that braked beyond its
/// range could never be moved again. `before` is the previous set-point.
fn beyond_range(before: f64, target: f64, limits: &AxisLimits) -> Option<Violation> {
    let range = limits.position;
    let outer = range.shrunk(-POSITION_TOLERANCE);
    let limit = if target > range.upper {
        range.upper
    } else {
        range.lower
    };
    let farther_out = target > range.upper && target > before
        || target < range.lower && target < before
        || target.is_nan();
    (!outer.contains(target) && farther_out).then_some(Violation {
        code: ErrorCode::POSITION,
        value: target,
        limit,
    })
}
