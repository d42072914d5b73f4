//! Guard of one axis: keeps velocity, acceleration, jerk and range in every period, for any wanted jerk.
//!
//! The state of an axis is *safe* if the axis could brake from it, with maximum jerk, without exceeding its limits or leaving
//! its range. The jerks of a period that lead to a safe state form an interval, because both the velocity that is reached once
//! the acceleration has decayed and the place of the stop grow with the jerk. The guard limits the wanted jerk to this
//! interval. From a safe state, the stop leads to safe states only, so there is always a next state.

use crate::online::{AxisLimits as StopLimits, MotionOptions, OnlineMotion};
use crate::stop_margin::exact_stopping_distances;
use rpi_kin::state_to_rest::{AxisState, Bounds};
use rpi_kin::{AxisLimits, Range};

/// Shares of the limits that the guard uses. The rest covers peaks of the velocity within a period and rounding in the
/// differences of set-points.
const SHARE: f64 = 0.995;

/// Shares of the way from the wanted jerk to that of the stop that are tried near the end of a range.
const BLENDS: [f64; 4] = [0.0, 0.25, 0.5, 0.75];

/// Limit that kept an axis from following its curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitKind {
    /// Velocity of the axis.
    Velocity,
    /// Acceleration of the axis.
    Acceleration,
    /// Jerk of the axis.
    Jerk,
    /// Range of the positions of the axis.
    Range,
}

/// Guard of one axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Guard {
    /// Limits of the arm: those of a stop.
    limits: AxisLimits,
    stop: StopLimits,
    range: Range,
    period: f64,
}

impl Guard {
    /// Creates the guard of an axis with its limits and the range that it keeps (rad); `period` is the time between two
    /// set-points, s.
    pub(super) fn new(limits: AxisLimits, range: Range, period: f64) -> Self {
        // One period must suffice to reduce the acceleration to 0.
        let limits = AxisLimits {
            jerk: limits.jerk.min(limits.acceleration / period),
            ..limits
        };
        let stop = StopLimits::from(Bounds {
            speed: limits.velocity,
            acceleration: limits.acceleration,
            jerk: limits.jerk,
        });
        Self {
            limits,
            stop,
            range,
            period,
        }
    }

    /// Returns the state one period later, as near to that with the wanted `jerk` (rad/s³) as the limits allow, and the
    /// limit that changed it; `None` if it is the wanted one.
    pub(super) fn next(&self, state: AxisState, jerk: f64) -> (AxisState, Option<LimitKind>) {
        let (allowed, mut limit) = self.allowed(state, jerk);
        let next = state.advanced(self.period, allowed);
        if self.can_stop(&next) {
            return (next, limit);
        }
        limit = Some(LimitKind::Range);
        let stopped = self.stopping(state, self.period);
        let stop = (stopped.acceleration - state.acceleration) / self.period;
        for share in BLENDS.into_iter().skip(1) {
            let next = state.advanced(self.period, allowed + share * (stop - allowed));
            if self.can_stop(&next) {
                return (next, limit);
            }
        }
        (stopped, limit)
    }

    /// Returns the state `time` seconds later if the axis stops as fast as it can.
    pub(super) fn stopping(&self, state: AxisState, time: f64) -> AxisState {
        let rest = [AxisState::default()];
        let options = MotionOptions::default();
        match OnlineMotion::to_velocity(&[state], &rest, &[self.stop], options) {
            Ok(stop) => stop.axes()[0].state_at(time),
            Err(_) => state,
        }
    }

    /// Returns the jerk nearest to the wanted one with which acceleration and velocity stay within their limits, and the
    /// limit that changed it.
    fn allowed(&self, state: AxisState, jerk: f64) -> (f64, Option<LimitKind>) {
        let period = self.period;
        let (most_jerk, most) = (SHARE * self.limits.jerk, SHARE * self.limits.acceleration);
        let high = self.highest_acceleration(state.velocity, state.acceleration);
        let low = -self.highest_acceleration(-state.velocity, -state.acceleration);
        let wanted = state.acceleration + jerk * period;
        // A wanted jerk that is not a number ends the acceleration.
        let wanted = if wanted.is_finite() { wanted } else { 0.0 };
        let mut limit = None;
        let mut keep = |value: f64, low: f64, high: f64, kind: LimitKind| {
            let kept = value.max(low).min(high);
            if kept != value {
                limit = Some(kind);
            }
            kept
        };
        let next = keep(wanted, low, high, LimitKind::Velocity);
        let next = keep(next, -most, most, LimitKind::Acceleration);
        let (least, greatest) = (
            state.acceleration - most_jerk * period,
            state.acceleration + most_jerk * period,
        );
        let next = keep(next, least, greatest, LimitKind::Jerk);
        ((next - state.acceleration) / period, limit)
    }

    /// Returns the highest acceleration at the end of a period after which the velocity need not exceed its limit.
    fn highest_acceleration(&self, velocity: f64, acceleration: f64) -> f64 {
        let (period, jerk) = (self.period, SHARE * self.limits.jerk);
        let room = SHARE * self.limits.velocity - velocity - acceleration * period / 2.0;
        let half = jerk * period / 2.0;
        let square = half * half + 2.0 * jerk * room;
        if room >= 0.0 && square >= 0.0 {
            libm::sqrt(square) - half
        } else {
            2.0 * room / period
        }
    }

    /// Returns true if the axis can stop from `state` within its range.
    fn can_stop(&self, state: &AxisState) -> bool {
        let (below, above) =
            exact_stopping_distances(state.velocity, state.acceleration, &self.limits);
        state.position - below >= self.range.lower && state.position + above <= self.range.upper
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: AxisLimits = AxisLimits {
        position: Range::symmetric(1.0),
        velocity: 2.0,
        acceleration: 4.0,
        jerk: 40.0,
    };

    /// A jerk that changes its sign at random times, up to 100 times the limit.
    fn wanted(k: u32) -> f64 {
        let phase = f64::from(k);
        let slow = rpi_math::sin(phase * 0.0021) + rpi_math::sin(phase * 0.013);
        4000.0 * slow * rpi_math::sin(phase * 0.71)
    }

    #[test]
    fn no_wanted_jerk_breaks_a_limit() {
        for period in [1e-3, 4e-3] {
            let guard = Guard::new(LIMITS, Range::symmetric(1.0), period);
            let mut state = AxisState::default();
            let mut q = [0.0; 4];
            let mut worst = [0.0f64; 4];
            for k in 0..200_000 {
                let jerk = if k % 5000 < 4000 { wanted(k) } else { 1e9 };
                state = guard
                    .next(state, if k % 9000 < 4500 { jerk } else { -jerk })
                    .0;
                q.rotate_left(1);
                q[3] = state.position;
                let d = [q[1] - q[0], q[2] - q[1], q[3] - q[2]];
                let shares = [
                    d[2] / period / LIMITS.velocity,
                    (d[2] - d[1]) / (period * period) / LIMITS.acceleration,
                    (d[2] - 2.0 * d[1] + d[0]) / (period * period * period) / LIMITS.jerk,
                    state.position,
                ];
                for (worst, share) in worst.iter_mut().zip(shares) {
                    *worst = worst.max(share.abs());
                }
            }
            assert!(worst.iter().all(|share| *share <= 1.0 + 1e-6), "{worst:?}");
            assert!(worst.iter().all(|share| *share > 0.9), "{worst:?}");
        }
    }
}
