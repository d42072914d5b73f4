//! Systems of linear equations of bounded size, solved without allocation.

use crate::aggregates::{Array, Matrix};

/// Maximum number of equations of a system, which bounds the time of a solution.
pub(super) const MAX_ROWS: usize = 16;

/// Augmented matrix of a system: the coefficients, and the right-hand side as the last column.
type AugmentedMatrix = [[f64; MAX_ROWS + 1]; MAX_ROWS];

/// Solves `matrix * to = right` by Gaussian elimination with partial pivoting (Golub and Van Loan, Matrix Computations,
/// 3.4). All elements of `to` are not a number if the system is singular.
pub(super) fn solve(cells: &mut [u64], matrix: Matrix, right: Array<f64>, to: Array<f64>) {
    let n = matrix.rows.min(MAX_ROWS);
    let mut rows: AugmentedMatrix = [[0.0; MAX_ROWS + 1]; MAX_ROWS];
    for (r, row) in rows.iter_mut().enumerate().take(n) {
        for (c, value) in row.iter_mut().enumerate().take(n) {
            *value = matrix.get_or_zero(cells, r, c);
        }
        row[MAX_ROWS] = right.get(cells, r as i64).unwrap_or(0.0);
    }
    for column in 0..n {
        eliminate(&mut rows, n, column);
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|c| rows[k][c] * rows[c][MAX_ROWS]).sum();
        rows[k][MAX_ROWS] = (rows[k][MAX_ROWS] - known) / rows[k][k];
    }
    let finite = rows[..n].iter().all(|row| row[MAX_ROWS].is_finite());
    for (k, row) in rows.iter().enumerate().take(n) {
        to.set(
            cells,
            k as i64,
            if finite { row[MAX_ROWS] } else { f64::NAN },
        );
    }
}

/// Swaps the row with the largest entry of column `column` into the pivot position and eliminates the column below the
/// pivot. `n` is the number of equations.
fn eliminate(rows: &mut AugmentedMatrix, n: usize, column: usize) {
    let size = |row: usize| libm::fabs(rows[row][column]);
    let pivot = (column + 1..n).fold(
        column,
        |best, row| if size(row) > size(best) { row } else { best },
    );
    rows.swap(column, pivot);
    let above = rows[column];
    for row in &mut rows[column + 1..n] {
        let factor = row[column] / above[column];
        for (value, top) in row.iter_mut().zip(above).skip(column) {
            *value -= factor * top;
        }
    }
}
