//! Substitution with the columns of one supernode.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, Par};

use crate::numeric::{PackedColumns, StoredFloat};

use super::triangular_solve::{backward_substitution, forward_substitution};

/// A supernode within its task.
///
/// `local` below holds the unknowns of the task, `buffer` those of the supernode's rows, for each right-hand side.
pub(super) struct Supernode<'a, T> {
    pub(super) packed: PackedColumns<'a, T>,
    /// Degrees of freedom per node.
    pub(super) block: usize,
    /// First of its columns among the unknowns of the task.
    pub(super) first_column: usize,
    /// Positions of its rows below among those of the task, in nodes.
    pub(super) local_rows: &'a [u32],
}

impl<T: StoredFloat> Supernode<'_, T> {
    /// Copies the unknowns of the columns to the buffer; its rows below become zero.
    pub(super) fn gather_columns(&self, local: &[f64], num_sides: usize, buffer: &mut Vec<f64>) {
        let shape = self.packed.shape;
        buffer.clear();
        buffer.resize(shape.rows * num_sides, 0.0);
        for (local, buffer) in local.chunks_exact(local.len() / num_sides).zip(buffer.chunks_exact_mut(shape.rows)) {
            buffer[..shape.columns].copy_from_slice(&local[self.first_column..self.first_column + shape.columns]);
        }
    }

    /// Copies the unknowns of the columns back.
    pub(super) fn scatter_columns(&self, buffer: &[f64], num_sides: usize, local: &mut [f64]) {
        let shape = self.packed.shape;
        let height = local.len() / num_sides;
        for (local, buffer) in local.chunks_exact_mut(height).zip(buffer.chunks_exact(shape.rows)) {
            local[self.first_column..self.first_column + shape.columns].copy_from_slice(&buffer[..shape.columns]);
        }
    }

    /// Copies the unknowns of the rows below to the buffer.
    pub(super) fn gather_rows_below(&self, local: &[f64], num_sides: usize, buffer: &mut [f64]) {
        let shape = self.packed.shape;
        for (local, buffer) in local.chunks_exact(local.len() / num_sides).zip(buffer.chunks_exact_mut(shape.rows)) {
            let below = &mut buffer[shape.columns..];
            match self.block {
                2 => gather::<2>(local, self.local_rows, below),
                3 => gather::<3>(local, self.local_rows, below),
                block => {
                    for (below, &row) in below.chunks_exact_mut(block).zip(self.local_rows) {
                        below.copy_from_slice(&local[row as usize * block..][..block]);
                    }
                }
            }
        }
    }

    /// Adds the buffer to the unknowns of the rows below.
    pub(super) fn add_rows_below(&self, buffer: &[f64], num_sides: usize, local: &mut [f64]) {
        let shape = self.packed.shape;
        let height = local.len() / num_sides;
        for (local, buffer) in local.chunks_exact_mut(height).zip(buffer.chunks_exact(shape.rows)) {
            let below = &buffer[shape.columns..];
            match self.block {
                2 => add::<2>(below, self.local_rows, local),
                3 => add::<3>(below, self.local_rows, local),
                block => {
                    for (below, &row) in below.chunks_exact(block).zip(self.local_rows) {
                        let local = &mut local[row as usize * block..][..block];
                        local.iter_mut().zip(below).for_each(|(local, below)| *local += below);
                    }
                }
            }
        }
    }

    /// Solves for the columns and subtracts their products from the rows below.
    pub(super) fn forward(&self, buffer: &mut [f64], num_sides: usize) {
        if num_sides == 1 {
            return forward_substitution(self.packed, buffer);
        }
        let shape = self.packed.shape;
        let dense = self.packed.to_dense();
        let (square, lower) = dense.as_ref().split_at_row(shape.columns);
        let (mut columns, below) =
            MatMut::from_column_major_slice_mut(buffer, shape.rows, num_sides).split_at_row_mut(shape.columns);
        solve_lower_triangular_in_place(square, columns.rb_mut(), Par::Seq);
        matmul(below, Accum::Add, lower, columns.rb(), -1.0, Par::Seq);
    }

    /// Solves for the columns, given the rows below.
    pub(super) fn backward(&self, buffer: &mut [f64], num_sides: usize) {
        if num_sides == 1 {
            return backward_substitution(self.packed, buffer);
        }
        let shape = self.packed.shape;
        let dense = self.packed.to_dense();
        let (square, lower) = dense.as_ref().split_at_row(shape.columns);
        let (mut columns, below) =
            MatMut::from_column_major_slice_mut(buffer, shape.rows, num_sides).split_at_row_mut(shape.columns);
        matmul(columns.rb_mut(), Accum::Add, lower.transpose(), below.rb(), -1.0, Par::Seq);
        solve_upper_triangular_in_place(square.transpose(), columns, Par::Seq);
    }
}

/// Copies blocks of a size known to the compiler, which copies each in one step.
fn gather<const BLOCK: usize>(local: &[f64], rows: &[u32], below: &mut [f64]) {
    let (local, below) = (local.as_chunks::<BLOCK>().0, below.as_chunks_mut::<BLOCK>().0);
    below.iter_mut().zip(rows).for_each(|(below, &row)| *below = local[row as usize]);
}

/// Adds blocks of a size known to the compiler.
fn add<const BLOCK: usize>(below: &[f64], rows: &[u32], local: &mut [f64]) {
    let (local, below) = (local.as_chunks_mut::<BLOCK>().0, below.as_chunks::<BLOCK>().0);
    for (below, &row) in below.iter().zip(rows) {
        local[row as usize].iter_mut().zip(below).for_each(|(local, below)| *local += below);
    }
}
