//! Time law of a chunk: how fast its curve is followed.
//!
//! The time of the curve passes at the rate 1 as long as no limit binds and the end of the rows is far. It passes more slowly
//! on stretches whose derivatives are too large for the limits, and comes to a stop at the last row, within bounds of its
//! second and third derivative, with which the axes can follow.

use super::LimitKind;
use super::curve::{Curve, DerivativeBounds, MAX_CURVE_ROWS};
use super::state::{difference, is_within};
use crate::Arm;
use crate::online::{AxisLimits, MotionOptions, OnlineMotion};
use alloc::vec::Vec;
use rpi_kin::MAX_AXES;
use rpi_kin::state_to_rest::{AxisState, Bounds};

/// Shortest duration of the stop from the rate 1, s.
const SHORTEST_STOP: f64 = 0.08;

/// Factor between two durations of the stop, and their number: up to 4 s.
const STOP_FACTOR: f64 = 1.1;
const STOPS: u32 = 41;

/// Number of samples of a stop.
const SAMPLES: u32 = 18;

/// Shares of acceleration and jerk that a steady rate may use. The rest is for changes of the rate.
const STEADY_ACCELERATION: f64 = 0.85;
const STEADY_JERK: f64 = 0.8;

/// Rate below which the time of the curve counts as standing.
const STANDING: f64 = 1e-9;

/// Distance (s), rate and change of the rate (1/s) at which the time of the curve stands at its end.
const STOPPED: [f64; 3] = [1e-12, 1e-10, 1e-7];

/// Axis (counted from 0) and kind of a limit that binds.
pub type BindingLimit = (usize, LimitKind);

/// Highest rates at which the limits of the axes allow to follow the spans of a curve.
#[derive(Clone, Debug)]
pub(super) struct Rates {
    spans: Vec<(f64, Option<BindingLimit>)>,
    /// Largest change of the rate on each span that the accelerations of all axes allow, 1/s.
    changes: Vec<f64>,
}

impl Rates {
    pub(super) fn empty() -> Self {
        Self {
            spans: Vec::with_capacity(MAX_CURVE_ROWS),
            changes: Vec::with_capacity(MAX_CURVE_ROWS),
        }
    }

    /// Computes the rates for all spans of a curve, with `bounds` of velocity, acceleration and jerk of each axis. Returns the
    /// smallest one from the time `from` (s) on.
    pub(super) fn compute(
        &mut self,
        arm: &Arm,
        bounds: &[Bounds; MAX_AXES],
        curve: &Curve,
        from: f64,
    ) -> f64 {
        self.spans.clear();
        self.changes.clear();
        let first = curve.place(from).0;
        let mut smallest = 1.0f64;
        for span in 0..=curve.place(curve.end()).0 {
            let middle = curve.start() + (span as f64 + 0.5) * curve.period();
            let (rate, change) = match span < first {
                true => ((1.0, None), f64::INFINITY),
                false => {
                    let most = curve.bounds(middle, middle);
                    let rate = rate_within(arm, bounds, &most);
                    (rate, change_within(arm, bounds, &most, rate.0))
                }
            };
            smallest = smallest.min(rate.0);
            self.spans.push(rate);
            self.changes.push(change);
        }
        if smallest < 1.0 {
            self.smooth(curve.period());
        }
        smallest
    }

    /// Lowers the rates such that the axes can follow their changes from span to span, each `period` seconds of the curve long:
    /// before a slow span the rate must sink in time, and after it the rate rises with the arm.
    fn smooth(&mut self, period: f64) {
        let count = self.spans.len();
        for span in (1..count).rev() {
            self.lower(span - 1, span, period);
        }
        for span in 1..count {
            self.lower(span, span - 1, period);
        }
    }

