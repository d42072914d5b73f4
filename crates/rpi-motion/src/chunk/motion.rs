//! Motion of an arm along chunks: one set-point per cycle, whatever has or has not arrived.

use super::curve::{Curve, DerivativeBounds};
use super::entry::{self, on_curve};
use super::feedback::{self, correction};
use super::guard::Guard;
use super::law::{BindingLimit, Rates, TimeLaw};
use super::pending::Pending;
use super::residual::Residual;
use super::rows::{ChunkRows, InForce, RowTimes};
use super::state::{difference, is_within, rests};
use super::{ChunkError, ChunkOptions};
use crate::node::{USED_JERK_SHARE, USED_SHARE};
use crate::ranges::{Ranges, allowed_ranges};
use crate::{Arm, Controls, JointState, MotionError};
use rpi_kin::MAX_AXES;
use rpi_kin::state_to_rest::{AxisState, Bounds};

/// Share of the bounds that the plans use. The rest is for the correction of small deviations.
const PLANNED: f64 = 0.97;

/// Distance that a curve keeps from the ends of the ranges of the axes, rad.
const CURVE_MARGIN: f64 = 1e-3;

/// Deviation from which on the time of the curve passes more slowly, and the deviation at which its rate is the least, rad.
const SLOWING: (f64, f64) = (0.02, 0.2);

/// Factor between two rates with which the first curve is entered, and the largest number of slower rates that are tried.
const SLOWER: f64 = 0.5;
const SLOWER_ENTRIES: u32 = 8;

/// Least rate of the time of the curve while an axis deviates.
const LEAST_RATE: f64 = 0.05;

/// Differences of position (rad), velocity (rad/s) and acceleration (rad/s²) from a state of rest that end at once. The change
/// of the jerk is far below every limit.
const RESTING: [f64; 3] = [1e-11, 1e-9, 1e-6];

/// Set-point of a [`ChunkMotion`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChunkSetPoint {
    /// Position, velocity and acceleration of the axes.
    pub state: JointState,
    /// Largest distance of an axis from the curve of the chunk in force, rad.
    pub deviation: f64,
    /// Time by which the arm is behind the times of the rows, because a limit bound or a chunk was late, s.
    pub lag: f64,
    /// Largest deviation of the curve in force from its rows, by smoothing and by the ranges of the axes, rad.
    pub smoothing: f64,
    /// Time until the last row of the chunk in force, s.
    pub remaining: f64,
    /// True while the arm brakes or rests because no further chunk has come.
    pub is_late: bool,
    /// Axis and limit that slow the arm down or keep it off the curve; `None` if no limit binds.
    pub limit: Option<BindingLimit>,
    /// True if the arm is at rest.
    pub at_rest: bool,
}

/// Motion of one arm along chunks of joint positions.
#[derive(Clone, Debug)]
pub struct ChunkMotion {
    arm: Arm,
    /// Period of the set-points, s.
    period: f64,
    /// Bounds of velocity, acceleration and jerk of each axis with which motions are planned: rad/s, rad/s², rad/s³.
    bounds: [Bounds; MAX_AXES],
    guards: [Guard; MAX_AXES],
    /// Ranges that the curve keeps, rad.
    ranges: Ranges,
    /// Time of the clock of the chunks, s: that of the cycles, less pauses.
    now: f64,
    curve: Curve,
    rates: Rates,
    law: TimeLaw,
    residuals: [Residual; MAX_AXES],
    /// Time since the entry into the curve, s.
    since_entry: f64,
    /// State of each axis on curve and decay at the last set-point.
    reference: [AxisState; MAX_AXES],
    state: [AxisState; MAX_AXES],
    previous: [AxisState; MAX_AXES],
    pending: Pending,
    smoothing: f64,
    limit: Option<BindingLimit>,
    is_late: bool,
}

impl ChunkMotion {
    /// Creates the motion of an arm that is at rest at joint positions 0, without a chunk. `period` is the time between
    /// set-points, s.
    #[must_use]
    pub fn new(arm: Arm, period: f64) -> Self {
        let nothing = Bounds {
            speed: 1.0,
            acceleration: 1.0,
            jerk: 1.0,
        };
        let mut motion = Self {
            guards: guards(&arm, &allowed_ranges(&arm, &[0.0; MAX_AXES]), period),
            ranges: allowed_ranges(&arm, &[0.0; MAX_AXES]),
            arm,
            period,
            bounds: [nothing; MAX_AXES],
            now: 0.0,
            curve: Curve::empty(),
            rates: Rates::empty(),
            law: TimeLaw::standing(),
            residuals: [Residual::default(); MAX_AXES],
            since_entry: 0.0,
            reference: [AxisState::default(); MAX_AXES],
            state: [AxisState::default(); MAX_AXES],
            previous: [AxisState::default(); MAX_AXES],
            pending: Pending::new(),
            smoothing: 0.0,
            limit: None,
            is_late: true,
        };
        motion.set_bounds(nothing);
        motion
    }

