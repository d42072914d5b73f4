//! Use of the limits of an axis during a run: how long the axis was at them, and how near it came to them.

use super::limits::AxisState;
use rpi_kin::AxisLimits;

/// Share of a limit from which on an axis counts as at the limit. Planned motions reach a limit up to rounding and
/// differences over a period; a lower share would also count motions that merely come near to it.
const AT_LIMIT: f64 = 0.99;

/// Quantity of an axis that has a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitKind {
    /// Velocity, rad/s (m/s for a linear axis).
    Velocity,
    /// Acceleration, rad/s² (m/s²).
    Acceleration,
    /// Jerk, rad/s³ (m/s³).
    Jerk,
}

impl LimitKind {
    /// All kinds, in the order of the arrays in [`LimitUsage`].
    pub const ALL: [LimitKind; 3] = [Self::Velocity, Self::Acceleration, Self::Jerk];

    /// Returns the name of the quantity, in lower case.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
        }
    }
}

/// Extreme value of a quantity in a run, and the time at which it was reached first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// Extreme value.
    pub value: f64,
    /// Time on the clock of the cell, s.
    pub time: f64,
}

/// Use of the limits of one axis by all set-points that it followed.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitUsage {
    /// Time (s) during which the axis was at its limit, for each [`LimitKind`].
    pub time_at_limit: [f64; 3],
    /// Time (s) during which the axis was at one of its limits or more.
    pub time_at_any_limit: f64,
    /// Largest share of the limit that the axis used, for each [`LimitKind`]; 1 is all of it.
    pub largest_share: [Extreme; 3],
    /// Smallest distance to an end of the range, rad (m for a linear axis); negative outside of the range, infinite
    /// before the first set-point.
    pub distance_to_end: Extreme,
}

/// Use of the limits of one axis of an arm.
#[derive(Clone, Copy, Debug)]
pub struct AxisUsage<'a> {
    /// Index of the axis, from 0.
    pub axis: usize,
    /// True for a linear axis, whose values are in m and not in rad.
    pub is_linear: bool,
    /// Use of the limits since the start of the cell.
    pub usage: &'a LimitUsage,
}

impl Default for LimitUsage {
    fn default() -> Self {
        let start = |value| Extreme { value, time: 0.0 };
        Self {
            time_at_limit: [0.0; 3],
            time_at_any_limit: 0.0,
            largest_share: [start(0.0); 3],
            distance_to_end: start(f64::INFINITY),
        }
    }
}

impl LimitUsage {
    /// Takes note of a set-point that moved the axis from the state `before` to `after` within `period` (s), and was applied at
    /// `time` (s).
    pub(super) fn observe(
        &mut self,
        [before, after]: [&AxisState; 2],
        limits: &AxisLimits,
        period: f64,
        time: f64,
    ) {
        let jerk = (after.acceleration - before.acceleration) / period;
        let shares = [
            after.velocity.abs() / limits.velocity,
            after.acceleration.abs() / limits.acceleration,
            jerk.abs() / limits.jerk,
        ];
        for (k, share) in shares.into_iter().enumerate() {
            if share >= AT_LIMIT {
                self.time_at_limit[k] += period;
            }
            if share > self.largest_share[k].value {
                self.largest_share[k] = Extreme { value: share, time };
            }
        }
        if shares.iter().any(|share| *share >= AT_LIMIT) {
            self.time_at_any_limit += period;
        }
        let range = limits.position;
        let distance = (after.position - range.lower).min(range.upper - after.position);
        if distance < self.distance_to_end.value {
            self.distance_to_end = Extreme {
                value: distance,
                time,
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_kin::Range;

    fn limits() -> AxisLimits {
        AxisLimits {
            position: Range {
                lower: -1.0,
                upper: 2.0,
            },
            velocity: 2.0,
            acceleration: 10.0,
            jerk: 1000.0,
        }
    }

    #[test]
    fn time_at_a_limit_and_extremes_are_counted() {
        let mut usage = LimitUsage::default();
        let start = AxisState::at_rest(0.0);
        let fast = AxisState {
            position: 0.5,
            velocity: -2.0,
            acceleration: 5.0,
        };
        usage.observe([&start, &fast], &limits(), 0.01, 3.0);
        usage.observe([&fast, &fast], &limits(), 0.01, 3.01);
        assert_eq!(usage.time_at_limit, [0.02, 0.0, 0.0]);
        assert_eq!(usage.time_at_any_limit, 0.02);
        let shares = usage.largest_share.map(|extreme| extreme.value);
        assert_eq!(shares, [1.0, 0.5, 0.5]);
        assert_eq!(usage.largest_share[0].time, 3.0);
        assert_eq!(usage.distance_to_end.value, 1.5);
    }

    #[test]
    fn an_axis_without_set_points_has_used_nothing() {
        let usage = LimitUsage::default();
        assert_eq!(usage.time_at_any_limit, 0.0);
        assert!(usage.distance_to_end.value.is_infinite());
    }
}
