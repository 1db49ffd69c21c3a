//! Frontal matrix of one supernode, eliminated with dense kernels.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{MatMut, Par, Spec};

use crate::symbolic::{RelativeRange, Shape, Structure};

use super::tiles::{TILE, TILED_WORK, for_each_tile, subtract_products};

/// A frontal matrix. Both parts are stored by columns, and only entries on and below the diagonal are used.
pub(super) struct Front<'a> {
    /// All rows of the supernode's columns.
    pub(super) columns: &'a mut [f64],
    /// Update matrix: the rows below, square.
    pub(super) update: &'a mut [f64],
    pub(super) shape: Shape,
}

impl Front<'_> {
    /// Copies the entries of the matrix.
    pub(super) fn assemble(&mut self, structure: &Structure, supernode: usize, values: &[f64]) {
        structure.for_each_entry(supernode, |position, source| self.columns[position] = values[source]);
    }

    /// Adds the update matrix of a child, whose rows have these relative indices (extend-add).
    pub(super) fn extend_add(&mut self, child: &[f64], ranges: &[RelativeRange]) {
        let Shape { rows, columns } = self.shape;
        let height: usize = ranges.iter().map(|range| range.len).sum();
        let below = rows - columns;
        for (index, across) in ranges.iter().enumerate() {
            for j in 0..across.len {
                let source = &child[(across.source + j) * height..(across.source + j + 1) * height];
                let column = across.target + j;
                let (target, first) = if column < columns {
                    (&mut self.columns[column * rows..(column + 1) * rows], 0)
                } else {
                    let column = column - columns;
                    (&mut self.update[column * below..(column + 1) * below], columns)
                };
                let own = RelativeRange { source: across.source + j, target: across.target + j, len: across.len - j };
                for range in std::iter::once(&own).chain(&ranges[index + 1..]) {
                    let target = &mut target[range.target - first..range.target - first + range.len];
                    let source = &source[range.source..range.source + range.len];
                    target.iter_mut().zip(source).for_each(|(t, s)| *t += s);
                }
            }
        }
    }

    /// Eliminates the columns. Pivots below `replacement` are replaced by it.
    ///
    /// # Errors
    ///
    /// [`LltError`] without a replacement, if a pivot is not positive.
    pub(super) fn eliminate(&mut self, replacement: Option<f64>) -> Result<(), LltError> {
        let Shape { rows, columns } = self.shape;
        let below = rows - columns;
        let work = columns as f64 * rows as f64 * rows as f64;
        let (tile, tile_below) = if work > TILED_WORK { (TILE, TILE) } else { (columns, rows) };
        let mut panel = MatMut::from_column_major_slice_mut(self.columns, rows, columns);
        for first in (0..columns).step_by(tile) {
            let width = tile.min(columns - first);
            let (eliminated, rest) = panel.rb_mut().split_at_col_mut(first + width);
            let (above, mut lower) = eliminated.subcols_mut(first, width).split_at_row_mut(first + width);
            let mut diagonal = above.subrows_mut(first, width);
            match replacement {
                None => factorize(diagonal.rb_mut())?,
                Some(replacement) => factorize_with_replacement(replacement, diagonal.rb_mut()),
            }
            let diagonal = diagonal.rb();
            for_each_tile(lower.rb_mut().transpose_mut(), tile_below, |_, rows| {
                solve_lower_triangular_in_place(diagonal, rows, Par::Seq);
            });
            let rest = rest.subrows_mut(first + width, rows - first - width);
            for_each_tile(rest, tile, |start, columns| subtract_products(lower.rb(), lower.rb(), start, columns));
        }
        let lower = panel.rb().subrows(columns, below);
        let update = MatMut::from_column_major_slice_mut(self.update, below, below);
        for_each_tile(update, tile_below, |start, columns| subtract_products(lower, lower, start, columns));
        Ok(())
    }
}

/// Dense Cholesky factorization in the lower triangle.
fn factorize(matrix: MatMut<'_, f64>) -> Result<(), LltError> {
    let mut scratch = MemBuffer::new(cholesky_in_place_scratch::<f64>(matrix.ncols(), Par::Seq, Spec::default()));
    let stack = MemStack::new(&mut scratch);
    cholesky_in_place(matrix, LltRegularization::default(), Par::Seq, stack, Spec::default()).map(|_| ())
}

/// Dense Cholesky factorization that replaces small pivots, for singular matrices.
///
/// faer's dynamic regularization leaves the diagonal of the factor unchanged, so the replaced pivots would not show.
fn factorize_with_replacement(replacement: f64, mut matrix: MatMut<'_, f64>) {
    let size = matrix.ncols();
    for j in 0..size {
        let pivot = matrix[(j, j)].max(replacement).sqrt();
        matrix[(j, j)] = pivot;
        (j + 1..size).for_each(|i| matrix[(i, j)] /= pivot);
        for column in j + 1..size {
            let factor = matrix[(column, j)];
            (column..size).for_each(|i| matrix[(i, column)] -= factor * matrix[(i, j)]);
        }
    }
}
