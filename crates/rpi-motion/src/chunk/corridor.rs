//! Corridor around the rows of a chunk, which its curve does not leave.
//!
//! A least-squares spline swings over where rows jump: by a tenth of a jump in the middle, and by a quarter near the ends of the
//! rows, where too few rows determine the outermost coefficients. The arm would follow that curve to places that no row asks for,
//! farther than it needs for braking.
//!
//! The coefficient at a row therefore keeps within a margin of this row and its neighbours, and with the coefficients the curve
//! does. The margin is the permitted deviation by smoothing plus `h² a / 4`, where `h` is the time between two rows and `a` the
//! acceleration of the axis: a quintic spline with second derivatives up to `a` lies within `h² a / 4` of its coefficient at a row,
//! because its value there is the coefficient plus 30/120 of second differences, each at most `h² a`. So the corridor changes no
//! curve that the axis can follow without slowing down. Where it does change a curve, the curve rounds the jumps off instead.
//!
//! The two coefficients beyond each end are not at a row. If they bend the curve by more than `a`, or if a coefficient at a row has
//! moved, they continue the curve straight such that it meets the row at the end.

use super::fit::Rows;
use crate::Joints;
use crate::ranges::Ranges;
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{MAX_AXES, Range};

/// Number of coefficients beyond each end of the rows.
const OUTER: usize = 2;

/// Number of coefficients that determine the curve at a row.
const NEAR: usize = 5;

/// Corridor around rows, with its sizes for each axis.
pub(super) struct Corridor {
    /// Distance that the coefficient at a row may have from this row and its neighbours, rad.
    margin: Joints,
    /// Largest second difference of the coefficients of a curve that the axis can follow, rad.
    bend: Joints,
}

impl Corridor {
    /// Creates the corridor of rows that are `period` seconds apart, for axes with `bounds` and a permitted deviation by smoothing
    /// of `smoothing` (rad).
    pub(super) fn new(bounds: &[Bounds; MAX_AXES], period: f64, smoothing: f64) -> Self {
        let bend = bounds.map(|bounds| period * period * bounds.acceleration);
        Self {
            margin: bend.map(|bend| smoothing + bend / 4.0),
            bend,
        }
    }

    /// Moves the coefficients of a curve near `rows` into the corridor. The rows lie within `ranges` (rad). Returns true if a
    /// coefficient has changed.
    pub(super) fn confine(
        &self,
        rows: &Rows,
        ranges: &Ranges,
        coefficients: &mut [Joints],
    ) -> bool {
        let (Some(first), Some(last)) = (rows.positions.first(), rows.positions.last()) else {
            return false;
        };
        let mut is_changed = false;
        for axis in 0..MAX_AXES {
            let is_moved = self.confine_inner(axis, &rows.positions, &ranges[axis], coefficients);
            for (row, is_last) in [(first[axis], false), (last[axis], true)] {
                let mut end = End {
                    coefficients: &mut *coefficients,
                    axis,
                    is_last,
                };
                let is_bent = (0..OUTER).any(|k| end.bend(k) > self.bend[axis]);
                if is_moved || is_bent {
                    end.continue_straight(row, &ranges[axis]);
                    is_changed = true;
                }
            }
        }
        is_changed
    }

    /// Moves the coefficients of an axis that are at rows, into its `range` (rad), too. Returns true if one has changed.
    fn confine_inner(
        &self,
        axis: usize,
        rows: &[Joints],
        range: &Range,
        coefficients: &mut [Joints],
    ) -> bool {
        let mut is_moved = false;
        let margin = self.margin[axis];
        for (k, row) in rows.iter().enumerate() {
            let before = rows[k.saturating_sub(1)][axis];
            let after = rows.get(k + 1).unwrap_or(row)[axis];
            let low = row[axis].min(before).min(after) - margin;
            let high = row[axis].max(before).max(after) + margin;
            let value = &mut coefficients[k + OUTER][axis];
            let kept = value.max(low.max(range.lower)).min(high.min(range.upper));
            is_moved |= kept != *value;
            *value = kept;
        }
        is_moved
    }
}