    /// Lowers the rate on `span` to one from which that on its `neighbour` can be reached.
    fn lower(&mut self, span: usize, neighbour: usize, period: f64) {
        let ((rate, _), (next, limit)) = (self.spans[span], self.spans[neighbour]);
        if next >= rate {
            return;
        }
        // The rate r along the time s of the curve with the change a: r dr/ds = a.
        let reachable = libm::sqrt(next * next + 2.0 * period * self.changes[span]);
        if reachable < rate {
            self.spans[span] = (reachable, limit);
        }
    }

    /// Returns the rate nearest to `rate` to which the rate of `law` can change within `period` seconds such that the axes can follow.
    pub(super) fn followed(&self, curve: &Curve, law: &AxisState, rate: f64, period: f64) -> f64 {
        let span = curve.place(law.position).0;
        let most = self
            .changes
            .get(span)
            .map_or(f64::INFINITY, |change| change * period);
        rate.max(law.velocity - most).min(law.velocity + most)
    }

    /// Returns the smallest rate between the times `from` and `to` (s), and the limit that binds there; `None` at the rate 1.
    pub(super) fn between(&self, curve: &Curve, from: f64, to: f64) -> (f64, Option<BindingLimit>) {
        let (first, last) = (curve.place(from).0, curve.place(to).0);
        let ahead = self.spans.get(first..=last).unwrap_or_default();
        ahead.iter().fold(
            (1.0, None),
            |least, rate| {
                if rate.0 < least.0 { *rate } else { least }
            },
        )
    }
}

/// Returns the largest change of the rate (1/s) at `rate` on a span with the derivatives `most` that the accelerations of all
/// axes allow.
fn change_within(
    arm: &Arm,
    bounds: &[Bounds; MAX_AXES],
    most: &DerivativeBounds,
    rate: f64,
) -> f64 {
    let of_axis = |axis: usize| {
        let bound = bounds[axis].acceleration;
        let left = bound - most.second[axis] * rate * rate;
        left.max((1.0 - STEADY_ACCELERATION) * bound) / most.first[axis].max(STANDING)
    };
    (0..arm.axes()).map(of_axis).fold(f64::INFINITY, f64::min)
}

/// Returns the highest rate, at most 1, on a span with the derivatives `most`, and the limit that binds.
fn rate_within(
    arm: &Arm,
    bounds: &[Bounds; MAX_AXES],
    most: &DerivativeBounds,
) -> (f64, Option<BindingLimit>) {
    let mut rate = (1.0, None);
    for (axis, bounds) in bounds.iter().enumerate().take(arm.axes()) {
        let of_kind = [
            (bounds.speed / most.first[axis], LimitKind::Velocity),
            (
                STEADY_ACCELERATION * bounds.acceleration / most.second[axis],
                LimitKind::Acceleration,
            ),
            (
                STEADY_JERK * bounds.jerk / most.third[axis],
                LimitKind::Jerk,
            ),
        ];
        // The roots are computed only where they bind.
        for (share, kind) in of_kind.into_iter().filter(|(share, _)| *share < 1.0) {
            let allowed = match kind {
                LimitKind::Acceleration => libm::sqrt(share),
                LimitKind::Jerk => rpi_math::cbrt(share),
                LimitKind::Velocity | LimitKind::Range => share,
            };
            if allowed < rate.0 {
                rate = (allowed, Some((axis, kind)));
            }
        }
    }
    rate
}

/// Bounds of the second and third derivative of the time of the curve, 1/s and 1/s².
#[derive(Clone, Copy, Debug)]
pub(super) struct RateBounds {
    acceleration: f64,
    jerk: f64,
}

/// Time of the curve with its rate: position (s), velocity (no unit) and acceleration (1/s).
#[derive(Clone, Copy, Debug)]
pub(super) struct TimeLaw {
    pub(super) state: AxisState,
    pub(super) bounds: RateBounds,
}

impl RateBounds {
    /// Returns the bounds with which a stop from the rate 1 takes `duration` seconds. The rate changes along a double S with
    /// ramps of a third of the duration.
    fn of_stop(duration: f64) -> Self {
        let acceleration = 1.5 / duration;
        Self {
            acceleration,
            jerk: 3.0 * acceleration / duration,
        }
    }

