//! The chunk that is being smoothed and comes into force next.

use super::corridor::Corridor;
use super::curve::Curve;
use super::fit::{Fit, Rows, deviation};
use super::law::{RateBounds, Rates, TimeLaw};
use super::rows::{ChunkRows, InForce, RowTimes, combine, extend};
use super::{ChunkError, ChunkOptions, Seam};
use crate::Arm;
use crate::ranges::Ranges;
use rpi_kin::MAX_AXES;
use rpi_kin::state_to_rest::Bounds;

/// Weakest smoothing: what passes are frequencies up to the highest one that the rows can carry.
const WEAKEST: f64 = 1e-3;

/// Factor between two degrees of smoothing: the frequencies that pass shrink to 0.63 (its sixth root).
const FACTOR: f64 = 16.0;

/// Number of degrees of smoothing.
const DEGREES: u32 = 9;

/// Stage of the preparation of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Idle,
    /// The next cycle tries this degree of smoothing.
    Trying(u32),
    /// The next cycle takes this degree, the strongest one with a permitted deviation.
    Returning(u32),
    /// The next cycle chooses the stop at the last row.
    Stopping,
    Ready,
}

/// Chunk in preparation.
#[derive(Clone, Debug)]
pub(super) struct Pending {
    rows: Rows,
    fit: Fit,
    curve: Curve,
    rates: Rates,
    stop: RateBounds,
    stage: Stage,
    most: f64,
    pub(super) is_appended: bool,
    /// Times of the rows of the newest chunk.
    pub(super) times: RowTimes,
    /// Largest deviation of the curve from a row, rad.
    pub(super) deviation: f64,
    /// Largest distance of a row from the ranges of the axes, rad.
    pub(super) outside: f64,
}

impl Pending {
    pub(super) fn new() -> Self {
        Self {
            rows: Rows::empty(),
            fit: Fit::new(),
            curve: Curve::empty(),
            rates: Rates::empty(),
            stop: TimeLaw::standing().bounds,
            stage: Stage::Idle,
            most: 0.0,
            is_appended: false,
            times: RowTimes::default(),
            deviation: 0.0,
            outside: 0.0,
        }
    }

    /// Drops the chunk in preparation.
    pub(super) fn drop_chunk(&mut self) {
        self.stage = Stage::Idle;
    }

    pub(super) fn is_idle(&self) -> bool {
        self.stage == Stage::Idle
    }

    pub(super) fn is_ready(&self) -> bool {
        self.stage == Stage::Ready
    }

    /// Accepts a chunk. It replaces one in preparation, unless it is appended to it. An error leaves one in preparation as it is.
    pub(super) fn accept(
        &mut self,
        in_force: &InForce<'_>,
        chunk: &ChunkRows<'_>,
        options: &ChunkOptions,
        ranges: &Ranges,
    ) -> Result<(), ChunkError> {
        let count = chunk.check(in_force.axes)?;
        let is_valid = (0.0..=0.95).contains(&options.previous_weight)
            && options.smoothing >= 0.0
            && options.smoothing.is_finite();
        if !is_valid {
            return Err(ChunkError::Option);
        }
        if options.seam == Seam::Append && !self.is_idle() {
            return self.append(chunk, (count, in_force.axes), options, ranges);
        }
        let is_appended = options.seam == Seam::Append && !in_force.curve.is_empty();
        let times = RowTimes {
            zero: match is_appended {
                true => in_force.curve.end() + chunk.period,
                false => in_force.now - chunk.age,
            },
            period: chunk.period,
            count,
        };
        self.outside = combine(in_force, chunk, &times, options, ranges, &mut self.rows)?;
        (self.is_appended, self.times) = (is_appended, times);
        self.most = options.smoothing;
        self.stage = Stage::Trying(0);
        Ok(())
    }

    /// Appends a chunk with these numbers of rows and axes to the one in preparation, and begins to prepare both.
    fn append(
        &mut self,
        chunk: &ChunkRows<'_>,
        (count, axes): (usize, usize),
        options: &ChunkOptions,
        ranges: &Ranges,
    ) -> Result<(), ChunkError> {
        let rows = self.rows.positions.len();
        let outside = extend(&mut self.rows, chunk, (count, axes), ranges)?;
        self.outside = self.outside.max(outside);
        self.times = RowTimes {
            zero: self.rows.start + rows as f64 * self.rows.period,
            period: chunk.period,
            count,
        };
        self.most = options.smoothing;
        self.stage = Stage::Trying(0);
        Ok(())
    }

    /// Tries one degree of smoothing; `at` is the present time of the curve, s. The weakest degree is taken with which the
    /// limits of the axes do not slow the arm down.
    pub(super) fn prepare(
        &mut self,
        arm: &Arm,
        bounds: &[Bounds; MAX_AXES],
        ranges: &Ranges,
        at: f64,
    ) {
        let (degree, is_last) = match self.stage {
            Stage::Trying(degree) => (degree, degree + 1 == DEGREES),
            Stage::Returning(degree) => (degree, true),
            Stage::Stopping => {
                self.stop = RateBounds::fit(arm, bounds, &self.curve);
                self.stage = Stage::Ready;
                return;
            }
            Stage::Idle | Stage::Ready => return,
        };
        let smoothing = (0..degree).fold(WEAKEST, |smoothing, _| FACTOR * smoothing);
        self.deviation = self.fit.run(&self.rows, smoothing, &mut self.curve);
        let corridor = Corridor::new(bounds, self.rows.period, self.most);
        let is_confined = corridor.confine(&self.rows, ranges, self.curve.coefficients_mut());
        if self.curve.clamp(ranges) || is_confined {
            self.deviation = deviation(&self.rows, &self.curve);
        }
        let slowest = self.rates.compute(arm, bounds, &self.curve, at);
        self.stage = match self.stage {
            Stage::Trying(_) if self.deviation > self.most && degree > 0 => {
                Stage::Returning(degree - 1)
            }
            _ if slowest >= 1.0 || is_last => Stage::Stopping,
            _ if self.deviation > self.most => Stage::Stopping,
            _ => Stage::Trying(degree + 1),
        };
    }

    /// Exchanges the prepared curve and its rates for those in force. Returns the bounds of the rate.
    pub(super) fn exchange(&mut self, curve: &mut Curve, rates: &mut Rates) -> RateBounds {
        core::mem::swap(curve, &mut self.curve);
        core::mem::swap(rates, &mut self.rates);
        self.stage = Stage::Idle;
        self.stop
    }
}