/// Coefficients of an axis, counted from one end of the curve.
struct End<'a> {
    coefficients: &'a mut [Joints],
    axis: usize,
    is_last: bool,
}

impl End<'_> {
    fn index(&self, k: usize) -> usize {
        match self.is_last {
            true => self.coefficients.len() - 1 - k,
            false => k,
        }
    }

    fn get(&self, k: usize) -> f64 {
        self.coefficients[self.index(k)][self.axis]
    }

    fn set(&mut self, k: usize, value: f64) {
        let index = self.index(k);
        self.coefficients[index][self.axis] = value;
    }

    /// Returns the magnitude of the second difference that begins at the coefficient `k`, rad.
    fn bend(&self, k: usize) -> f64 {
        (self.get(k) - 2.0 * self.get(k + 1) + self.get(k + 2)).abs()
    }

    /// Sets the outer coefficients such that the curve goes on straight and meets `row` (rad) at the end. If they would leave the
    /// `range` of the axis, the last row is repeated instead, so that the arm stops there.
    fn continue_straight(&mut self, row: f64, range: &Range) {
        let rest = 65.0 * self.get(2) + 26.0 * self.get(3) + self.get(4);
        let inner = (120.0 * row - rest) / 28.0;
        let outer = 2.0 * inner - self.get(2);
        if range.contains(inner) && range.contains(outer) {
            self.set(1, inner);
            self.set(0, outer);
        } else if self.is_last {
            (0..NEAR).for_each(|k| self.set(k, row));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::curve::Curve;
    use super::super::fit::Fit;
    use super::*;
    use alloc::vec::Vec;

    fn bounds(acceleration: f64) -> [Bounds; MAX_AXES] {
        let bounds = Bounds {
            speed: 2.0,
            acceleration,
            jerk: 1e3,
        };
        [bounds; MAX_AXES]
    }

    /// Fits a curve to rows with the same value for each axis, and confines it. Returns true if it has changed.
    fn confined(
        curve: &mut Curve,
        values: &[f64],
        period: f64,
        acceleration: f64,
        range: Range,
    ) -> bool {
        let mut rows = Rows::empty();
        rows.clear(0.0, period);
        values
            .iter()
            .for_each(|value| rows.push([*value; MAX_AXES], None));
        Fit::new().run(&rows, 1e-3, curve);
        let corridor = Corridor::new(&bounds(acceleration), period, 0.01);
        let is_changed = corridor.confine(&rows, &[range; MAX_AXES], curve.coefficients_mut());
        curve.clamp(&[range; MAX_AXES]) || is_changed
    }

    #[test]
    fn a_curve_that_the_axes_can_follow_is_not_changed() {
        let mut curve = Curve::empty();
        for period in [0.01, 0.02, 0.05, 0.1] {
            for count in [4, 10, 100] {
                let value = |k: usize| rpi_math::sin(1.0 + 2.0 * period * k as f64);
                let values: Vec<f64> = (0..count).map(value).collect();
                let is_changed = confined(&mut curve, &values, period, 4.2, Range::symmetric(9.0));
                assert!(!is_changed, "{period} {count}");
            }
        }
    }

    #[test]
    fn a_jump_at_any_row_is_rounded_off_and_the_last_row_is_met() {
        let mut curve = Curve::empty();
        let period = 0.02;
        let room = 0.01 + period * period * 10.0 / 4.0;
        for count in 4..20 {
            for jump in 1..count {
                for range in [Range::symmetric(9.0), Range::symmetric(1.002)] {
                    let values: Vec<f64> = (0..count).map(|k| f64::from(k >= jump)).collect();
                    assert!(confined(&mut curve, &values, period, 10.0, range));
                    for k in 0..=400 {
                        let at = curve.position(curve.end() * f64::from(k) / 400.0)[3];
                        let is_near = at > -room && at < 1.0 + room;
                        assert!(is_near, "{count} {jump} {k} {at}");
                    }
                    let end = curve.position(curve.end())[3];
                    assert!((end - 1.0).abs() < 1e-9, "{count} {jump} {end}");
                }
            }
        }
    }
}
