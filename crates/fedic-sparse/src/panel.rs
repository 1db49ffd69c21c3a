//! The columns of one supernode of the factor, and what they do to right-hand sides.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, Par};
use fedic_memory::Pod;
use pulp::{Arch, Simd};

use crate::sweep::{Eliminate, Substitute};

/// Unknowns of a node of a displacement in the plane: two at a time they are taken and added in one step.
const PAIR: usize = 2;
/// Numbers in the widest vector.
const MOST_LANES: usize = 8;

/// A number as it is stored; all arithmetic is in double precision.
pub(crate) trait Stored: Pod + Send + Sync {
    fn store(value: f64) -> Self;
    fn load(self) -> f64;
    /// The first numbers, as many as a vector holds.
    fn vector<S: Simd>(numbers: &[Self]) -> S::f64s;
}

impl Stored for f64 {
    fn store(value: f64) -> Self {
        value
    }
    fn load(self) -> f64 {
        self
    }
    #[inline(always)]
    fn vector<S: Simd>(numbers: &[Self]) -> S::f64s {
        S::as_simd_f64s(&numbers[..S::F64_LANES]).0[0]
    }
}

impl Stored for f32 {
    fn store(value: f64) -> Self {
        value as f32
    }
    fn load(self) -> f64 {
        f64::from(self)
    }
    #[inline(always)]
    fn vector<S: Simd>(numbers: &[Self]) -> S::f64s {
        let mut vector = [0.0; MOST_LANES];
        vector.iter_mut().zip(&numbers[..S::F64_LANES]).for_each(|(to, &from)| *to = from.load());
        f64::vector::<S>(&vector)
    }
}

/// The columns of a supernode, one after the other, each from the diagonal down.
pub(crate) struct Panel<'a, T> {
    pub(crate) values: &'a [T],
    pub(crate) rows: usize,
    pub(crate) columns: usize,
    /// First of its columns among the unknowns of the task.
    pub(crate) first: usize,
    /// Nodes of its rows among those of the task.
    pub(crate) local_rows: &'a [u32],
}

/// Numbers stored of a supernode with so many rows, its columns included.
pub(crate) fn num_stored([rows, columns]: [usize; 2]) -> usize {
    columns * rows - columns * columns.saturating_sub(1) / 2
}

/// First number of a column of such a supernode.
pub(crate) fn column_start(rows: usize, column: usize) -> usize {
    column * rows - column * column.saturating_sub(1) / 2
}

/// Stores what is on and below the diagonal of columns with all their rows.
pub(crate) fn store<T: Stored>(columns: &[f64], rows: usize, mut stored: &mut [T]) {
    for (j, column) in columns.chunks_exact(rows).enumerate() {
        let (own, others) = stored.split_at_mut(rows - j);
        own.iter_mut().zip(&column[j..]).for_each(|(stored, &value)| *stored = T::store(value));
        stored = others;
    }
}

impl<T: Stored> Panel<'_, T> {
    #[inline(always)]
    pub(crate) fn column(&self, j: usize) -> &[T] {
        let start = column_start(self.rows, j);
        &self.values[start..start + self.rows - j]
    }

    /// Takes the unknowns of the columns and, if asked, those of the rows below, that are zero otherwise.
    pub(crate) fn gather(&self, all: &[f64], sides: usize, block: usize, work: &mut Vec<f64>, with_rows: bool) {
        work.clear();
        work.resize(self.rows * sides, 0.0);
        for (all, work) in all.chunks_exact(all.len() / sides).zip(work.chunks_exact_mut(self.rows)) {
            let (columns, below) = work.split_at_mut(self.columns);
            columns.copy_from_slice(&all[self.first..self.first + self.columns]);
            if with_rows && block == PAIR {
                let (all, below) = (all.as_chunks::<PAIR>().0, below.as_chunks_mut::<PAIR>().0);
                below.iter_mut().zip(self.local_rows).for_each(|(below, &row)| *below = all[row as usize]);
            } else if with_rows {
                self.for_each_below(block, |row, k| below[k] = all[row]);
            }
        }
    }

    /// Puts the unknowns of the columns back.
    pub(crate) fn put_back(&self, all: &mut [f64], sides: usize, work: &[f64]) {
        let height = all.len() / sides;
        for (all, work) in all.chunks_exact_mut(height).zip(work.chunks_exact(self.rows)) {
            all[self.first..self.first + self.columns].copy_from_slice(&work[..self.columns]);
        }
    }

    /// Adds what is for the rows below.
    pub(crate) fn scatter(&self, all: &mut [f64], sides: usize, block: usize, work: &[f64]) {
        let height = all.len() / sides;
        for (all, work) in all.chunks_exact_mut(height).zip(work.chunks_exact(self.rows)) {
            let below = &work[self.columns..];
            if block == PAIR {
                let (all, below) = (all.as_chunks_mut::<PAIR>().0, below.as_chunks::<PAIR>().0);
                for (below, &row) in below.iter().zip(self.local_rows) {
                    all[row as usize].iter_mut().zip(below).for_each(|(all, below)| *all += below);
                }
            } else {
                self.for_each_below(block, |row, k| all[row] += below[k]);
            }
        }
    }

    /// Calls `each(row, k)` with each row below the columns, among the unknowns of the task, and its place `k` among them.
    #[inline(always)]
    fn for_each_below(&self, block: usize, mut each: impl FnMut(usize, usize)) {
        for c in 0..block {
            for (node, &row) in self.local_rows.iter().enumerate() {
                each(row as usize * block + c, node * block + c);
            }
        }
    }

    /// Solves for the columns and subtracts what they add to the rows below.
    pub(crate) fn eliminate(&self, work: &mut [f64], sides: usize) {
        if sides == 1 {
            return Arch::new().dispatch(Eliminate { panel: self, work });
        }
        let dense = self.dense();
        let (square, lower) = dense.as_ref().split_at_row(self.columns);
        let (mut columns, below) =
            MatMut::from_column_major_slice_mut(work, self.rows, sides).split_at_row_mut(self.columns);
        solve_lower_triangular_in_place(square, columns.rb_mut(), Par::Seq);
        matmul(below, Accum::Add, lower, columns.rb(), -1.0, Par::Seq);
    }

    /// Solves for the columns, the rows below known.
    pub(crate) fn substitute(&self, work: &mut [f64], sides: usize) {
        if sides == 1 {
            return Arch::new().dispatch(Substitute { panel: self, work });
        }
        let dense = self.dense();
        let (square, lower) = dense.as_ref().split_at_row(self.columns);
        let (mut columns, below) =
            MatMut::from_column_major_slice_mut(work, self.rows, sides).split_at_row_mut(self.columns);
        matmul(columns.rb_mut(), Accum::Add, lower.transpose(), below.rb(), -1.0, Par::Seq);
        solve_upper_triangular_in_place(square.transpose(), columns, Par::Seq);
    }

    /// The columns with all their rows, zero above the diagonal.
    fn dense(&self) -> Mat<f64> {
        let mut dense = Mat::zeros(self.rows, self.columns);
        for j in 0..self.columns {
            for (i, value) in (j..).zip(self.column(j)) {
                dense[(i, j)] = value.load();
            }
        }
        dense
    }
}
