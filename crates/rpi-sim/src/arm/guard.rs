//! What a controller holds a set-point of one axis against before it takes it.
//!
//! Velocity, acceleration and jerk are backward differences of the set-points over their period, the definition by which
//! Franka's control interface refuses motions (frankarobotics.github.io, robot specifications).

use crate::cell::Enforced;
use crate::code::Code;
use rpi_kin::AxisLimits;

/// Position, velocity and acceleration of an axis, in rad and s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Position.
    pub position: f64,
    /// Velocity.
    pub velocity: f64,
    /// Acceleration.
    pub acceleration: f64,
}

/// What a set-point is refused for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// Which limit.
    pub code: Code,
    /// The value that breaks it, in rad and s.
    pub value: f64,
    /// The limit itself.
    pub limit: f64,
}

/// Slower than this counts as standing, in rad/s: a nanometre per millisecond at a metre's distance.
const STANDING: f64 = 1e-6;

/// A value may exceed its limit by this share, and a position by this many rad, so that rounding on the way here does not
/// turn a set-point on the limit into one beyond it.
const ROUNDING: f64 = 1e-6;
const POSITION_ROUNDING: f64 = 1e-9;

impl Violation {
    /// One that has no value and no limit.
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
    /// At rest.
    #[must_use]
    pub const fn standing(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
        }
    }

    /// The state after `target` follows in a period (s).
    #[must_use]
    pub fn followed_by(&self, target: f64, period: f64) -> Self {
        let velocity = (target - self.position) / period;
        Self {
            position: target,
            velocity,
            acceleration: (velocity - self.velocity) / period,
        }
    }

    /// Whether the axis moves.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.velocity.abs() > STANDING
    }
}

/// The state that `target` leads to, or why it is refused.
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
