//! Rows of a chunk as they arrive, and their combination with what is left of the previous chunk.

use super::curve::{Curve, MAX_CURVE_ROWS};
use super::fit::Rows;
use super::{ChunkError, ChunkOptions, MAX_ROWS, Seam};
use crate::Joints;
use crate::ranges::Ranges;

/// Smallest number of rows of a chunk.
pub const MIN_ROWS: usize = 4;

/// Smallest and largest time between two rows, s.
pub const PERIODS: (f64, f64) = (0.01, 0.1);

/// Number of rows before the present time that the curve of a new chunk keeps, so that it is smooth at the present time.
const ROWS_BEHIND: f64 = 3.0;

/// Chunk of joint positions, as it arrives.
#[derive(Clone, Copy, Debug)]
pub struct ChunkRows<'a> {
    /// Time between two rows, 0.01 to 0.1 s.
    pub period: f64,
    /// Joint positions, row by row with one number for each axis, rad (m for a linear axis). 4 to 200 rows.
    pub positions: &'a [f64],
    /// Joint velocities, as many as positions, rad/s; `None` if the chunk has none.
    pub velocities: Option<&'a [f64]>,
    /// Time since that of the first row, s: the age of the observation that the chunk is based on. Not negative. Not used if
    /// the chunk is appended.
    pub age: f64,
}

impl ChunkRows<'_> {
    /// Checks the numbers of a chunk for an arm with `axes` axes. Returns the number of rows.
    pub(super) fn check(&self, axes: usize) -> Result<usize, ChunkError> {
        let rows = self.positions.len() / axes.max(1);
        if !(self.period >= PERIODS.0 && self.period <= PERIODS.1) {
            return Err(ChunkError::Period);
        }
        let velocities = self.velocities.unwrap_or_default();
        let is_complete = rows * axes == self.positions.len()
            && self
                .velocities
                .is_none_or(|velocities| velocities.len() == self.positions.len());
        if !(MIN_ROWS..=MAX_ROWS).contains(&rows) || !is_complete {
            return Err(ChunkError::Length);
        }
        let mut numbers = self.positions.iter().chain(velocities);
        let are_usable = numbers.all(|number| number.abs() < LARGEST);
        match are_usable && (0.0..LARGEST).contains(&self.age) {
            true => Ok(rows),
            false => Err(ChunkError::NotFinite),
        }
    }

    fn joints(&self, of: &[f64], row: usize, axes: usize) -> Joints {
        let mut joints = Joints::default();
        let values = of.iter().skip(row * axes).take(axes);
        joints
            .iter_mut()
            .zip(values)
            .for_each(|(joint, value)| *joint = *value);
        joints
    }
}

/// Bound of the magnitude of the numbers of a chunk.
const LARGEST: f64 = 1e6;

/// Times of the rows of a chunk.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RowTimes {
    /// Time of the first row and time between two rows, s.
    pub(super) zero: f64,
    pub(super) period: f64,
    /// Number of rows.
    pub(super) count: usize,
}

impl RowTimes {
    /// Returns the number of the last row, from 0, whose time has come at `time` (s); the first one before that.
    pub(super) fn row_at(&self, time: f64) -> usize {
        // A time that is a multiple of the period but for rounding counts as one. A cast of NaN is 0.
        let rows = (time - self.zero) / self.period + 1e-6;
        (rows.max(0.0) as usize).min(self.count.saturating_sub(1))
    }
}

/// Curve that is in force, with its present time (s) and the number of axes of the arm.
pub(super) struct InForce<'a> {
    pub(super) curve: &'a Curve,
    /// Present time of the clock of the chunks, s.
    pub(super) now: f64,
    /// Present time of the curve: later than `now` at no time, s.
    pub(super) at: f64,
    pub(super) axes: usize,
}