    /// Returns the bounds of a stop at the end of a curve that keeps the `bounds` of all axes: the fastest one, if every slower
    /// one keeps them, too.
    pub(super) fn fit(arm: &Arm, bounds: &[Bounds; MAX_AXES], curve: &Curve) -> Self {
        let duration =
            |step: u32| (0..step).fold(SHORTEST_STOP, |duration, _| STOP_FACTOR * duration);
        let (mut low, mut high) = (0, STOPS);
        while low < high {
            let middle = u32::midpoint(low, high);
            let time = duration(middle);
            match Self::of_stop(time).is_stop_within(arm, bounds, curve, time) {
                true => high = middle,
                false => low = middle + 1,
            }
        }
        Self::of_stop(duration(low))
    }

    fn is_stop_within(
        &self,
        arm: &Arm,
        bounds: &[Bounds; MAX_AXES],
        curve: &Curve,
        duration: f64,
    ) -> bool {
        let start = AxisState {
            position: curve.end() - duration / 2.0,
            velocity: 1.0,
            acceleration: 0.0,
        };
        let ramp = duration / 3.0;
        let held = start.advanced(ramp, -self.jerk);
        let release = held.advanced(ramp, 0.0);
        (0..=SAMPLES).all(|k| {
            let time = duration * f64::from(k) / f64::from(SAMPLES);
            let (state, jerk) = match time {
                _ if time < ramp => (start.advanced(time, -self.jerk), -self.jerk),
                _ if time < 2.0 * ramp => (held.advanced(time - ramp, 0.0), 0.0),
                _ => (release.advanced(time - 2.0 * ramp, self.jerk), self.jerk),
            };
            let at = curve.at(state.position);
            let (rate, change) = (state.velocity, state.acceleration);
            (0..arm.axes()).all(|axis| {
                let (first, second) = (at.first[axis], at.second[axis]);
                let acceleration = first * change + second * rate * rate;
                let third = at.third[axis] * rate * rate * rate;
                let total = first * jerk + 3.0 * second * rate * change + third;
                acceleration.abs() <= bounds[axis].acceleration && total.abs() <= bounds[axis].jerk
            })
        })
    }
}

impl TimeLaw {
    /// Creates a time law that stands at the time 0.
    pub(super) fn standing() -> Self {
        Self {
            state: AxisState::default(),
            bounds: RateBounds::of_stop(1.0),
        }
    }

    /// Returns by how much the time of the curve passes during a stop from the rate `rate`, s.
    pub(super) fn stop_length(&self, rate: f64) -> f64 {
        let (most, jerk) = (self.bounds.acceleration, self.bounds.jerk);
        let duration = match rate * jerk >= most * most {
            true => rate / most + most / jerk,
            false => 2.0 * libm::sqrt(rate.max(0.0) / jerk),
        };
        rate * duration / 2.0
    }

    /// Goes on for `period` seconds towards the rate `rate` (0 to 1), to a stop at the time `end` of the curve at the latest.
    pub(super) fn advance(&mut self, rate: f64, end: f64, period: f64) {
        let limits = [AxisLimits::from(Bounds {
            speed: rate.max(STANDING),
            acceleration: self.bounds.acceleration,
            jerk: self.bounds.jerk,
        })];
        let goal = [AxisState {
            position: end,
            ..AxisState::default()
        }];
        let options = MotionOptions::default();
        let start = [self.state];
        let plan = match rate > STANDING {
            true => OnlineMotion::to_position(&start, &goal, &limits, options),
            false => OnlineMotion::to_velocity(&start, &goal, &limits, options),
        };
        if let Ok(plan) = plan {
            self.state = plan.axes()[0].state_at(period);
        }
        // Rounding may keep the law from standing exactly, and the arm would never count as resting.
        if is_within(&difference(&self.state, &goal[0]), STOPPED) {
            self.state = goal[0];
        }
    }
}
