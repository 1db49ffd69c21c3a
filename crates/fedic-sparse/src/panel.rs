//! The columns of one supernode of the factor, and what they do to right-hand sides.

use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::reborrow::{Reborrow, ReborrowMut};
use faer::{Accum, Mat, MatMut, Par};
use pulp::{Arch, Simd, WithSimd};

/// A number as it is stored; all arithmetic is in double precision.
pub(crate) trait Stored: Copy + Default + Send + Sync {
    fn store(value: f64) -> Self;
    fn load(self) -> f64;
}

impl Stored for f64 {
    fn store(value: f64) -> Self {
        value
    }
    fn load(self) -> f64 {
        self
    }
}

impl Stored for f32 {
    fn store(value: f64) -> Self {
        value as f32
    }
    fn load(self) -> f64 {
        f64::from(self)
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
fn column_start(rows: usize, column: usize) -> usize {
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
    fn column(&self, j: usize) -> &[T] {
        let start = column_start(self.rows, j);
        &self.values[start..start + self.rows - j]
    }

    /// Takes the unknowns of the columns and, if asked, those of the rows below, that are zero otherwise.
    pub(crate) fn gather(&self, all: &[f64], sides: usize, block: usize, work: &mut Vec<f64>, with_rows: bool) {
        work.clear();
        for all in all.chunks_exact(all.len() / sides) {
            work.extend_from_slice(&all[self.first..self.first + self.columns]);
            if with_rows {
                self.local_rows.iter().for_each(|&row| work.extend_from_slice(&all[row as usize * block..][..block]));
            } else {
                work.resize(work.len() + self.rows - self.columns, 0.0);
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
            for (&row, given) in self.local_rows.iter().zip(work[self.columns..].chunks_exact(block)) {
                all[row as usize * block..][..block].iter_mut().zip(given).for_each(|(own, given)| *own += given);
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

struct Eliminate<'a, T> {
    panel: &'a Panel<'a, T>,
    work: &'a mut [f64],
}

impl<T: Stored> WithSimd for Eliminate<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for j in 0..self.panel.columns {
            let column = self.panel.column(j);
            let (x, below) = self.work[j..].split_at_mut(1);
            x[0] /= column[0].load();
            let x = x[0];
            below.iter_mut().zip(&column[1..]).for_each(|(w, l)| *w -= l.load() * x);
        }
    }
}

struct Substitute<'a, T> {
    panel: &'a Panel<'a, T>,
    work: &'a mut [f64],
}

impl<T: Stored> WithSimd for Substitute<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for j in (0..self.panel.columns).rev() {
            let column = self.panel.column(j);
            let (x, below) = self.work[j..].split_at_mut(1);
            x[0] = (x[0] - dot(&column[1..], below)) / column[0].load();
        }
    }
}

/// Scalar product, in as many parts as a processor adds side by side.
#[inline(always)]
fn dot<T: Stored>(a: &[T], b: &[f64]) -> f64 {
    let (a, a_rest) = a.as_chunks::<8>();
    let (b, b_rest) = b.as_chunks::<8>();
    let mut lanes = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            lanes[k] += a[k].load() * b[k];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a.load() * b).sum();
    lanes.iter().sum::<f64>() + rest
}
