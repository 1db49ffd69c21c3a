//! Vectorized forward and backward substitution with one right-hand side and the packed columns of a supernode.
//!
//! Every value of the factor is read from memory once and used in one operation, so memory bandwidth is the limit:
//! several columns are processed per pass over the right-hand side, and the next values are prefetched.

use std::array::from_fn;

use fedic_memory::prefetch;
use pulp::{Arch, Simd, WithSimd};

use crate::numeric::{PackedColumns, StoredFloat};

/// Columns per pass over the rows below them.
const COLUMNS_PER_PASS: usize = 4;
/// SIMD vectors of rows per step.
const VECTORS: usize = 2;

/// Solves for the columns and subtracts their products from the rows below; `x` holds all rows.
pub(super) fn forward_substitution<T: StoredFloat>(packed: PackedColumns<'_, T>, x: &mut [f64]) {
    Arch::new().dispatch(Forward { packed, x });
}

/// Solves for the columns, given the rows below; `x` holds all rows.
pub(super) fn backward_substitution<T: StoredFloat>(packed: PackedColumns<'_, T>, x: &mut [f64]) {
    Arch::new().dispatch(Backward { packed, x });
}

struct Forward<'a, T> {
    packed: PackedColumns<'a, T>,
    x: &'a mut [f64],
}

impl<T: StoredFloat> WithSimd for Forward<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { packed, x } = self;
        let whole = packed.shape.columns - packed.shape.columns % COLUMNS_PER_PASS;
        for j in (0..whole).step_by(COLUMNS_PER_PASS) {
            forward_columns::<T, S, COLUMNS_PER_PASS>(simd, &packed, j, x);
        }
        for j in whole..packed.shape.columns {
            forward_columns::<T, S, 1>(simd, &packed, j, x);
        }
    }
}

struct Backward<'a, T> {
    packed: PackedColumns<'a, T>,
    x: &'a mut [f64],
}

impl<T: StoredFloat> WithSimd for Backward<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { packed, x } = self;
        let whole = packed.shape.columns - packed.shape.columns % COLUMNS_PER_PASS;
        for j in (whole..packed.shape.columns).rev() {
            backward_columns::<T, S, 1>(simd, &packed, j, x);
        }
        for j in (0..whole).step_by(COLUMNS_PER_PASS).rev() {
            backward_columns::<T, S, COLUMNS_PER_PASS>(simd, &packed, j, x);
        }
    }
}

/// Solves for `N` columns from column `j` on and subtracts their products from all rows below.
#[inline(always)]
fn forward_columns<T: StoredFloat, S: Simd, const N: usize>(
    simd: S,
    packed: &PackedColumns<'_, T>,
    j: usize,
    x: &mut [f64],
) {
    let (own, below) = x[j..packed.shape.rows].split_at_mut(N);
    let columns: [&[T]; N] = from_fn(|c| packed.column(j + c));
    // The reciprocals do not depend on the unknowns, so the divisions overlap.
    let inverses: [f64; N] = from_fn(|c| 1.0 / columns[c][0].load());
    for c in 0..N {
        own[c] *= inverses[c];
        for i in c + 1..N {
            own[i] -= columns[c][i - c].load() * own[c];
        }
    }
    let lower: [&[T]; N] = from_fn(|c| &columns[c][N - c..][..below.len()]);
    // Hardware prefetchers do not follow several short columns; the next columns may belong to the next supernode.
    let next = packed.shape.packed_start(j + N);
    let factors: [S::f64s; N] = from_fn(|c| simd.splat_f64s(-own[c]));
    let step = VECTORS * S::F64_LANES;
    let whole = below.len() - below.len() % step;
    for k in (0..whole).step_by(step) {
        let sums = S::as_mut_simd_f64s(&mut below[k..k + step]).0;
        prefetch(packed.values, next + N * k, N * step);
        for c in 0..N {
            let lower = &lower[c][k..k + step];
            for v in 0..VECTORS {
                sums[v] = simd.mul_add_e_f64s(factors[c], T::load_vector::<S>(&lower[v * S::F64_LANES..]), sums[v]);
            }
        }
    }
    for k in whole..below.len() {
        (0..N).for_each(|c| below[k] -= lower[c][k].load() * own[c]);
    }
}

