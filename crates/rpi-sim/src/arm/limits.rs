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
    /// Position, rad.
    pub position: f64,
    /// Velocity, rad/s.
    pub velocity: f64,
    /// Acceleration, rad/s².
    pub acceleration: f64,
}

/// Violation of a limit by a set-point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// Error code of the limit.
    pub code: ErrorCode,
    /// The value that violates the limit, in rad and s.
    pub value: f64,
    /// The limit, in rad and s.
    pub limit: f64,
}

/// Velocities below this, in rad/s, count as zero: a nanometre per millisecond at a distance of one metre.
const REST_VELOCITY: f64 = 1e-6;

/// Tolerances for rounding errors, so that a set-point on the limit is accepted: relative for velocity, acceleration
/// and jerk, in rad for positions.
const LIMIT_TOLERANCE: f64 = 1e-6;
const POSITION_TOLERANCE: f64 = 1e-9;

impl Violation {
    /// Creates a violation that has no value and no limit.
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
    /// Creates the state of an axis at rest.
    #[must_use]
    pub const fn at_rest(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
        }
    }

    /// The state after a set-point `target` (rad) that follows after `period` (s).
    #[must_use]
    pub fn after_set_point(&self, target: f64, period: f64) -> Self {
        let velocity = (target - self.position) / period;
        Self {
            position: target,
            velocity,
            acceleration: (velocity - self.velocity) / period,
        }
    }

    /// True if the velocity is not zero.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.velocity.abs() > REST_VELOCITY
    }
}

/// Checks the set-point `target` against the limits. Returns the resulting state.
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

/// The violation of the range by a set-point. An axis outside its range may stay there or move back, but not farther out:
/// else an arm that braked beyond its range could never be moved again.
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
