//! Least-squares smoothing of the rows of a chunk: the curve near the rows with little third derivative.
//!
//! The coefficients minimise the sum of the squared deviations from the rows (and from their velocities, if given) plus
//! `smoothing` times the sum of the squared third differences of the coefficients. This is a penalised spline; its equations
//! form a band, so the work is linear in the number of rows.
//!
//! Source: Eilers and Marx, Flexible smoothing with B-splines and penalties, Statistical Science, 1996.

use super::curve::{Curve, MAX_COEFFICIENTS, MAX_CURVE_ROWS};
use crate::Joints;
use alloc::vec;
use alloc::vec::Vec;

/// Number of diagonals below the main one.
const BAND: usize = 4;

/// Values of the basis functions of degree 5 at a row.
const VALUE: [f64; 5] = [
    1.0 / 120.0,
    26.0 / 120.0,
    66.0 / 120.0,
    26.0 / 120.0,
    1.0 / 120.0,
];

/// First derivatives of the basis functions of degree 5 at a row, times the period.
const SLOPE: [f64; 5] = [-1.0 / 24.0, -10.0 / 24.0, 0.0, 10.0 / 24.0, 1.0 / 24.0];

/// Coefficients of the third difference.
const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];

/// Rows of joint positions that a curve is fitted to.
#[derive(Clone, Debug)]
pub(super) struct Rows {
    /// Time of the first row and time between two rows, s.
    pub(super) start: f64,
    pub(super) period: f64,
    /// Joint positions of each row, rad.
    pub(super) positions: Vec<Joints>,
    /// Joint velocities of each row, rad/s; `None` for a row without.
    pub(super) velocities: Vec<Option<Joints>>,
}

impl Rows {
    /// Creates an empty list of rows, with memory for the longest one.
    pub(super) fn empty() -> Self {
        Self {
            start: 0.0,
            period: 1.0,
            positions: Vec::with_capacity(MAX_CURVE_ROWS),
            velocities: Vec::with_capacity(MAX_CURVE_ROWS),
        }
    }

    pub(super) fn clear(&mut self, start: f64, period: f64) {
        (self.start, self.period) = (start, period);
        self.positions.clear();
        self.velocities.clear();
    }

    /// Adds a row; a row beyond the maximum number is ignored.
    pub(super) fn push(&mut self, position: Joints, velocity: Option<Joints>) {
        if self.positions.len() < MAX_CURVE_ROWS {
            self.positions.push(position);
            self.velocities.push(velocity);
        }
    }
}

/// Memory of a fit: the band matrix of its equations.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    /// Entry `[i][k]` is that of row i and column i - k.
    matrix: Vec<[f64; BAND + 1]>,
}

impl Fit {
    pub(super) fn new() -> Self {
        Self {
            matrix: vec![[0.0; BAND + 1]; MAX_COEFFICIENTS],
        }
    }

    /// Fits `curve` to `rows` with the weight `smoothing` (positive, no unit) of the third differences. Returns the largest
    /// deviation of the curve from a row, rad.
    pub(super) fn run(&mut self, rows: &Rows, smoothing: f64, curve: &mut Curve) -> f64 {
        let count = rows.positions.len();
        curve.reset(count, rows.start, rows.period);
        self.assemble(rows, smoothing, curve.coefficients_mut());
        let size = curve.coefficients_mut().len();
        self.factorise(size);
        self.solve(curve.coefficients_mut());
        let origin = rows.positions.first().copied().unwrap_or_default();
        for joints in curve.coefficients_mut() {
            add(joints, 1.0, &origin);
        }
        deviation(rows, curve)
    }

    /// Sets up the equations; the right-hand sides of all axes go to `right`. Positions are taken relative to the first row,
    /// so that rounding does not grow with them.
    fn assemble(&mut self, rows: &Rows, smoothing: f64, right: &mut [Joints]) {
        self.matrix[..right.len()].fill([0.0; BAND + 1]);
        let origin = rows.positions.first().copied().unwrap_or_default();
        for (k, (position, velocity)) in rows.positions.iter().zip(&rows.velocities).enumerate() {
            let mut relative = *position;
            add(&mut relative, -1.0, &origin);
            self.add_square(k, &VALUE, 1.0);
            for (j, weight) in VALUE.iter().enumerate() {
                add(&mut right[k + j], *weight, &relative);
            }
            let Some(velocity) = velocity else { continue };
            self.add_square(k, &SLOPE, 1.0);
            for (j, weight) in SLOPE.iter().enumerate() {
                add(&mut right[k + j], weight * rows.period, velocity);
            }
        }
        for k in 0..right.len().saturating_sub(THIRD.len() - 1) {
            self.add_square(k, &THIRD, smoothing);
        }
    }

