//! Dense matrices of reals, stored row by row. Sizes are checked when a net is loaded. Indices count from 0.

use super::linear_solver;
use crate::aggregates::{Array, Matrix};
use crate::context::{Context, FaultCode};
use crate::macros::primitive;
use crate::registry::Prim;
use rpi_image::{Scalar, ShapeArgs, ShapeRule, Type};

pub(super) const ALL: &[Prim] = &[CREATE, GET, SET, TRANSPOSE, SCALE, MULTIPLY, APPLY, SOLVE];

primitive! {
    /// Matrix of zeros with `Rows` rows and `Cols` columns.
    CREATE = "Core::MatrixCreate";
    in {}
    param { Rows: i64 = Int(1); Cols: i64 = Int(1) }
    out { outMatrix: Matrix }
    shape ShapeRule::Computed(|args| Some(Type::Matrix(args.size(0)?, args.size(1)?)));
    presence strict work 36;
    c Code("memset(outMatrix, 0, sizeof outMatrix[0] * (size_t)outMatrix_rows * (size_t)outMatrix_cols);");
    bulk |cx, _, _, (), (matrix,)| matrix.elements().fill(cx.slots, 0.0)
}

primitive! {
    /// Element at row `Row` and column `Col`, counted from 0.
    GET = "Core::MatrixGet";
    in { inMatrix: Matrix }
    param { Row: i64 = Int(0); Col: i64 = Int(0) }
    out { outValue: f64 }
    shape ShapeRule::Computed(|args| has_element(args, 0, 1).then_some(Type::Scalar(Scalar::Real)));
    presence strict work 1 faults;
    c Code(r"
if (Row < 0 || Row >= inMatrix_rows || Col < 0 || Col >= inMatrix_cols) {
  rpi_fault(cx, RPI_INDEX_OUT_OF_RANGE, at);
}
*outValue = rpi_element(inMatrix, inMatrix_rows, inMatrix_cols, Row, Col);
");
    full |cx, place, _, (row, col), (matrix,)| (element(cx, place, matrix, row, col),)
}

primitive! {
    /// Matrix with the element at row `Row` and column `Col`, counted from 0, replaced by `inValue`. `Rows` and `Cols`
    /// are not used.
    SET = "Core::MatrixSet";
    in { inMatrix: Matrix; inValue: f64 = Value(Real(0.0)) }
    param { Rows: i64 = Int(0); Cols: i64 = Int(0); Row: i64 = Int(0); Col: i64 = Int(0) }
    out { outMatrix: Matrix }
    shape ShapeRule::Computed(|args| has_element(args, 2, 3).then_some(*args.inputs.first()?)?);
    presence strict work 36 faults;
    c Code(r"
memcpy(outMatrix, inMatrix, sizeof outMatrix[0] * (size_t)outMatrix_rows * (size_t)outMatrix_cols);
if (Row < 0 || Row >= outMatrix_rows || Col < 0 || Col >= outMatrix_cols) {
  rpi_fault(cx, RPI_INDEX_OUT_OF_RANGE, at);
} else {
  outMatrix[Row * outMatrix_cols + Col] = inValue;
}
");
    bulk |cx, place, (_, _, row, col), (from, value), (to,)| {
        let copied = to.elements().copy(cx.slots, from.elements(), 0);
        if !(copied && to.set(cx.slots, index(row), index(col), value)) {
            cx.fault(FaultCode::IndexOutOfRange, place);
        }
    }
}

primitive! {
    /// Transposed matrix. `Rows` and `Cols` are not used.
    TRANSPOSE = "Core::MatrixTranspose";
    in { inMatrix: Matrix }
    param { Rows: i64 = Int(0); Cols: i64 = Int(0) }
    out { outMatrix: Matrix }
    shape ShapeRule::Computed(|args| args.shape(0).map(|(rows, cols)| Type::Matrix(cols, rows)));
    presence strict work 36;
    c Code(r"
int32_t row;
int32_t col;
for (row = 0; row < outMatrix_rows; row += 1) {
  for (col = 0; col < outMatrix_cols; col += 1) {
    outMatrix[row * outMatrix_cols + col] = inMatrix[col * outMatrix_rows + row];
  }
}
");
    bulk |cx, _, _, (from,), (to,)| to.fill_with(cx.slots, |cells, row, col| from.get_or_zero(cells, col, row))
}

primitive! {
    /// Matrix times a real. `Rows` and `Cols` are not used.
    SCALE = "Core::MatrixScale";
    in { inMatrix: Matrix; inValue: f64 = Value(Real(0.0)) }
    param { Rows: i64 = Int(0); Cols: i64 = Int(0) }
    out { outMatrix: Matrix }
    shape ShapeRule::Computed(|args| *args.inputs.first()?);
    presence strict work 36;
    c Code("rpi_scaled(inMatrix, inValue, outMatrix_rows * outMatrix_cols, outMatrix);");
    bulk |cx, _, _, (from, factor), (to,)| {
        to.fill_with(cx.slots, |cells, row, col| from.get_or_zero(cells, row, col) * factor);
    }
}

primitive! {
    /// Product of two matrices. `Rows` and `Cols` are not used.
    MULTIPLY = "Core::MatrixMultiply";
    in { inMatrix1: Matrix; inMatrix2: Matrix }
    param { Rows: i64 = Int(0); Cols: i64 = Int(0) }
    out { outMatrix: Matrix }
    shape ShapeRule::Computed(product_shape);
    presence strict work 216;
    c Code(r"
int32_t row;
int32_t col;
for (row = 0; row < outMatrix_rows; row += 1) {
  for (col = 0; col < outMatrix_cols; col += 1) {
    double sum = -0.0;
    int32_t k;
    for (k = 0; k < inMatrix1_cols; k += 1) {
      sum += inMatrix1[row * inMatrix1_cols + k] * inMatrix2[k * outMatrix_cols + col];
    }
    outMatrix[row * outMatrix_cols + col] = sum;
  }
}
");
    bulk |cx, _, _, (a, b), (to,)| {
        to.fill_with(cx.slots, |cells, row, col| {
            (0..a.cols).map(|k| a.get_or_zero(cells, row, k) * b.get_or_zero(cells, k, col)).sum()
        });
    }
}

primitive! {
    /// Product of a matrix and a vector. The parameter `Size` has no effect: the connected ports give the sizes.
    APPLY = "Core::MatrixApply";
    in { inMatrix: Matrix; inVector: Array<f64> }
    param { Size: i64 = Int(0) }
    out { outValue: Array<f64> }
    shape ShapeRule::Computed(image_shape);
    presence strict work 36;
    c Code(r"
int32_t row;
for (row = 0; row < inMatrix_rows; row += 1) {
  double sum = -0.0;
  int32_t k;
  for (k = 0; k < inMatrix_cols; k += 1) {
    sum += inMatrix[row * inMatrix_cols + k] * inVector[k];
  }
  outValue[row] = sum;
}
");
    bulk |cx, _, _, (matrix, vector), (to,)| {
        for row in 0..matrix.rows {
            let sum = (0..matrix.cols).map(|k| {
                matrix.get_or_zero(cx.slots, row, k) * vector.get(cx.slots, k as i64).unwrap_or(0.0)
            });
            let sum: f64 = sum.sum();
            to.set(cx.slots, row as i64, sum);
        }
    }
}

primitive! {
    /// Solution x of the linear equations `inMatrix` x = `inResult` by Gaussian elimination with partial pivoting. The
    /// matrix must be square with at most 16 rows. All elements are not a number if the system is singular. `Size` is
    /// not used.
    SOLVE = "Core::MatrixSolve";
    in { inMatrix: Matrix; inResult: Array<f64> }
    param { Size: i64 = Int(0) }
    out { outValue: Array<f64> }
    shape ShapeRule::Computed(solution_shape);
    presence strict work 400;
    c Code("rpi_solve(inMatrix, inResult, inMatrix_rows, outValue);");
    bulk |cx, _, _, (matrix, right), (to,)| linear_solver::solve(cx.slots, matrix, right, to)
}

fn element(cx: &mut Context<'_>, place: u32, matrix: Matrix, row: i64, col: i64) -> f64 {
    matrix
        .get(cx.slots, index(row), index(col))
        .unwrap_or_else(|| {
            cx.fault(FaultCode::IndexOutOfRange, place);
            0.0
        })
}

/// Returns an index as `usize`; a negative index becomes `usize::MAX`, which is out of range of every matrix.
pub(super) fn index(index: i64) -> usize {
    usize::try_from(index).unwrap_or(usize::MAX)
}

/// Returns true if the values of the parameters with the indices `row` and `col` are indices of an element of the
/// matrix at in-port 0.
fn has_element(args: &ShapeArgs<'_>, row: usize, col: usize) -> bool {
    let inside = |index: Option<u32>, size| index.is_some_and(|i| i < size);
    args.shape(0)
        .is_some_and(|(rows, cols)| inside(args.size(row), rows) && inside(args.size(col), cols))
}

fn product_shape(args: &ShapeArgs<'_>) -> Option<Type> {
    let ((rows, inner), (other, cols)) = (args.shape(0)?, args.shape(1)?);
    (inner == other).then_some(Type::Matrix(rows, cols))
}

fn image_shape(args: &ShapeArgs<'_>) -> Option<Type> {
    let (rows, cols) = args.shape(0)?;
    (cols == args.len(1)?).then_some(Type::Array(Scalar::Real, rows))
}

fn solution_shape(args: &ShapeArgs<'_>) -> Option<Type> {
    let (rows, cols) = args.shape(0)?;
    let is_solvable =
        rows == cols && rows == args.len(1)? && rows as usize <= linear_solver::MAX_ROWS;
    is_solvable.then_some(Type::Array(Scalar::Real, rows))
}
