//! Curve of a chunk in joint space: a uniform quintic B-spline, with derivatives and rigorous bounds of them.
//!
//! The derivatives of a B-spline are B-splines of the differences of its coefficients, so on a span between two rows they lie
//! in the convex hull of these differences: the largest difference bounds them everywhere, not only at samples. In the same
//! way, coefficients within the ranges of the axes keep the whole curve within them.
//!
//! Source: de Boor, A Practical Guide to Splines, 2001, chapters IX to XI.

use crate::Joints;
use crate::ranges::Ranges;
use alloc::vec::Vec;

/// Degree of the spline.
const DEGREE: usize = 5;

/// Largest number of rows of a curve: those of a chunk and as many of the previous one that are still to be executed.
pub(super) const MAX_CURVE_ROWS: usize = 2 * super::MAX_ROWS;

/// Largest number of coefficients of a curve.
pub(super) const MAX_COEFFICIENTS: usize = MAX_CURVE_ROWS + DEGREE - 1;

/// Joint positions on a curve, with derivatives with respect to the time of the curve: rad, rad/s, rad/s², rad/s³.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CurvePoint {
    pub(super) position: Joints,
    pub(super) first: Joints,
    pub(super) second: Joints,
    pub(super) third: Joints,
}

/// Largest magnitudes of the first three derivatives of a curve, per axis: rad/s, rad/s², rad/s³.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct DerivativeBounds {
    pub(super) first: Joints,
    pub(super) second: Joints,
    pub(super) third: Joints,
}

/// Curve through, or near, rows of joint positions that are one period apart.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    /// Time of the first row, s.
    start: f64,
    /// Time between two rows, s.
    period: f64,
    rows: usize,
    coefficients: Vec<Joints>,
}

impl Curve {
    /// Creates a curve without rows, with memory for the largest one.
    pub(super) fn empty() -> Self {
        Self {
            start: 0.0,
            period: 1.0,
            rows: 0,
            coefficients: Vec::with_capacity(MAX_COEFFICIENTS),
        }
    }

    /// Makes this a curve of `rows` rows with coefficients 0; `start` is the time of the first row, `period` the time
    /// between two rows, s.
    pub(super) fn reset(&mut self, rows: usize, start: f64, period: f64) {
        (self.rows, self.start, self.period) = (rows, start, period);
        self.coefficients.clear();
        let count = (rows + DEGREE - 1).min(MAX_COEFFICIENTS);
        self.coefficients.resize(count, Joints::default());
    }

    pub(super) fn coefficients_mut(&mut self) -> &mut [Joints] {
        &mut self.coefficients
    }

    /// Returns true if the curve has no rows.
    pub(super) fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// Time of the first row, s.
    pub(super) fn start(&self) -> f64 {
        self.start
    }

    /// Time between two rows, s.
    pub(super) fn period(&self) -> f64 {
        self.period
    }

    /// Time of the last row, s.
    pub(super) fn end(&self) -> f64 {
        self.start + self.period * self.rows.saturating_sub(1) as f64
    }

    /// Moves all coefficients, and so the whole curve, into `ranges` (rad). Returns true if one has changed.
    pub(super) fn clamp(&mut self, ranges: &Ranges) -> bool {
        let mut is_changed = false;
        for joints in &mut self.coefficients {
            for (joint, range) in joints.iter_mut().zip(ranges) {
                let inside = joint.max(range.lower).min(range.upper);
                is_changed |= inside != *joint;
                *joint = inside;
            }
        }
        is_changed
    }

    /// Returns position and derivatives at a time (s), which is limited to the times of the rows.
    pub(super) fn at(&self, time: f64) -> CurvePoint {
        let (span, share) = self.place(time);
        let mut point = CurvePoint::default();
        let Some(near) = self.coefficients.get(span..=span + DEGREE) else {
            return point;
        };
        let weights = Weights::at(share);
        let [per, per2, per3] = self.rates();
        (0..point.position.len()).for_each(|axis| {
            let c: [f64; 6] = core::array::from_fn(|k| near[k][axis]);
            let d: [f64; 5] = core::array::from_fn(|k| c[k + 1] - c[k]);
            let dd: [f64; 4] = core::array::from_fn(|k| d[k + 1] - d[k]);
            let ddd: [f64; 3] = core::array::from_fn(|k| dd[k + 1] - dd[k]);
            point.position[axis] = dot(&weights.quintic, &c);
            point.first[axis] = per * dot(&weights.quartic, &d);
            point.second[axis] = per2 * dot(&weights.cubic, &dd);
            point.third[axis] = per3 * dot(&weights.quadratic, &ddd);
        });
        point
    }

