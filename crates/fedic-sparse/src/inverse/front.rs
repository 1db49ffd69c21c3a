//! Dense entries of the inverse at the rows of one supernode.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};

use crate::numeric::{TILE, TILED_WORK, for_each_tile, subtract_products};
use crate::symbolic::{RelativeRange, Shape};

/// The inverse at the rows of a supernode. Both parts are stored by columns, and only entries on and below the diagonal are used.
pub(super) struct InverseFront<'a> {
    /// All rows of the supernode's columns.
    pub(super) columns: &'a mut [f64],
    /// The rows below, square.
    pub(super) below: &'a mut [f64],
    pub(super) shape: Shape,
}

impl InverseFront<'_> {
    /// Finds the columns, given the rows below and the columns of the factor, which are overwritten.
    pub(super) fn fill_columns(&mut self, factor: MatMut<'_, f64>) {
        let Shape { rows, columns } = self.shape;
        let below = self.shape.rows_below();
        let work = columns as f64 * rows as f64 * rows as f64;
        let (tile, tile_below) = if work > TILED_WORK { (TILE, TILE) } else { (columns, rows) };
        let (square, mut lower) = factor.split_at_row_mut(columns);
        let square = square.rb();
        for_each_tile(lower.rb_mut().transpose_mut(), tile_below, |_, rows| {
            solve_upper_triangular_in_place(square.transpose(), rows, Par::Seq);
        });
        let lower = lower.rb();
        mirror_tiles(self.below, below, tile_below);
        let inverse_below = MatRef::from_column_major_slice(self.below, below, below);
        let (own, mut across) =
            MatMut::from_column_major_slice_mut(self.columns, rows, columns).split_at_row_mut(columns);
        for_each_tile(across.rb_mut().transpose_mut(), tile_below, |start, rows| {
            multiply_symmetric(inverse_below, lower, start, rows.transpose_mut());
        });
        let across = across.rb();
        for_each_tile(own, tile, |start, mut columns| {
            invert(square, start, columns.rb_mut());
            subtract_products(lower.transpose(), across.transpose(), start, columns);
        });
    }

    /// Copies the entries at the rows of a child, which have these relative indices, to a square matrix.
    pub(super) fn extract(&self, ranges: &[RelativeRange], child: &mut [f64]) {
        let Shape { rows, columns } = self.shape;
        let height: usize = ranges.iter().map(|range| range.len).sum();
        let below = rows - columns;
        for (index, across) in ranges.iter().enumerate() {
            for j in 0..across.len {
                let target = &mut child[(across.source + j) * height..(across.source + j + 1) * height];
                let column = across.target + j;
                let (source, first) = if column < columns {
                    (&self.columns[column * rows..(column + 1) * rows], 0)
                } else {
                    let column = column - columns;
                    (&self.below[column * below..(column + 1) * below], columns)
                };
                let own = RelativeRange { source: across.source + j, target: across.target + j, len: across.len - j };
                for range in std::iter::once(&own).chain(&ranges[index + 1..]) {
                    let source = &source[range.target - first..range.target - first + range.len];
                    target[range.source..range.source + range.len].copy_from_slice(source);
                }
            }
        }
    }
}

/// Copies the lower triangle of each tile on the diagonal of a square matrix to the upper.
fn mirror_tiles(matrix: &mut [f64], size: usize, tile: usize) {
    for first in (0..size).step_by(tile) {
        let end = size.min(first + tile);
        for j in first..end {
            (j + 1..end).for_each(|i| matrix[i * size + j] = matrix[j * size + i]);
        }
    }
}

/// Some rows of `-symmetric * factor`, the first of which is `start`. Of the symmetric matrix, the lower triangle is used and all of the
/// tile on the diagonal in these rows.
fn multiply_symmetric(symmetric: MatRef<'_, f64>, factor: MatRef<'_, f64>, start: usize, mut rows: MatMut<'_, f64>) {
    let width = rows.nrows();
    let end = start + width;
    let height = symmetric.nrows() - end;
    let tile = symmetric.submatrix(start, start, width, width);
    matmul(rows.rb_mut(), Accum::Replace, tile, factor.subrows(start, width), -1.0, Par::Seq);
    if start > 0 {
        let left = symmetric.submatrix(start, 0, width, start);
        matmul(rows.rb_mut(), Accum::Add, left, factor.subrows(0, start), -1.0, Par::Seq);
    }
    if height > 0 {
        let under = symmetric.submatrix(end, start, height, width).transpose();
        matmul(rows, Accum::Add, under, factor.subrows(end, height), -1.0, Par::Seq);
    }
}

/// Some columns of `(L L^T)^-1`, the first of which is `start`, on and below the diagonal.
fn invert(lower: MatRef<'_, f64>, start: usize, columns: MatMut<'_, f64>) {
    let height = lower.nrows() - start;
    // Columns of `L^-1` vanish above the diagonal, and the rows of the solution from `start` on depend on those of `L` alone.
    let lower = lower.submatrix(start, start, height, height);
    let mut columns = columns.subrows_mut(start, height);
    columns.fill(0.0);
    (0..columns.ncols()).for_each(|k| columns[(k, k)] = 1.0);
    solve_lower_triangular_in_place(lower, columns.rb_mut(), Par::Seq);
    solve_upper_triangular_in_place(lower.transpose(), columns, Par::Seq);
}
