//! Tiles of the dense matrices of large fronts: columns that threads treat at the same time.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Columns of a tile of a large front.
pub(crate) const TILE: usize = 128;
/// A front with more operations is divided into tiles, for any number of threads.
pub(crate) const TILED_WORK: f64 = 2e7;

/// Calls `apply(first column, columns)` for every `tile` columns of a matrix, in parallel if there are several tiles.
pub(crate) fn for_each_tile(matrix: MatMut<'_, f64>, tile: usize, apply: impl Fn(usize, MatMut<'_, f64>) + Sync) {
    if matrix.ncols() <= tile {
        return apply(0, matrix);
    }
    let mut tiles = Vec::new();
    let (mut rest, mut start) = (matrix, 0);
    while rest.ncols() > 0 {
        let width = tile.min(rest.ncols());
        let (columns, others) = rest.split_at_col_mut(width);
        tiles.push((start, columns));
        start += width;
        rest = others;
    }
    tiles.into_par_iter().for_each(|(start, columns)| apply(start, columns));
}

/// Subtracts `left * right^T` from columns of a square matrix, on and below the diagonal; `start` is the first column.
pub(crate) fn subtract_products(left: MatRef<'_, f64>, right: MatRef<'_, f64>, start: usize, columns: MatMut<'_, f64>) {
    let width = columns.ncols();
    let end = start + width;
    let across = right.subrows(start, width).transpose();
    let (above, below) = columns.split_at_row_mut(end);
    let (square, rectangle) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    let diagonal = above.subrows_mut(start, width);
    let beside = left.subrows(start, width);
    triangular_matmul(diagonal, square, Accum::Add, beside, rectangle, across, rectangle, -1.0, Par::Seq);
    if below.nrows() > 0 {
        let rows = left.subrows(end, below.nrows());
        matmul(below, Accum::Add, rows, across, -1.0, Par::Seq);
    }
}