    /// Returns the position at a time (s), which is limited to the times of the rows, rad.
    pub(super) fn position(&self, time: f64) -> Joints {
        let (span, share) = self.place(time);
        let mut position = Joints::default();
        if let Some(near) = self.coefficients.get(span..=span + DEGREE) {
            let weights = Weights::at(share).quintic;
            for (axis, value) in position.iter_mut().enumerate() {
                *value = dot(&weights, &core::array::from_fn(|k| near[k][axis]));
            }
        }
        position
    }

    /// Returns bounds of the derivatives between the times `from` and `to` (s).
    pub(super) fn bounds(&self, from: f64, to: f64) -> DerivativeBounds {
        let (first, last) = (self.place(from).0, self.place(to).0 + DEGREE);
        let mut bounds = DerivativeBounds::default();
        let last = last.min(self.coefficients.len().saturating_sub(1));
        let [per, per2, per3] = self.rates();
        let c = &self.coefficients;
        for k in first..last {
            (0..bounds.first.len()).for_each(|axis| {
                let d = c[k + 1][axis] - c[k][axis];
                bounds.first[axis] = bounds.first[axis].max(per * d.abs());
                if k + 2 > last {
                    return;
                }
                let dd = c[k + 2][axis] - 2.0 * c[k + 1][axis] + c[k][axis];
                bounds.second[axis] = bounds.second[axis].max(per2 * dd.abs());
                if k + 3 > last {
                    return;
                }
                let ddd = c[k + 3][axis] - 3.0 * (c[k + 2][axis] - c[k + 1][axis]) - c[k][axis];
                bounds.third[axis] = bounds.third[axis].max(per3 * ddd.abs());
            });
        }
        bounds
    }

    /// Returns the span of a time (s) and the share of the span that has passed, 0 to 1.
    pub(super) fn place(&self, time: f64) -> (usize, f64) {
        let last = self.rows.saturating_sub(2) as f64;
        // A cast of NaN is 0.
        let rows = ((time - self.start) / self.period).max(0.0).min(last + 1.0);
        let span = libm::floor(rows).min(last);
        (span as usize, rows - span)
    }

    /// Rates of the first three derivatives: 1/s, 1/s², 1/s³.
    fn rates(&self) -> [f64; 3] {
        let per = 1.0 / self.period;
        [per, per * per, per * per * per]
    }
}

fn dot<const N: usize>(weights: &[f64; N], values: &[f64; N]) -> f64 {
    weights.iter().zip(values).map(|(w, v)| w * v).sum()
}

/// Values of the basis functions of degree 5, 4, 3 and 2 on a span.
struct Weights {
    quintic: [f64; 6],
    quartic: [f64; 5],
    cubic: [f64; 4],
    quadratic: [f64; 3],
}

impl Weights {
    /// Returns the values at the share `u` (0 to 1) of the span.
    fn at(u: f64) -> Self {
        let quadratic = raised(&[1.0 - u, u], u);
        let cubic = raised(&quadratic, u);
        let quartic = raised(&cubic, u);
        Self {
            quintic: raised(&quartic, u),
            quartic,
            cubic,
            quadratic,
        }
    }
}

/// Returns the basis functions of the next degree: Cox and de Boor's recursion for uniform knots.
fn raised<const N: usize, const M: usize>(lower: &[f64; N], u: f64) -> [f64; M] {
    let mut upper = [0.0; M];
    for (r, value) in lower.iter().enumerate() {
        let part = value / N as f64;
        upper[r] += (r as f64 + 1.0 - u) * part;
        upper[r + 1] += (u + (N - 1 - r) as f64) * part;
    }
    upper
}
