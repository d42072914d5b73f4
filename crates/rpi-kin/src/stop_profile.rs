//! Stop of one axis with bounded acceleration and jerk: the motion of a device that receives no more set-points.
//!
//! The stop is time-optimal and has at most three phases of constant jerk. It is planned once and sampled at any time
//! in constant time.

/// Velocity and acceleration of an axis, in rad/s and rad/s² (or m/s and m/s²).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VelocityState {
    /// Velocity, in rad/s or m/s.
    pub velocity: f64,
    /// Acceleration, in rad/s² or m/s².
    pub acceleration: f64,
}

/// Phase of a motion with constant jerk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JerkPhase {
    /// Duration of the phase in seconds; not negative.
    pub duration: f64,
    /// Jerk during the phase, in rad/s³ (or m/s³).
    pub jerk: f64,
}

impl JerkPhase {
    pub(crate) fn mirrored(self) -> Self {
        JerkPhase {
            jerk: -self.jerk,
            ..self
        }
    }
}

/// Planned stop of an axis with bounded acceleration and jerk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StopProfile {
    start: VelocityState,
    pub(crate) phases: [JerkPhase; 3],
}

impl StopProfile {
    /// Plans the fastest stop from `start` with maximum magnitudes of acceleration and jerk. Both must be positive; the
    /// jerk may be infinite. A start beyond the maximum acceleration is first brought back to it.
    ///
    /// Returns `None` if a number is NaN, the start is infinite, or a limit is not positive.
    #[must_use]
    pub fn new(start: VelocityState, acceleration: f64, jerk: f64) -> Option<Self> {
        let usable = start.velocity.is_finite()
            && start.acceleration.is_finite()
            && acceleration > 0.0
            && jerk > 0.0;
        if !usable {
            return None;
        }
        // An infinite jerk would make a product of 0 and infinity, not a number, in the formulas below.
        if jerk.is_infinite() {
            return Some(Self::without_jerk(start, acceleration));
        }
        // The velocity that remains when the acceleration has decayed to zero determines the direction of braking.
        let left = start.velocity + start.acceleration * start.acceleration.abs() / (2.0 * jerk);
        let braking = if left < 0.0 { -1.0 } else { 1.0 };
        let (velocity, present) = (braking * start.velocity, braking * start.acceleration);
        // Peak of a deceleration without a constant part: its two ramps together remove the whole velocity. Rounding
        // can make the argument of the root slightly negative.
        let needed = libm::sqrt((jerk * velocity + present * present / 2.0).max(0.0));
        let peak = needed.min(acceleration).max(0.0);
        let first = (present + peak).abs() / jerk;
        let gained = (present - peak) / 2.0 * first;
        let held = if needed > acceleration {
            (velocity + gained) / peak - peak / (2.0 * jerk)
        } else {
            0.0
        };
        let rise = if present + peak > 0.0 { -jerk } else { jerk };
        let parts = [
            JerkPhase {
                duration: first,
                jerk: braking * rise,
            },
            JerkPhase {
                duration: held.max(0.0),
                jerk: 0.0,
            },
            JerkPhase {
                duration: peak / jerk,
                jerk: braking * jerk,
            },
        ];
        Some(Self {
            start,
            phases: parts,
        })
    }

    /// Plans a stop with constant deceleration `acceleration`, for unlimited jerk: the acceleration of the axis jumps.
    fn without_jerk(start: VelocityState, acceleration: f64) -> Self {
        let braking = if start.velocity < 0.0 {
            acceleration
        } else {
            -acceleration
        };
        let held = JerkPhase {
            duration: start.velocity.abs() / acceleration,
            jerk: 0.0,
        };
        let start = VelocityState {
            acceleration: braking,
            ..start
        };
        Self {
            start,
            phases: [JerkPhase::default(), held, JerkPhase::default()],
        }
    }

    /// Returns the three phases of constant jerk of the stop, in order; unused ones have the duration 0.
    #[must_use]
    pub fn phases(&self) -> &[JerkPhase; 3] {
        &self.phases
    }

    /// Returns the duration of the stop in s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.phases.iter().map(|part| part.duration).sum()
    }

    /// Returns velocity and acceleration of the axis `time` seconds after the start of the stop: those of the start for
    /// a negative time, zero after the end.
    #[must_use]
    pub fn state_at(&self, time: f64) -> VelocityState {
        if time >= self.duration() {
            return VelocityState::default();
        }
        let mut left = time.max(0.0);
        let mut motion = self.start;
        for part in &self.phases {
            let spent = left.min(part.duration);
            motion = motion.advanced(spent, part.jerk);
            left -= spent;
        }
        motion
    }

    /// Returns the signed distance from the start of the stop until rest, in rad (or m).
    #[must_use]
    pub fn distance(&self) -> f64 {
        let mut motion = self.start;
        let mut distance = 0.0;
        for part in &self.phases {
            let t = part.duration;
            distance +=
                t * (motion.velocity + t * (motion.acceleration / 2.0 + t * part.jerk / 6.0));
            motion = motion.advanced(t, part.jerk);
        }
        distance
    }
}

impl VelocityState {
    fn advanced(self, time: f64, jerk: f64) -> Self {
        Self {
            velocity: self.velocity + time * (self.acceleration + time * jerk / 2.0),
            acceleration: self.acceleration + time * jerk,
        }
    }
}