    /// Begins a motion from `state`, the state of the arm as commanded, without a chunk: the axes stop until one comes.
    /// `requested` are the bounds for each axis, in rad and s; they may be higher than its limits, which hold, too. `period` is
    /// the time between set-points, s.
    ///
    /// # Errors
    /// [`MotionError::NotFinite`] if a number is not finite or a bound not positive. The present motion then continues.
    pub fn begin(
        &mut self,
        state: &JointState,
        requested: Bounds,
        period: f64,
    ) -> Result<(), MotionError> {
        let is_period = period > 0.0 && period.is_finite();
        if !(requested.are_positive() && state.is_finite() && is_period) {
            return Err(MotionError::NotFinite);
        }
        self.period = period;
        let ranges = allowed_ranges(&self.arm, &state.position);
        self.guards = guards(&self.arm, &ranges, period);
        self.ranges = ranges.map(|range| {
            let quarter = (range.upper - range.lower) / 4.0;
            range.shrunk(CURVE_MARGIN.min(quarter))
        });
        self.set_bounds(requested);
        self.state = state.to_axes();
        (self.previous, self.reference) = (self.state, self.state);
        self.curve.reset(0, 0.0, 1.0);
        self.pending.drop_chunk();
        self.pending.times = RowTimes::default();
        (self.now, self.law, self.smoothing) = (0.0, TimeLaw::standing(), 0.0);
        Ok(())
    }

    fn set_bounds(&mut self, requested: Bounds) {
        for (axis, limits) in self.arm.limits().iter().enumerate() {
            self.bounds[axis] = Bounds {
                speed: PLANNED * requested.speed.min(USED_SHARE * limits.velocity),
                acceleration: PLANNED
                    * requested.acceleration.min(USED_SHARE * limits.acceleration),
                jerk: PLANNED * requested.jerk.min(USED_JERK_SHARE * limits.jerk),
            };
        }
    }

    /// Gives the next chunk. It comes into force within a few cycles, when it has been smoothed. It replaces a chunk that is
    /// still in preparation, or is appended to it.
    ///
    /// # Errors
    /// A [`ChunkError`]; the chunk is then ignored.
    pub fn take(
        &mut self,
        chunk: &ChunkRows<'_>,
        options: &ChunkOptions,
    ) -> Result<(), ChunkError> {
        let at = self.law.state.position;
        let in_force = InForce {
            curve: &self.curve,
            now: self.now,
            at,
            axes: self.arm.axes(),
        };
        self.pending.accept(&in_force, chunk, options, &self.ranges)
    }

    /// Returns the row of the newest chunk, counted from 0, whose time has come: where values that go with the joint positions,
    /// such as the width of a gripper, are to be read. 0 without a chunk.
    #[must_use]
    pub fn row(&self) -> usize {
        let is_overlapping = self.is_preparing() && !self.pending.is_appended;
        let time = match is_overlapping {
            true => self.now,
            false => self.law.state.position,
        };
        self.pending.times.row_at(time)
    }

    /// Returns true while a chunk is in preparation.
    #[must_use]
    pub fn is_preparing(&self) -> bool {
        !self.pending.is_idle()
    }

    /// Returns the set-point of the next cycle. Call it once per period.
    pub fn next_set_point(&mut self, controls: Controls) -> ChunkSetPoint {
        let share = match controls.speed_share > 0.0 && !controls.paused {
            true => controls.speed_share.min(1.0),
            false => 0.0,
        };
        // A pause stops the arm on its present curve: a policy that goes on would lead it along with each new one.
        if self.pending.is_ready() && share > 0.0 {
            self.enter(share);
        } else {
            let at = match self.pending.is_appended {
                true => self.law.state.position,
                false => self.now,
            };
            self.pending
                .prepare(&self.arm, &self.bounds, &self.ranges, at);
        }
        self.now += share * self.period;
        let next = match self.curve.is_empty() {
            true => self.stopped(),
            false => self.followed(share),
        };
        self.previous = core::mem::replace(&mut self.state, next);
        self.set_point()
    }

