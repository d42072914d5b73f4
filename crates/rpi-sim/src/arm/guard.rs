//! Limit checks of a controller for the set-points of one axis.
//!
//! Velocity, acceleration and jerk are backward differences of the set-points over their period. Franka's control
//! interface checks motions by the same definition (frankarobotics.github.io, robot specifications).

use crate::cell::Enforced;
use crate::code::Code;
use rpi_kin::AxisLimits;

/// Position, velocity and acceleration of an axis, in rad and s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
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
    pub code: Code,
    /// The violating value, in rad and s.
    pub value: f64,
    /// The limit, in rad and s.
    pub limit: f64,
}

/// Velocities below this, in rad/s, count as zero: a nanometre per millisecond at a distance of one metre.
const STANDING: f64 = 1e-6;

/// Tolerances for rounding errors, so that a set-point on the limit is accepted: relative for velocity, acceleration
/// and jerk, in rad for positions.
const ROUNDING: f64 = 1e-6;
const POSITION_ROUNDING: f64 = 1e-9;

impl Violation {
    /// A violation without a value and a limit.
    #[must_use]
    pub const fn of(code: Code) -> Self {
        Self {
            code,
            value: 0.0,
            limit: 0.0,
        }
    }
}

impl State {
    /// A state at rest.
    #[must_use]
    pub const fn standing(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
        }
    }

    /// The state after a set-point `target` (rad) that follows after `period` (s).
    #[must_use]
    pub fn followed_by(&self, target: f64, period: f64) -> Self {
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
        self.velocity.abs() > STANDING
    }
}

/// Checks the set-point `target` against the limits. Returns the resulting state.
pub(super) fn judge(
    before: &State,
    target: f64,
    period: f64,
    limits: &AxisLimits,
    enforced: Enforced,
) -> Result<State, Violation> {
    if !target.is_finite() {
        return Err(Violation {
            value: target,
            ..Violation::of(Code::NOT_A_NUMBER)
        });
    }
    let after = before.followed_by(target, period);
    let jerk = (after.acceleration - before.acceleration) / period;
    // An axis at rest that violates the velocity limit was usually given a set-point far from its position.
    let too_fast = if before.is_moving() {
        Code::VELOCITY
    } else {
        Code::DISCONTINUITY
    };
    let beyond = beyond_range(target, limits);
    let magnitudes = [
        (enforced.velocity, too_fast, after.velocity, limits.velocity),
        (
            enforced.acceleration,
            Code::ACCELERATION,
            after.acceleration,
            limits.acceleration,
        ),
        (enforced.jerk, Code::JERK, jerk, limits.jerk),
    ];
    let broken = magnitudes
        .into_iter()
        .find(|(enforced, _, value, limit)| *enforced && value.abs() > limit * (1.0 + ROUNDING));
    match (beyond.filter(|_| enforced.position), broken) {
        (Some(violation), _) => Err(violation),
        (None, Some((_, code, value, limit))) => Err(Violation { code, value, limit }),
        (None, None) => Ok(after),
    }
}

fn beyond_range(target: f64, limits: &AxisLimits) -> Option<Violation> {
    let outer = limits.position.shrunk(-POSITION_ROUNDING);
    let limit = if target > limits.position.upper {
        limits.position.upper
    } else {
        limits.position.lower
    };
    (!outer.contains(target)).then_some(Violation {
        code: Code::POSITION,
        value: target,
        limit,
    })
}
