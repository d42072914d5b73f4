//! What one axis may do.

/// A closed interval of joint positions in radians (or metres for a linear axis).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The smallest allowed value.
    pub lower: f64,
    /// The largest allowed value.
    pub upper: f64,
}

impl Range {
    /// From `-bound` to `bound`.
    #[must_use]
    pub const fn symmetric(bound: f64) -> Self {
        Self {
            lower: -bound,
            upper: bound,
        }
    }

    /// Whether `value` lies inside; false for NaN.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        value >= self.lower && value <= self.upper
    }

    /// The same interval, shorter by `margin` at both ends.
    #[must_use]
    pub fn shrunk(&self, margin: f64) -> Self {
        Self {
            lower: self.lower + margin,
            upper: self.upper - margin,
        }
    }
}

/// Limits of one axis: position in rad, and the magnitudes of velocity in rad/s, acceleration in rad/s^2, jerk in rad/s^3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits {
    /// Where the axis may stand.
    pub position: Range,
    /// How fast it may move, in either direction.
    pub velocity: f64,
    /// How fast its velocity may change.
    pub acceleration: f64,
    /// How fast its acceleration may change.
    pub jerk: f64,
}

impl AxisLimits {
    /// A range in degrees and a velocity in degrees per second, as vendors state them; acceleration and jerk unlimited.
    #[must_use]
    pub const fn degrees(lower: f64, upper: f64, velocity: f64) -> Self {
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

    /// A range in radians and a velocity in radians per second; acceleration and jerk unlimited.
    #[must_use]
    pub const fn radians(lower: f64, upper: f64, velocity: f64) -> Self {
        let position = Range { lower, upper };
        Self {
            position,
            velocity,
            acceleration: f64::INFINITY,
            jerk: f64::INFINITY,
        }
    }

    /// The same with an acceleration in rad/s^2 and a jerk in rad/s^3.
    #[must_use]
    pub const fn changing(self, acceleration: f64, jerk: f64) -> Self {
        Self {
            acceleration,
            jerk,
            ..self
        }
    }

    /// The same with acceleration and jerk as multiples of the velocity limit, the form the reference system uses:
    /// full speed is reached in 1/`acceleration` s, full acceleration in `acceleration`/`jerk` s.
    #[must_use]
    pub const fn scaled(self, acceleration: f64, jerk: f64) -> Self {
        self.changing(acceleration * self.velocity, jerk * self.velocity)
    }
}