    /// Brings the prepared chunk into force.
    fn enter(&mut self, share: f64) {
        let was_empty = self.curve.is_empty();
        self.law.bounds = self.pending.exchange(&mut self.curve, &mut self.rates);
        self.smoothing = self.pending.deviation + self.pending.outside;
        if self.pending.is_appended {
            self.now = self.law.state.position;
        } else if was_empty || (self.law.state.position - self.now).abs() > 1e-9 {
            self.law.state = AxisState {
                position: self.now,
                velocity: 0.0,
                acceleration: 0.0,
            };
            self.law.state.velocity = self.entry_rate(share);
        }
        self.plan_entry();
        // An arm that does not follow a curve yet has no time to lose: it may begin as slowly as it needs.
        for _ in 0..SLOWER_ENTRIES {
            if !was_empty || !self.makes_detour() {
                break;
            }
            self.law.state.velocity *= SLOWER;
            self.plan_entry();
        }
        self.since_entry = 0.0;
        self.reference = self.reference_now();
    }

    /// Plans the decay of what the axes have and the curve at its present rate does not have.
    fn plan_entry(&mut self) {
        let law = self.law.state;
        self.residuals = entry::plan(&self.arm, &self.bounds, &self.curve, &law, &self.state);
    }

    /// Returns true if the entry leads an axis far away from the curve.
    fn makes_detour(&self) -> bool {
        (0..self.arm.axes()).any(|axis| entry::is_detour(&self.bounds[axis], &self.residuals[axis]))
    }

    /// Returns the rate with which the time of the curve begins: the highest one that the limits allow and from which it can
    /// stop before the last row.
    fn entry_rate(&self, share: f64) -> f64 {
        let (at, end) = (self.law.state.position, self.curve.end());
        let allowed = self
            .rates
            .between(&self.curve, at, at + self.law.stop_length(1.0));
        let mut rate = share * allowed.0;
        for _ in 0..20 {
            if self.law.stop_length(rate) <= end - at {
                return rate;
            }
            rate *= 0.8;
        }
        0.0
    }

    /// Returns the states of curve and decay at the present time.
    fn reference_now(&self) -> [AxisState; MAX_AXES] {
        let point = self.curve.at(self.law.state.position);
        core::array::from_fn(|axis| {
            let curve = on_curve(&point, axis, &self.law.state);
            let decay = self.residuals[axis].at(self.since_entry).state;
            AxisState {
                position: curve.position + decay.position,
                velocity: curve.velocity + decay.velocity,
                acceleration: curve.acceleration + decay.acceleration,
            }
        })
    }

    /// Returns the states of the axes one period later if they stop.
    fn stopped(&mut self) -> [AxisState; MAX_AXES] {
        self.limit = None;
        self.is_late = true;
        let axes = self.arm.axes();
        core::array::from_fn(|axis| match axis < axes {
            true => self.guards[axis].stopping(self.state[axis], self.period),
            false => self.state[axis],
        })
    }

    /// Returns the states of the axes one period later on the curve, or as near to it as the limits allow.
    fn followed(&mut self, share: f64) -> [AxisState; MAX_AXES] {
        let (at, end) = (self.law.state.position, self.curve.end());
        let ahead = self.law.stop_length(1.0).max(self.curve.period());
        let (allowed, limit) = self.rates.between(&self.curve, at, at + ahead);
        self.limit = limit;
        let errors: [AxisState; MAX_AXES] =
            core::array::from_fn(|axis| difference(&self.state[axis], &self.reference[axis]));
        let rate = share * allowed.min(self.rate_by_deviation(&errors));
        let rate = self
            .rates
            .followed(&self.curve, &self.law.state, rate, self.period);
        self.law.advance(rate, end, self.period);
        self.is_late = end - at <= self.law.stop_length(rate) + self.period;
        self.since_entry += self.period;
        let reference = self.reference_now();
        let before = core::mem::replace(&mut self.reference, reference);
        let used = self.used_ahead(&errors, at, ahead);
        let mut next = self.state;
        for axis in 0..self.arm.axes() {
            let change = reference[axis].acceleration - before[axis].acceleration;
            let used = [used.first[axis], used.second[axis], used.third[axis]];
            let correction = correction(&self.bounds[axis], used, errors[axis], self.period);
            let jerk = change / self.period + correction;
            let (state, limit) = self.guards[axis].next(self.state[axis], jerk);
            next[axis] = state;
            self.limit = limit.map(|kind| (axis, kind)).or(self.limit);
            // The feedback alone would take forever to come to rest.
            let left = difference(&state, &reference[axis]);
            if rests(&reference[axis]) && is_within(&left, RESTING) {
                next[axis] = reference[axis];
            }
        }
        next
    }

