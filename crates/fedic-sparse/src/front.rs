//! The elimination of one supernode: its columns and what remains for those above, as dense matrices.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{BlockStructure, matmul as triangular_matmul};
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par, Spec};
use rayon::prelude::*;

use crate::runs::Run;
use crate::symbolic::Symbolic;

/// Columns eliminated at once in a large front, and columns or rows of a task there.
const TILE: usize = 128;
/// A front with more multiplications than this is cut into tiles, whatever the number of threads.
const LARGE: f64 = 2e7;

/// A supernode while it is eliminated. Both parts by columns; only what lies on and below the diagonal counts.
pub(crate) struct Front<'a> {
    /// All rows of the supernode's own columns.
    pub(crate) panel: &'a mut [f64],
    /// Rows below, for the columns above.
    pub(crate) update: &'a mut [f64],
    pub(crate) rows: usize,
    pub(crate) columns: usize,
}

impl Front<'_> {
    /// Puts the values of the matrix in their places.
    pub(crate) fn scatter(&mut self, symbolic: &Symbolic, supernode: usize, values: &[f64]) {
        let d = symbolic.block;
        for (local, node) in symbolic.columns(supernode).enumerate() {
            for entry in symbolic.entries(node) {
                for j in 0..d {
                    let first = (local * d + j) * self.rows + entry.place as usize * d;
                    let above = if entry.place as usize == local { j } else { 0 };
                    for i in above..d {
                        self.panel[first + i] = values[entry.source(i, j)];
                    }
                }
            }
        }
    }

    /// Adds what a child left for its rows.
    pub(crate) fn add(&mut self, child: &[f64], runs: &[Run]) {
        let height: usize = runs.iter().map(|run| run.len).sum();
        let below = self.rows - self.columns;
        for (index, across) in runs.iter().enumerate() {
            for j in 0..across.len {
                let source = &child[(across.from + j) * height..(across.from + j + 1) * height];
                let column = across.to + j;
                let (target, first) = if column < self.columns {
                    (&mut self.panel[column * self.rows..(column + 1) * self.rows], 0)
                } else {
                    let column = column - self.columns;
                    (&mut self.update[column * below..(column + 1) * below], self.columns)
                };
                let own = Run { from: across.from + j, to: across.to + j, len: across.len - j };
                for run in std::iter::once(&own).chain(&runs[index + 1..]) {
                    let target = &mut target[run.to - first..run.to - first + run.len];
                    target.iter_mut().zip(&source[run.from..run.from + run.len]).for_each(|(t, s)| *t += s);
                }
            }
        }
    }

    /// Eliminates the columns. Pivots below `floor` are raised to it; without one, a pivot that is not positive is an error.
    pub(crate) fn eliminate(&mut self, floor: Option<f64>) -> Result<(), LltError> {
        let (rows, columns) = (self.rows, self.columns);
        let below = rows - columns;
        let work = columns as f64 * rows as f64 * rows as f64;
        let (tile, tile_below) = if work > LARGE { (TILE, TILE) } else { (columns, rows) };
        let mut panel = MatMut::from_column_major_slice_mut(self.panel, rows, columns);
        for first in (0..columns).step_by(tile) {
            let width = tile.min(columns - first);
            let (eliminated, rest) = panel.rb_mut().split_at_col_mut(first + width);
            let (above, mut lower) = eliminated.subcols_mut(first, width).split_at_row_mut(first + width);
            let mut diagonal = above.subrows_mut(first, width);
            match floor {
                None => factorize(diagonal.rb_mut())?,
                Some(floor) => factorize_above(floor, diagonal.rb_mut()),
            }
            let diagonal = diagonal.rb();
            for_each_tile(lower.rb_mut().transpose_mut(), tile_below, |_, rows| {
                solve_lower_triangular_in_place(diagonal, rows, Par::Seq);
            });
            let rest = rest.subrows_mut(first + width, rows - first - width);
            for_each_tile(rest, tile, |start, columns| subtract_products(lower.rb(), start, columns));
        }
        let lower = panel.rb().subrows(columns, below);
        let update = MatMut::from_column_major_slice_mut(self.update, below, below);
        for_each_tile(update, tile_below, |start, columns| subtract_products(lower, start, columns));
        Ok(())
    }
}

/// Cholesky factor of a dense matrix, in its lower triangle.
fn factorize(matrix: MatMut<'_, f64>) -> Result<(), LltError> {
    let mut scratch = MemBuffer::new(cholesky_in_place_scratch::<f64>(matrix.ncols(), Par::Seq, Spec::default()));
    let stack = MemStack::new(&mut scratch);
    cholesky_in_place(matrix, LltRegularization::default(), Par::Seq, stack, Spec::default()).map(|_| ())
}

/// The same with pivots raised to `floor`. Only singular systems come here: faer's own way to raise them leaves the diagonal as
/// it was.
fn factorize_above(floor: f64, mut matrix: MatMut<'_, f64>) {
    let size = matrix.ncols();
    for j in 0..size {
        let pivot = matrix[(j, j)].max(floor).sqrt();
        matrix[(j, j)] = pivot;
        (j + 1..size).for_each(|i| matrix[(i, j)] /= pivot);
        for column in j + 1..size {
            let factor = matrix[(column, j)];
            (column..size).for_each(|i| matrix[(i, column)] -= factor * matrix[(i, j)]);
        }
    }
}

/// Treats the columns of a matrix, `tile` at a time, in parallel where there are more.
fn for_each_tile(matrix: MatMut<'_, f64>, tile: usize, treat: impl Fn(usize, MatMut<'_, f64>) + Sync) {
    if matrix.ncols() <= tile {
        return treat(0, matrix);
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
    tiles.into_par_iter().for_each(|(start, columns)| treat(start, columns));
}

/// Subtracts from columns of a square, the first of which is `start`, the products of the rows of `lower`, on and below the diagonal.
fn subtract_products(lower: MatRef<'_, f64>, start: usize, columns: MatMut<'_, f64>) {
    let width = columns.ncols();
    let end = start + width;
    let across = lower.subrows(start, width);
    let (above, below) = columns.split_at_row_mut(end);
    let (square, rectangle) = (BlockStructure::TriangularLower, BlockStructure::Rectangular);
    let diagonal = above.subrows_mut(start, width);
    triangular_matmul(diagonal, square, Accum::Add, across, rectangle, across.transpose(), rectangle, -1.0, Par::Seq);
    if below.nrows() > 0 {
        let rows = lower.subrows(end, below.nrows());
        matmul(below, Accum::Add, rows, across.transpose(), -1.0, Par::Seq);
    }
}
