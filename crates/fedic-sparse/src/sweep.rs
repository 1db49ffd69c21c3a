//! One right-hand side on its way down the columns of a supernode, or up: all the numbers of the factor are read from memory, and
//! little is done with each.

use std::array::from_fn;

use fedic_memory::prefetch;
use pulp::{Simd, WithSimd};

use crate::panel::{Panel, Stored, column_start};

/// Columns taken at once: what is below them is read and written once for all of them.
const TOGETHER: usize = 4;
/// Vectors of rows taken at once.
const VECTORS: usize = 2;

/// Solves for the columns and subtracts what they add to the rows below.
pub(crate) struct Eliminate<'a, T> {
    pub(crate) panel: &'a Panel<'a, T>,
    pub(crate) work: &'a mut [f64],
}

impl<T: Stored> WithSimd for Eliminate<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, work } = self;
        let whole = panel.columns - panel.columns % TOGETHER;
        for j in (0..whole).step_by(TOGETHER) {
            panel.eliminate_columns::<S, TOGETHER>(simd, j, work);
        }
        for j in whole..panel.columns {
            panel.eliminate_columns::<S, 1>(simd, j, work);
        }
    }
}

/// Solves for the columns, the rows below known.
pub(crate) struct Substitute<'a, T> {
    pub(crate) panel: &'a Panel<'a, T>,
    pub(crate) work: &'a mut [f64],
}

impl<T: Stored> WithSimd for Substitute<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, work } = self;
        let whole = panel.columns - panel.columns % TOGETHER;
        for j in (whole..panel.columns).rev() {
            panel.substitute_columns::<S, 1>(simd, j, work);
        }
        for j in (0..whole).step_by(TOGETHER).rev() {
            panel.substitute_columns::<S, TOGETHER>(simd, j, work);
        }
    }
}

impl<T: Stored> Panel<'_, T> {
    /// Solves for `N` columns from column `j` on, and subtracts what they add to all rows below.
    #[inline(always)]
    fn eliminate_columns<S: Simd, const N: usize>(&self, simd: S, j: usize, work: &mut [f64]) {
        let (own, below) = work[j..self.rows].split_at_mut(N);
        let columns: [&[T]; N] = from_fn(|c| self.column(j + c));
        // Divided before they are waited for.
        let inverses: [f64; N] = from_fn(|c| 1.0 / columns[c][0].load());
        for c in 0..N {
            own[c] *= inverses[c];
            for i in c + 1..N {
                own[i] -= columns[c][i - c].load() * own[c];
            }
        }
        let lower: [&[T]; N] = from_fn(|c| &columns[c][N - c..][..below.len()]);
        // Asked for in advance, perhaps from the panel after: of columns side by side the processor does not foresee the next.
        let next = column_start(self.rows, j + N);
        let factors: [S::f64s; N] = from_fn(|c| simd.splat_f64s(-own[c]));
        let taken = VECTORS * S::F64_LANES;
        let whole = below.len() - below.len() % taken;
        for k in (0..whole).step_by(taken) {
            let sums = S::as_mut_simd_f64s(&mut below[k..k + taken]).0;
            prefetch(self.values, next + N * k, N * taken);
            for c in 0..N {
                let lower = &lower[c][k..k + taken];
                for v in 0..VECTORS {
                    sums[v] = simd.mul_add_e_f64s(factors[c], T::vector::<S>(&lower[v * S::F64_LANES..]), sums[v]);
                }
            }
        }
        for k in whole..below.len() {
            (0..N).for_each(|c| below[k] -= lower[c][k].load() * own[c]);
        }
    }

    /// Solves for `N` columns from column `j` on, all rows below known.
    #[inline(always)]
    fn substitute_columns<S: Simd, const N: usize>(&self, simd: S, j: usize, work: &mut [f64]) {
        let (own, below) = work[j..self.rows].split_at_mut(N);
        let columns: [&[T]; N] = from_fn(|c| self.column(j + c));
        let lower: [&[T]; N] = from_fn(|c| &columns[c][N - c..][..below.len()]);
        let inverses: [f64; N] = from_fn(|c| 1.0 / columns[c][0].load());
        let start = column_start(self.rows, j);
        let mut sums = [[simd.splat_f64s(0.0); VECTORS]; N];
        let taken = VECTORS * S::F64_LANES;
        let whole = below.len() - below.len() % taken;
        for k in (0..whole).step_by(taken) {
            let below = S::as_simd_f64s(&below[k..k + taken]).0;
            prefetch(self.values, start.wrapping_sub(N * (k + taken)), N * taken);
            for c in 0..N {
                let lower = &lower[c][k..k + taken];
                for v in 0..VECTORS {
                    sums[c][v] = simd.mul_add_e_f64s(T::vector::<S>(&lower[v * S::F64_LANES..]), below[v], sums[c][v]);
                }
            }
        }
        for c in (0..N).rev() {
            let mut sum = sums[c].iter().map(|&sum| simd.reduce_sum_f64s(sum)).sum::<f64>();
            for k in whole..below.len() {
                sum += lower[c][k].load() * below[k];
            }
            for i in c + 1..N {
                sum += columns[c][i - c].load() * own[i];
            }
            own[c] = (own[c] - sum) * inverses[c];
        }
    }
}

#[cfg(test)]
mod tests {
    use pulp::Arch;

    use super::*;
    use crate::panel::num_stored;

    /// Numbers without order.
    fn numbers(count: usize) -> impl Iterator<Item = f64> {
        (1..=count).map(|k| (0.618 * k as f64).fract() - 0.5)
    }

    /// Both sweeps against plain loops over the dense matrix.
    fn check<T: Stored>(tolerance: f64) {
        for rows in (1..30).chain([100, 133]) {
            for columns in (1..=rows).filter(|columns| columns % 3 == rows % 3 || *columns == rows) {
                let mut values: Vec<T> = numbers(num_stored([rows, columns])).map(T::store).collect();
                (0..columns).for_each(|j| values[column_start(rows, j)] = T::store(2.0 + 0.01 * j as f64));
                let panel = Panel { values: &values, rows, columns, first: 0, local_rows: &[] };
                let start: Vec<f64> = numbers(2 * rows).skip(rows).collect();
                let (mut down, mut up) = (start.clone(), start.clone());
                Arch::new().dispatch(Eliminate { panel: &panel, work: &mut down });
                Arch::new().dispatch(Substitute { panel: &panel, work: &mut up });
                let (mut plain_down, mut plain_up) = (start.clone(), start);
                for j in 0..columns {
                    let column: Vec<f64> = panel.column(j).iter().map(|value| value.load()).collect();
                    plain_down[j] /= column[0];
                    (j + 1..rows).for_each(|i| plain_down[i] -= column[i - j] * plain_down[j]);
                }
                for j in (0..columns).rev() {
                    let column: Vec<f64> = panel.column(j).iter().map(|value| value.load()).collect();
                    let below: f64 = (j + 1..rows).map(|i| column[i - j] * plain_up[i]).sum();
                    plain_up[j] = (plain_up[j] - below) / column[0];
                }
                for (found, expected) in down.iter().zip(&plain_down).chain(up.iter().zip(&plain_up)) {
                    let difference = (found - expected).abs();
                    assert!(difference <= tolerance * (1.0 + expected.abs()), "{rows} x {columns}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn both_sweeps_equal_plain_loops() {
        check::<f64>(1e-12);
        check::<f32>(1e-12);
    }
}