    /// Adds `weight` times the product of a row of factors with itself, beginning at the unknown `at`.
    fn add_square(&mut self, at: usize, factors: &[f64], weight: f64) {
        for (i, one) in factors.iter().enumerate() {
            for (j, other) in factors.iter().enumerate().take(i + 1) {
                self.matrix[at + i][i - j] += weight * one * other;
            }
        }
    }

    /// Replaces the matrix by its Cholesky factors L D Lᵀ: D on the main diagonal, L below.
    fn factorise(&mut self, size: usize) {
        for i in 0..size {
            for k in (1..=BAND.min(i)).rev() {
                let j = i - k;
                let mut entry = self.matrix[i][k];
                for m in (k + 1)..=BAND.min(i) {
                    let l = i - m;
                    entry -= self.matrix[i][m] * self.matrix[l][0] * self.matrix[j][j - l];
                }
                self.matrix[i][k] = entry / self.matrix[j][0];
            }
            let lost: f64 = (1..=BAND.min(i))
                .map(|k| self.matrix[i][k] * self.matrix[i][k] * self.matrix[i - k][0])
                .sum();
            // The matrix is positive definite; the bound is for rounding only.
            self.matrix[i][0] = (self.matrix[i][0] - lost).max(f64::EPSILON);
        }
    }

    /// Solves the factorised equations for all axes; `values` are the right-hand sides and become the solutions.
    fn solve(&self, values: &mut [Joints]) {
        let size = values.len();
        for i in 0..size {
            for k in 1..=BAND.min(i) {
                let before = values[i - k];
                add(&mut values[i], -self.matrix[i][k], &before);
            }
        }
        for i in (0..size).rev() {
            let divisor = self.matrix[i][0];
            values[i].iter_mut().for_each(|value| *value /= divisor);
            for k in 1..=BAND.min(size - 1 - i) {
                let after = values[i + k];
                add(&mut values[i], -self.matrix[i + k][k], &after);
            }
        }
    }
}

/// Returns the largest deviation of a curve from the rows, rad.
pub(super) fn deviation(rows: &Rows, curve: &Curve) -> f64 {
    let mut most = 0.0f64;
    for (k, position) in rows.positions.iter().enumerate() {
        let at = curve.position(rows.start + rows.period * k as f64);
        for (one, other) in at.iter().zip(position) {
            most = most.max((one - other).abs());
        }
    }
    most
}

fn add(to: &mut Joints, factor: f64, joints: &Joints) {
    for (value, joint) in to.iter_mut().zip(joints) {
        *value += factor * joint;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(count: usize, period: f64, with_velocities: bool) -> Rows {
        let mut rows = Rows::empty();
        rows.clear(3.0, period);
        for k in 0..count {
            let (sine, cosine) = rpi_math::sincos(2.0 * period * k as f64);
            let velocity = with_velocities.then_some([2.0 * cosine; 7]);
            rows.push([1.0 + sine; 7], velocity);
        }
        rows
    }

    #[test]
    fn a_smooth_curve_is_met_with_its_derivatives() {
        for with_velocities in [false, true] {
            let rows = rows(50, 0.02, with_velocities);
            let mut curve = Curve::empty();
            let deviation = Fit::new().run(&rows, 1e-3, &mut curve);
            assert!(deviation < 1e-6, "{deviation}");
            for time in [0.2, 0.5101, 0.777] {
                let at = curve.at(3.0 + time);
                let (sine, cosine) = rpi_math::sincos(2.0 * time);
                let off = [
                    at.position[3] - 1.0 - sine,
                    at.first[3] - 2.0 * cosine,
                    at.second[3] + 4.0 * sine,
                    at.third[3] + 8.0 * cosine,
                ];
                let within = off.iter().zip([1e-6, 1e-4, 1e-2, 0.3]);
                assert!(
                    within.clone().all(|(off, most)| off.abs() < most),
                    "{off:?}"
                );
            }
        }
    }

    #[test]
    fn bounds_of_the_derivatives_hold_everywhere_and_are_close() {
        let rows = rows(80, 0.05, false);
        let mut curve = Curve::empty();
        Fit::new().run(&rows, 0.1, &mut curve);
        let (mut first, mut second, mut third) = (0.0f64, 0.0f64, 0.0f64);
        let bounds = curve.bounds(4.0, 6.0);
        for k in 0..=2000 {
            let at = curve.at(4.0 + 1e-3 * f64::from(k));
            first = first.max(at.first[0].abs());
            second = second.max(at.second[0].abs());
            third = third.max(at.third[0].abs());
        }
        for (most, bound) in [
            (first, bounds.first[0]),
            (second, bounds.second[0]),
            (third, bounds.third[0]),
        ] {
            assert!(most <= bound && bound < 1.05 * most, "{most} {bound}");
        }
    }

    #[test]
    fn few_rows_are_met() {
        let rows = rows(4, 0.1, false);
        let mut curve = Curve::empty();
        assert!(Fit::new().run(&rows, 1e-3, &mut curve) < 1e-4);
    }
}
