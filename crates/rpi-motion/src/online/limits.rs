//! Limits of one axis and what is wrong with a request.

use rpi_kin::state_to_rest::{AxisState, Bounds};

/// Limits of one axis, in rad and s, or m and s. The limits of velocity and acceleration may differ by direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Maximum velocity, rad/s or m/s; positive.
    pub max_velocity: f64,
    /// Minimum velocity: the maximum speed in the negative direction, with a minus sign, rad/s or m/s; negative.
    pub min_velocity: f64,
    /// Maximum acceleration, rad/s² or m/s²; positive.
    pub max_acceleration: f64,
    /// Minimum acceleration: the maximum magnitude in the negative direction, with a minus sign, rad/s² or m/s²;
    /// negative.
    pub min_acceleration: f64,
    /// Maximum magnitude of the jerk in both directions, rad/s³ or m/s³; positive.
    pub max_jerk: f64,
}

/// Error of a request for a motion: the axis and the kind of the error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OnlineError {
    /// Axis whose request is invalid, counted from 0.
    pub axis: usize,
    /// Kind of the error in the request.
    pub kind: OnlineErrorKind,
}

/// Reason why a request for a motion is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnlineErrorKind {
    /// A number of the start, the target or the options is not a number, infinite, or larger in magnitude than 1e15.
    NotFinite,
    /// A limit has the wrong sign, or its magnitude is zero, not a number, or outside 1e-15 to 1e15.
    Limits,
    /// The velocity of the target is outside the limits of the velocity.
    TargetVelocity,
    /// The acceleration of the target is outside the limits of the acceleration.
    TargetAcceleration,
    /// The velocity just before the target would have to be outside its limits, because the acceleration of the target
    /// takes time to build up.
    TargetApproach,
}

impl core::fmt::Display for OnlineError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let axis = self.axis + 1;
        match self.kind {
            OnlineErrorKind::NotFinite => write!(f, "a value of axis {axis} is not finite"),
            OnlineErrorKind::Limits => write!(
                f,
                "a limit of axis {axis} has the wrong sign or is not finite"
            ),
            OnlineErrorKind::TargetVelocity => {
                write!(
                    f,
                    "the target velocity of axis {axis} is outside its limits"
                )
            }
            OnlineErrorKind::TargetAcceleration => {
                write!(
                    f,
                    "the target acceleration of axis {axis} is outside its limits"
                )
            }
            OnlineErrorKind::TargetApproach => {
                write!(
                    f,
                    "axis {axis} exceeds its velocity limit before it has the target acceleration"
                )
            }
        }
    }
}

impl core::error::Error for OnlineError {}

/// Share by which a target may exceed a limit due to rounding.
const SLACK: f64 = 1e-12;

/// Maximum magnitude of an accepted value, in its own unit; 1 divided by it is the minimum magnitude of a limit. Beyond
/// it, the formulas lose all digits to rounding.
const LARGEST: f64 = 1e15;

impl From<Bounds> for AxisLimits {
    fn from(bounds: Bounds) -> Self {
        Self {
            max_velocity: bounds.speed,
            min_velocity: -bounds.speed,
            max_acceleration: bounds.acceleration,
            min_acceleration: -bounds.acceleration,
            max_jerk: bounds.jerk,
        }
    }
}

impl AxisLimits {
    /// Checks that all limits have the right sign and a usable magnitude.
    pub(super) fn check(&self) -> Result<(), OnlineErrorKind> {
        let positive = [
            self.max_velocity,
            -self.min_velocity,
            self.max_acceleration,
            -self.min_acceleration,
            self.max_jerk,
        ];
        let usable = |limit: &f64| *limit >= 1.0 / LARGEST && *limit <= LARGEST;
        if positive.iter().all(usable) {
            Ok(())
        } else {
            Err(OnlineErrorKind::Limits)
        }
    }

    /// Checks that the acceleration of a target is within the limits.
    pub(super) fn check_acceleration(&self, target: &AxisState) -> Result<(), OnlineErrorKind> {
        let a = target.acceleration;
        let slack = 1.0 + SLACK;
        if a > self.max_acceleration * slack || a < self.min_acceleration * slack {
            return Err(OnlineErrorKind::TargetAcceleration);
        }
        Ok(())
    }

    /// Checks that velocity and acceleration of a target are within the limits, and that its acceleration can be built
    /// up without exceeding the limits of the velocity.
    pub(super) fn check_target(&self, target: &AxisState) -> Result<(), OnlineErrorKind> {
        self.check_acceleration(target)?;
        let (v, a) = (target.velocity, target.acceleration);
        let slack = 1.0 + SLACK;
        let (highest, lowest) = (self.max_velocity * slack, self.min_velocity * slack);
        if v > highest || v < lowest {
            return Err(OnlineErrorKind::TargetVelocity);
        }
        let before = v - a * a.abs() / (2.0 * self.max_jerk);
        if before > highest || before < lowest {
            return Err(OnlineErrorKind::TargetApproach);
        }
        Ok(())
    }
}

/// Checks that all numbers of a state are finite and not too large for the formulas.
pub(super) fn check_finite(state: &AxisState) -> Result<(), OnlineErrorKind> {
    let numbers = [state.position, state.velocity, state.acceleration];
    if numbers.iter().all(|number| number.abs() <= LARGEST) {
        Ok(())
    } else {
        Err(OnlineErrorKind::NotFinite)
    }
}
