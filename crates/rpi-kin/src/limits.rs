//! Limits of one axis.

/// Closed interval of joint positions, in rad (m for a prismatic joint).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Least joint position, in rad (m for a prismatic joint).
    pub lower: f64,
    /// Greatest joint position, in rad (m for a prismatic joint).
    pub upper: f64,
}

impl Range {
    /// Creates the range from `-bound` to `bound`.
    #[must_use]
    pub const fn symmetric(bound: f64) -> Self {
        Self {
            lower: -bound,
            upper: bound,
        }
    }

    /// Returns whether `value` lies in the range; false for NaN.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        value >= self.lower && value <= self.upper
    }

    /// Returns the range shortened by `margin` (rad or m) at both ends.
    #[must_use]
    pub fn shrunk(&self, margin: f64) -> Self {
        Self {
            lower: self.lower + margin,
            upper: self.upper - margin,
        }
    }
}

/// Limits of one axis: position in rad, and magnitudes of velocity (rad/s), acceleration (rad/s²) and jerk (rad/s³); m
/// instead of rad for a prismatic joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Permitted positions, in rad or m.
    pub position: Range,
    /// Maximum velocity in both directions, in rad/s or m/s; positive.
    pub velocity: f64,
    /// Maximum acceleration in both directions, in rad/s² or m/s²; positive.
    pub acceleration: f64,
    /// Maximum jerk in both directions, in rad/s³ or m/s³; positive.
    pub jerk: f64,
}

impl AxisLimits {
    /// Creates limits from a range in degrees and a velocity in degrees per second, as stated by vendors. Acceleration
    /// and jerk are unlimited.
    #[must_use]
    pub const fn from_degrees(lower: f64, upper: f64, velocity: f64) -> Self {
        Self {
            position: Range {
                lower: lower.to_radians(),
                upper: upper.to_radians(),
            },
            velocity: velocity.to_radians(),
            acceleration: f64::INFINITY,
            jerk: f64::INFINITY,
        }
    }

    /// Creates limits from a range in rad and a velocity in rad/s. Acceleration and jerk are unlimited.
    #[must_use]
    pub const fn from_radians(lower: f64, upper: f64, velocity: f64) -> Self {
        let position = Range { lower, upper };
        Self {
            position,
            velocity,
            acceleration: f64::INFINITY,
            jerk: f64::INFINITY,
        }
    }

    /// Returns the limits with an acceleration in rad/s² and a jerk in rad/s³.
    #[must_use]
    pub const fn with_acceleration_and_jerk(self, acceleration: f64, jerk: f64) -> Self {
        Self {
            acceleration,
            jerk,
            ..self
        }
    }

    /// Returns the limits with acceleration (1/s) and jerk (1/s²) as multiples of the velocity limit, as in the
    /// reference system: full velocity is reached after 1/`acceleration` s, full acceleration after
    /// `acceleration`/`jerk` s.
    #[must_use]
    pub const fn with_scaled_acceleration_and_jerk(self, acceleration: f64, jerk: f64) -> Self {
        self.with_acceleration_and_jerk(acceleration * self.velocity, jerk * self.velocity)
    }
}
