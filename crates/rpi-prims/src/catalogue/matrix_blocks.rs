//! Parts of matrices: blocks, elements of a block as an array, and selected rows and columns.

use super::matrix::index;
use crate::aggregates::{Array, Matrix};
use crate::macros::primitive;
use crate::registry::Prim;
use rpi_image::{Scalar, ShapeArgs, ShapeRule, Type};

pub(super) const ALL: &[Prim] = &[BLOCK_GET, BLOCK_SET, ARRAY_GET, ARRAY_SET, SELECT];

primitive! {
    /// Block of `BlockHeight` rows and `BlockWidth` columns that starts at row `StartRow` and column `StartCol`,
    /// counted from 0.
    BLOCK_GET = "Core::MatrixBlockGet";
    in { inMatrix: Matrix }
    param { StartRow: i64 = Int(0); StartCol: i64 = Int(0); BlockWidth: i64 = Int(1); BlockHeight: i64 = Int(1) }
    out { outMatrix: Matrix }
    shape ShapeRule::Computed(block);
    presence strict work 36;
    c Code(r"
int32_t row;
int32_t col;
for (row = 0; row < outMatrix_rows; row += 1) {
  for (col = 0; col < outMatrix_cols; col += 1) {
    outMatrix[row * outMatrix_cols + col] =
        rpi_element(inMatrix, inMatrix_rows, inMatrix_cols, StartRow + row, StartCol + col);
  }
}
");
    bulk |cx, _, (start_row, start_col, _, _), (from,), (to,)| {
        let (top, left) = (index(start_row), index(start_col));
        to.fill_with(cx.slots, |cells, row, col| from.get_or_zero(cells, top + row, left + col));
    }
}

primitive! {
    /// Matrix with the block at row `StartRow` and column `StartCol`, counted from 0, replaced by `inBlock`. The other
    /// parameters are not used.
    BLOCK_SET = "Core::MatrixBlockSet";
    in { inMatrix: Matrix; inBlock: Matrix }
    param {
        Rows: i64 = Int(0);
        Cols: i64 = Int(0);
        StartRow: i64 = Int(0);
        StartCol: i64 = Int(0);
        BlockWidth: i64 = Int(1);
        BlockHeight: i64 = Int(1)
    }
    out { outMatrix: Matrix }
    shape ShapeRule::Computed(with_block);
    presence strict work 36;
    c Code(r"
int32_t row;
int32_t col;
memcpy(outMatrix, inMatrix, sizeof outMatrix[0] * (size_t)outMatrix_rows * (size_t)outMatrix_cols);
for (row = 0; row < inBlock_rows; row += 1) {
  for (col = 0; col < inBlock_cols; col += 1) {
    outMatrix[(StartRow + row) * outMatrix_cols + StartCol + col] = inBlock[row * inBlock_cols + col];
  }
}
");
    bulk |cx, _, (_, _, start_row, start_col, _, _), (from, block), (to,)| {
        to.elements().copy(cx.slots, from.elements(), 0);
        let (top, left) = (index(start_row), index(start_col));
        for (row, col) in block.indices() {
            let value = block.get_or_zero(cx.slots, row, col);
            to.set(cx.slots, top + row, left + col, value);
        }
    }
}

primitive! {
    /// Array of the first `Size` elements, row by row, of the block that starts at row `StartRow` and column
    /// `StartCol`, counted from 0, and is `BlockWidth` columns wide.
    ARRAY_GET = "Core::MatrixArrayGet";
    in { inMatrix: Matrix }
    param { StartRow: i64 = Int(0); StartCol: i64 = Int(0); BlockWidth: i64 = Int(1); Size: i64 = Int(1) }
    out { outArray: Array<f64> }
    shape ShapeRule::Computed(row_by_row);
    presence strict work 16;
    c Code(r"
const int64_t width = BlockWidth > 1 ? BlockWidth : 1;
int32_t k;
for (k = 0; k < outArray_len; k += 1) {
  outArray[k] = rpi_element(inMatrix, inMatrix_rows, inMatrix_cols, StartRow + k / width, StartCol + k % width);
}
");
    bulk |cx, _, (start_row, start_col, width, _), (from,), (to,)| {
        for k in 0..to.len() {
            let (row, col) = block_index(k, start_row, start_col, width);
            let value = from.get_or_zero(cx.slots, row, col);
            to.set(cx.slots, k as i64, value);
        }
    }
}

primitive! {
    /// Matrix with elements replaced by those of `inArray`, row by row, in the block that starts at row `StartRow` and
    /// column `StartCol`, counted from 0, and is `BlockWidth` columns wide. `Rows` and `Cols` are not used.
    ARRAY_SET = "Core::MatrixArraySet";
    in { inMatrix: Matrix; inArray: Array<f64> = Array(Neutral) }
    param {
        Rows: i64 = Int(0);
        Cols: i64 = Int(0);
        StartRow: i64 = Int(0);
        StartCol: i64 = Int(0);
        BlockWidth: i64 = Int(1)
    }
    out { outMatrix: Matrix }
    shape ShapeRule::Computed(with_array);
    presence strict work 36;
    c Code(r"
const int64_t width = BlockWidth > 1 ? BlockWidth : 1;
int32_t k;
memcpy(outMatrix, inMatrix, sizeof outMatrix[0] * (size_t)outMatrix_rows * (size_t)outMatrix_cols);
for (k = 0; k < inArray_len; k += 1) {
  outMatrix[(StartRow + k / width) * outMatrix_cols + StartCol + k % width] = inArray[k];
}
");
    bulk |cx, _, (_, _, start_row, start_col, width), (from, array), (to,)| {
        to.elements().copy(cx.slots, from.elements(), 0);
        for k in 0..array.len() {
            let (row, col) = block_index(k, start_row, start_col, width);
            let value = array.get(cx.slots, k as i64).unwrap_or(0.0);
            to.set(cx.slots, row, col, value);
        }
    }
}

primitive! {
    /// Rows and columns with the given indices, counted from 0, in the given order. An empty list selects all.
    /// `RowDimension` and `ColumnDimension` are not used.
    SELECT = "Core::MatrixSelect";
    in { inMatrix: Matrix }
    param {
        RowDimension: i64 = Int(0);
        ColumnDimension: i64 = Int(0);
        SelectedRows: Array<i64> = Neutral;
        SelectedCols: Array<i64> = Neutral
    }
    out { outMatrix: Matrix }
    shape ShapeRule::Computed(selection);
    presence strict work 36;
    c Code(r"
int32_t row;
int32_t col;
for (row = 0; row < outMatrix_rows; row += 1) {
  for (col = 0; col < outMatrix_cols; col += 1) {
    outMatrix[row * outMatrix_cols + col] =
        rpi_element(inMatrix, inMatrix_rows, inMatrix_cols, rpi_selected(SelectedRows, SelectedRows_len, row),
                    rpi_selected(SelectedCols, SelectedCols_len, col));
  }
}
");
    bulk |cx, _, (_, _, rows, cols), (from,), (to,)| {
        to.fill_with(cx.slots, |cells, row, col| from.get_or_zero(cells, nth_index(cells, rows, row), nth_index(cells, cols, col)));
    }
}

/// Returns the `k`-th entry of a list of row or column indices, counted from 0; `k` itself if the list is empty, which
/// selects all.
fn nth_index(cells: &[u64], list: Array<i64>, k: usize) -> usize {
    if list.is_empty() {
        k
    } else {
        list.get(cells, k as i64).map_or(usize::MAX, index)
    }
}

/// Returns row and column, in the matrix, of the `k`-th element of a block, counted row by row from 0. The block starts
/// at `start_row` and `start_col` and is `width` columns wide.
fn block_index(k: usize, start_row: i64, start_col: i64, width: i64) -> (usize, usize) {
    let width = index(width.max(1));
    (index(start_row) + k / width, index(start_col) + k % width)
}

/// Returns true if the block of `height` by `width` elements that starts at `row` and `col` lies inside the matrix at
/// in-port 0. False if `row` or `col` is `None`.
fn inside(
    args: &ShapeArgs<'_>,
    row: Option<u32>,
    col: Option<u32>,
    height: u32,
    width: u32,
) -> bool {
    let ends = |start: Option<u32>, len, size| {
        start
            .and_then(|s: u32| s.checked_add(len))
            .is_some_and(|end| end <= size)
    };
    args.shape(0)
        .is_some_and(|(rows, cols)| ends(row, height, rows) && ends(col, width, cols))
}

fn block(args: &ShapeArgs<'_>) -> Option<Type> {
    let (width, height) = (args.size(2)?, args.size(3)?);
    inside(args, args.size(0), args.size(1), height, width).then_some(Type::Matrix(height, width))
}

fn with_block(args: &ShapeArgs<'_>) -> Option<Type> {
    let (height, width) = args.shape(1)?;
    inside(args, args.size(2), args.size(3), height, width).then_some(*args.inputs.first()?)?
}

fn row_by_row(args: &ShapeArgs<'_>) -> Option<Type> {
    let (width, size) = (args.size(2)?.max(1), args.size(3)?);
    let height = size.div_ceil(width);
    inside(args, args.size(0), args.size(1), height, width)
        .then_some(Type::Array(Scalar::Real, size))
}

fn with_array(args: &ShapeArgs<'_>) -> Option<Type> {
    let width = args.size(4)?.max(1);
    let height = args.len(1)?.div_ceil(width);
    inside(args, args.size(2), args.size(3), height, width).then_some(*args.inputs.first()?)?
}

fn selection(args: &ShapeArgs<'_>) -> Option<Type> {
    let (rows, cols) = args.shape(0)?;
    Some(Type::Matrix(
        selected(args, 2, rows)?,
        selected(args, 3, cols)?,
    ))
}

/// Returns the number of rows or columns, out of `size`, that the parameter with index `param` selects; `None` if one
/// of its indices is out of range. An empty list selects all.
fn selected(args: &ShapeArgs<'_>, param: usize, size: u32) -> Option<u32> {
    let list = args.params.get(param)?.slots();
    let in_range = list.iter().all(|&i| i < u64::from(size));
    let count = if list.is_empty() {
        size
    } else {
        u32::try_from(list.len()).ok()?
    };
    in_range.then_some(count)
}