    /// Returns the rate of the time of the curve that the deviations of the axes allow: a curve that waits leaves them more of
    /// their limits to come back to it. A deviation includes the distance in which its velocity can be braked: the curve goes on
    /// with an axis that moves with it, not with one that rushes by.
    fn rate_by_deviation(&self, errors: &[AxisState; MAX_AXES]) -> f64 {
        let axes = 0..self.arm.axes();
        let most = axes
            .map(|axis| feedback::reach(&self.bounds[axis], &errors[axis]))
            .fold(0.0, f64::max);
        (1.0 - (most - SLOWING.0) / (SLOWING.1 - SLOWING.0)).clamp(LEAST_RATE, 1.0)
    }

    /// Returns bounds of the derivatives of the curve with respect to real time within `ahead` seconds after its time `at`. The rate
    /// of its time counts: a curve that waits for an axis leaves it nearly all of its limits. With less, the axis could gain a
    /// velocity, such as at the end of its range, that its way back to the curve could not brake. Zeros if no difference in
    /// `errors` needs them.
    fn used_ahead(&self, errors: &[AxisState; MAX_AXES], at: f64, ahead: f64) -> DerivativeBounds {
        let axes = 0..self.arm.axes();
        if axes
            .clone()
            .all(|axis| is_within(&errors[axis], feedback::LINEAR))
        {
            return DerivativeBounds::default();
        }
        let mut used = self.curve.bounds(at, at + ahead);
        let rate = self.law.state.velocity.clamp(0.0, 1.0);
        for axis in axes {
            used.first[axis] *= rate;
            used.second[axis] *= rate * rate;
            used.third[axis] *= rate * rate * rate;
        }
        used
    }

    fn set_point(&self) -> ChunkSetPoint {
        let on_curve = match self.curve.is_empty() {
            true => self.state.map(|state| state.position),
            false => self.curve.at(self.law.state.position).position,
        };
        let axes = 0..self.arm.axes();
        let deviations = axes
            .clone()
            .map(|axis| (self.state[axis].position - on_curve[axis]).abs());
        let at = self.law.state.position;
        ChunkSetPoint {
            state: self.state(),
            deviation: deviations.fold(0.0, f64::max),
            lag: if self.curve.is_empty() {
                0.0
            } else {
                self.now - at
            },
            smoothing: self.smoothing,
            remaining: if self.curve.is_empty() {
                0.0
            } else {
                self.curve.end() - at
            },
            is_late: self.is_late,
            limit: self.limit,
            at_rest: axes.clone().all(|axis| rests(&self.state[axis])),
        }
    }

    /// Returns the state at the last set-point, exactly.
    #[must_use]
    pub fn state(&self) -> JointState {
        JointState::from_axes(&self.state)
    }

    /// Returns the state `elapsed` seconds after the last set-point if each axis stops on its own: for an arm that stops in
    /// steps shorter than a period. `elapsed` may be negative, down to minus one period.
    #[must_use]
    pub fn stopping(&self, elapsed: f64) -> JointState {
        let axes = self.arm.axes();
        JointState::from_axes(&core::array::from_fn(|axis| {
            let (before, now) = (self.previous[axis], self.state[axis]);
            if axis >= axes {
                now
            } else if elapsed >= 0.0 {
                self.guards[axis].stopping(now, elapsed)
            } else {
                let jerk = (now.acceleration - before.acceleration) / self.period;
                before.advanced((elapsed + self.period).max(0.0), jerk)
            }
        }))
    }
}

fn guards(arm: &Arm, ranges: &Ranges, period: f64) -> [Guard; MAX_AXES] {
    let limits = arm.limits();
    core::array::from_fn(|axis| {
        let limits = limits.get(axis).or(limits.first());
        let nothing = rpi_kin::AxisLimits::from_radians(-1.0, 1.0, 1.0);
        Guard::new(limits.copied().unwrap_or(nothing), ranges[axis], period)
    })
}