/// Combines a new chunk with rows at `times` with the previous one to `rows`, within `ranges` (rad). Returns the largest distance
/// of a new row from the ranges, rad.
///
/// # Errors
/// [`ChunkError::Stale`] if too few rows lie in the future, [`ChunkError::Full`] if too many rows are left.
pub(super) fn combine(
    in_force: &InForce<'_>,
    chunk: &ChunkRows<'_>,
    times: &RowTimes,
    options: &ChunkOptions,
    ranges: &Ranges,
    rows: &mut Rows,
) -> Result<f64, ChunkError> {
    let RowTimes {
        zero,
        period,
        count,
    } = *times;
    let present = match options.seam {
        Seam::Append if !in_force.curve.is_empty() => in_force.at,
        _ => in_force.now,
    };
    let behind = libm::floor((present - zero) / period) - ROWS_BEHIND;
    let first = match in_force.curve.is_empty() {
        true => behind.max(0.0),
        false => behind.max(libm::ceil((in_force.curve.start() - zero) / period).min(0.0)),
    };
    let left = count as f64 - first;
    if left < MIN_ROWS as f64 + ROWS_BEHIND.min(count as f64 - MIN_ROWS as f64) {
        return Err(ChunkError::Stale);
    }
    if left > MAX_CURVE_ROWS as f64 {
        return Err(ChunkError::Full);
    }
    rows.clear(zero + first * period, period);
    let mut outside = 0.0f64;
    for k in 0..left as usize {
        let number = first + k as f64;
        let row = (number >= 0.0).then_some(number as usize);
        let is_new = row.is_some_and(|row| row >= options.frozen_rows);
        let old = match is_new && options.previous_weight == 0.0 {
            true => None,
            false => old_row(in_force.curve, zero + number * period),
        };
        let (mut position, velocity) = mixed(in_force.axes, chunk, row, old, options);
        outside = outside.max(keep_inside(&mut position, ranges));
        rows.push(position, velocity);
    }
    Ok(outside)
}

/// Adds the rows of an appended chunk with `count` rows to `rows`, which are still in preparation, within `ranges` (rad). Returns
/// the largest distance of a new row from the ranges, rad.
///
/// # Errors
/// [`ChunkError::Full`] if there are too many rows, or if their period is another one; nothing is added then.
pub(super) fn extend(
    rows: &mut Rows,
    chunk: &ChunkRows<'_>,
    (count, axes): (usize, usize),
    ranges: &Ranges,
) -> Result<f64, ChunkError> {
    let is_same_period = (chunk.period - rows.period).abs() < 1e-9;
    if !is_same_period || rows.positions.len() + count > MAX_CURVE_ROWS {
        return Err(ChunkError::Full);
    }
    let mut outside = 0.0f64;
    for row in 0..count {
        let mut position = chunk.joints(chunk.positions, row, axes);
        outside = outside.max(keep_inside(&mut position, ranges));
        let velocity = chunk.velocities.map(|all| chunk.joints(all, row, axes));
        rows.push(position, velocity);
    }
    Ok(outside)
}

/// Moves joint positions into `ranges` (rad). Returns the largest change, rad.
fn keep_inside(joints: &mut Joints, ranges: &Ranges) -> f64 {
    let mut outside = 0.0f64;
    for (joint, range) in joints.iter_mut().zip(ranges) {
        let kept = joint.max(range.lower).min(range.upper);
        outside = outside.max((kept - *joint).abs());
        *joint = kept;
    }
    outside
}

/// Returns the row of the previous curve at a time (s); `None` if it has none there.
fn old_row(curve: &Curve, time: f64) -> Option<Joints> {
    let slack = 1e-6;
    let is_known =
        !curve.is_empty() && time >= curve.start() - slack && time <= curve.end() + slack;
    is_known.then(|| curve.position(time))
}

/// Returns the weighted mean of a row of the new chunk and of the previous curve, with the velocities if the row is a new one
/// alone.
fn mixed(
    axes: usize,
    chunk: &ChunkRows<'_>,
    row: Option<usize>,
    old: Option<Joints>,
    options: &ChunkOptions,
) -> (Joints, Option<Joints>) {
    let Some(row) = row else {
        return (old.unwrap_or_default(), None);
    };
    let mut new = chunk.joints(chunk.positions, row, axes);
    let weight = match old {
        None => 0.0,
        Some(_) if row < options.frozen_rows => 1.0,
        Some(_) => options.previous_weight,
    };
    if weight == 0.0 {
        let velocity = chunk.velocities.map(|all| chunk.joints(all, row, axes));
        return (new, velocity);
    }
    let old = old.unwrap_or_default();
    for (new, old) in new.iter_mut().zip(old) {
        *new += weight * (old - *new);
    }
    (new, None)
}