/// Solves for `N` columns from column `j` on, given all rows below.
#[inline(always)]
fn backward_columns<T: StoredFloat, S: Simd, const N: usize>(
    simd: S,
    packed: &PackedColumns<'_, T>,
    j: usize,
    x: &mut [f64],
) {
    let (own, below) = x[j..packed.shape.rows].split_at_mut(N);
    let columns: [&[T]; N] = from_fn(|c| packed.column(j + c));
    let lower: [&[T]; N] = from_fn(|c| &columns[c][N - c..][..below.len()]);
    let inverses: [f64; N] = from_fn(|c| 1.0 / columns[c][0].load());
    let start = packed.shape.packed_start(j);
    let mut sums = [[simd.splat_f64s(0.0); VECTORS]; N];
    let step = VECTORS * S::F64_LANES;
    let whole = below.len() - below.len() % step;
    for k in (0..whole).step_by(step) {
        let below = S::as_simd_f64s(&below[k..k + step]).0;
        prefetch(packed.values, start.wrapping_sub(N * (k + step)), N * step);
        for c in 0..N {
            let lower = &lower[c][k..k + step];
            for v in 0..VECTORS {
                let values = T::load_vector::<S>(&lower[v * S::F64_LANES..]);
                sums[c][v] = simd.mul_add_e_f64s(values, below[v], sums[c][v]);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::symbolic::Shape;

    /// A deterministic sequence without regularity, between -0.5 and 0.5.
    fn sequence(count: usize) -> impl Iterator<Item = f64> {
        (1..=count).map(|k| (0.618 * k as f64).fract() - 0.5)
    }

    fn check_against_plain_loops<T: StoredFloat>(tolerance: f64) {
        for rows in (1..30).chain([100, 133]) {
            for columns in (1..=rows).filter(|columns| columns % 3 == rows % 3 || *columns == rows) {
                let shape = Shape { rows, columns };
                let mut values: Vec<T> = sequence(shape.packed_len()).map(T::store).collect();
                (0..columns).for_each(|j| values[shape.packed_start(j)] = T::store(2.0 + 0.01 * j as f64));
                let packed = PackedColumns { values: &values, shape };
                let start: Vec<f64> = sequence(2 * rows).skip(rows).collect();
                let (mut forward, mut backward) = (start.clone(), start.clone());
                forward_substitution(packed, &mut forward);
                backward_substitution(packed, &mut backward);
                let (mut expected_forward, mut expected_backward) = (start.clone(), start);
                for j in 0..columns {
                    let column: Vec<f64> = packed.column(j).iter().map(|value| value.load()).collect();
                    expected_forward[j] /= column[0];
                    (j + 1..rows).for_each(|i| expected_forward[i] -= column[i - j] * expected_forward[j]);
                }
                for j in (0..columns).rev() {
                    let column: Vec<f64> = packed.column(j).iter().map(|value| value.load()).collect();
                    let below: f64 = (j + 1..rows).map(|i| column[i - j] * expected_backward[i]).sum();
                    expected_backward[j] = (expected_backward[j] - below) / column[0];
                }
                let pairs = forward.iter().zip(&expected_forward).chain(backward.iter().zip(&expected_backward));
                for (found, expected) in pairs {
                    let difference = (found - expected).abs();
                    assert!(difference <= tolerance * (1.0 + expected.abs()), "{rows} x {columns}: {found} {expected}");
                }
            }
        }
    }

    #[test]
    fn vectorized_substitutions_equal_plain_loops() {
        check_against_plain_loops::<f64>(1e-12);
        check_against_plain_loops::<f32>(1e-12);
    }
}
