//! Bringing one axis to rest within its acceleration and jerk: what a device does on its own when it is left alone.
//!
//! Time-optimal, in at most three parts of constant jerk. Built once, then sampled at any time in constant time.

/// Velocity and acceleration of an axis, in rad/s and rad/s^2 (or m).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Velocity.
    pub velocity: f64,
    /// Acceleration.
    pub acceleration: f64,
}

/// A part of constant jerk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Part {
    pub(crate) duration: f64,
    pub(crate) jerk: f64,
}

impl Part {
    pub(crate) fn mirrored(self) -> Self {
        Part {
            jerk: -self.jerk,
            ..self
        }
    }
}

/// The way to rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stop {
    start: Motion,
    pub(crate) parts: [Part; 3],
}

impl Stop {
    /// From `start`, with the magnitudes of acceleration and jerk that may be used (both positive; jerk may be infinite
    /// for an axis that only limits its acceleration). A start beyond the acceleration limit is brought back to it first.
    ///
    /// `None` if a number is NaN, the start is infinite, or a limit is not positive.
    #[must_use]
    pub fn new(start: Motion, acceleration: f64, jerk: f64) -> Option<Self> {
        let usable = start.velocity.is_finite()
            && start.acceleration.is_finite()
            && acceleration > 0.0
            && jerk > 0.0;
        if !usable {
            return None;
        }
        if jerk.is_infinite() {
            return Some(Self::without_jerk(start, acceleration));
        }
        // What is left of the velocity if the acceleration just runs out decides the direction to brake in.
        let left = start.velocity + start.acceleration * start.acceleration.abs() / (2.0 * jerk);
        let braking = if left < 0.0 { -1.0 } else { 1.0 };
        let (velocity, present) = (braking * start.velocity, braking * start.acceleration);
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
            Part {
                duration: first,
                jerk: braking * rise,
            },
            Part {
                duration: held.max(0.0),
                jerk: 0.0,
            },
            Part {
                duration: peak / jerk,
                jerk: braking * jerk,
            },
        ];
        Some(Self { start, parts })
    }

    /// Constant braking: the acceleration jumps.
    fn without_jerk(start: Motion, acceleration: f64) -> Self {
        let braking = if start.velocity < 0.0 {
            acceleration
        } else {
            -acceleration
        };
        let held = Part {
            duration: start.velocity.abs() / acceleration,
            jerk: 0.0,
        };
        let start = Motion {
            acceleration: braking,
            ..start
        };
        Self {
            start,
            parts: [Part::default(), held, Part::default()],
        }
    }

    /// How long it takes, in s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.parts.iter().map(|part| part.duration).sum()
    }

    /// Velocity and acceleration `time` seconds after the start: those of the start before it, zero from the end on.
    #[must_use]
    pub fn at(&self, time: f64) -> Motion {
        if time >= self.duration() {
            return Motion::default();
        }
        let mut left = time.max(0.0);
        let mut motion = self.start;
        for part in &self.parts {
            let spent = left.min(part.duration);
            motion = motion.after(spent, part.jerk);
            left -= spent;
        }
        motion
    }

    /// How far the axis moves until it stands, in rad (or m), with its sign.
    #[must_use]
    pub fn distance(&self) -> f64 {
        let mut motion = self.start;
        let mut distance = 0.0;
        for part in &self.parts {
            let t = part.duration;
            distance +=
                t * (motion.velocity + t * (motion.acceleration / 2.0 + t * part.jerk / 6.0));
            motion = motion.after(t, part.jerk);
        }
        distance
    }
}

impl Motion {
    fn after(self, time: f64, jerk: f64) -> Self {
        Self {
            velocity: self.velocity + time * (self.acceleration + time * jerk / 2.0),
            acceleration: self.acceleration + time * jerk,
        }
    }
}
