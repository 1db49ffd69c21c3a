//! The loops over the points of a cell, with the best instructions that the processor has. All rows have one length, a
//! multiple of the number of lanes.

use fedic_mesh::{CellType, MAX_NODES};
use pulp::{Arch, Simd, WithSimd};

use crate::COMPONENTS;
use crate::projection::cell_polynomial::Expansion;
use crate::projection::polynomial_basis::{Fit, MONOMIALS, Polynomial};
use crate::quadrature::shape_table::Rows;

/// Vectors added in single precision before a sum goes on in double precision.
const FLUSH: usize = 32;

/// Runs a loop.
pub(crate) fn run<O: WithSimd>(operation: O) -> O::Output {
    Arch::new().dispatch(operation)
}

/// Two sums of the same polynomials, each times its factor.
pub(crate) fn combinations(factors: [&[f64]; 2], polynomials: &[Polynomial]) -> [Polynomial; 2] {
    run(Combinations { factors, polynomials })
}

struct Combinations<'a> {
    factors: [&'a [f64]; 2],
    polynomials: &'a [Polynomial],
}

impl WithSimd for Combinations<'_> {
    type Output = [Polynomial; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [Polynomial; 2] {
        let mut sums = [Polynomial::default(); 2];
        let [first, second] = self.factors;
        for ((polynomial, &first), &second) in self.polynomials.iter().zip(first).zip(second) {
            let factors = [simd.splat_f64s(first), simd.splat_f64s(second)];
            for (sum, factor) in sums.iter_mut().zip(factors) {
                for (sum, &share) in S::as_mut_simd_f64s(sum).0.iter_mut().zip(S::as_simd_f64s(polynomial).0) {
                    *sum = simd.mul_add_e_f64s(factor, share, *sum);
                }
            }
        }
        sums
    }
}

/// Evaluates the polynomials of an expansion: pixel coordinates, counted from its origin.
pub(crate) fn positions(rows: Rows<'_>, expansion: &Expansion, u: &mut [f32], v: &mut [f32]) {
    match expansion.terms {
        2 => run(Positions::<2> { rows, expansion, u, v }),
        5 => run(Positions::<5> { rows, expansion, u, v }),
        9 => run(Positions::<9> { rows, expansion, u, v }),
        _ => run(Positions::<MONOMIALS> { rows, expansion, u, v }),
    }
}

struct Positions<'a, const TERMS: usize> {
    rows: Rows<'a>,
    expansion: &'a Expansion,
    u: &'a mut [f32],
    v: &'a mut [f32],
}

impl<const TERMS: usize> WithSimd for Positions<'_, TERMS> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { rows, expansion, u, v } = self;
        let (u, _) = S::as_mut_simd_f32s(u);
        let (v, _) = S::as_mut_simd_f32s(v);
        let mut powers: [&[S::f32s]; TERMS] = [&[]; TERMS];
        for m in 0..TERMS {
            powers[m] = &S::as_simd_f32s(rows.monomial(m + 1)).0[..u.len()];
        }
        let [constant_u, constant_v] = [simd.splat_f32s(expansion.pixel[0][0]), simd.splat_f32s(expansion.pixel[1][0])];
        let (mut factors_u, mut factors_v) = ([constant_u; TERMS], [constant_v; TERMS]);
        for m in 0..TERMS {
            factors_u[m] = simd.splat_f32s(expansion.pixel[0][m + 1]);
            factors_v[m] = simd.splat_f32s(expansion.pixel[1][m + 1]);
        }
        let mut remainders = [[constant_u; 3]; 2];
        for c in 0..2 {
            for m in 0..3 {
                remainders[c][m] = simd.splat_f32s(expansion.remainder[c][m]);
            }
        }
        for k in 0..u.len().min(v.len()) {
            let (xi, eta) = (powers[0][k], powers[1][k]);
            // What single precision leaves of the greatest terms first: it would be lost among them.
            let [mut at_u, mut at_v] = remainders.map(|[constant, along_xi, along_eta]| {
                simd.mul_add_e_f32s(eta, along_eta, simd.mul_add_e_f32s(xi, along_xi, constant))
            });
            for m in (0..TERMS).rev() {
                let power = powers[m][k];
                at_u = simd.mul_add_e_f32s(power, factors_u[m], at_u);
                at_v = simd.mul_add_e_f32s(power, factors_v[m], at_v);
            }
            u[k] = simd.add_f32s(at_u, constant_u);
            v[k] = simd.add_f32s(at_v, constant_v);
        }
    }
}

/// Weighted sums of grey levels, counted from one of them, and of their squares: those of a flat image vanish.
pub(crate) fn moments(grey: &[f32], weights: &[f32], from: f32) -> [f64; 2] {
    run(Moments { grey, weights, from })
}

struct Moments<'a> {
    grey: &'a [f32],
    weights: &'a [f32],
    from: f32,
}

impl WithSimd for Moments<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
        let (grey, weights) = (S::as_simd_f32s(self.grey).0, S::as_simd_f32s(self.weights).0);
        let from = simd.splat_f32s(self.from);
        let mut totals = [0.0; 2];
        for (grey, weights) in grey.chunks(FLUSH).zip(weights.chunks(FLUSH)) {
            let (mut sum, mut squares) = (simd.splat_f32s(0.0), simd.splat_f32s(0.0));
            for (&grey, &weight) in grey.iter().zip(weights) {
                let counted = simd.sub_f32s(grey, from);
                let weighted = simd.mul_f32s(weight, counted);
                sum = simd.add_f32s(weighted, sum);
                squares = simd.mul_add_e_f32s(weighted, counted, squares);
            }
            totals[0] += f64::from(simd.reduce_sum_f32s(sum));
            totals[1] += f64::from(simd.reduce_sum_f32s(squares));
        }
        totals
    }
}

/// What is known at the points of a cell when their grey levels in the deformed image are.
#[derive(Clone, Copy)]
pub(crate) struct Readings<'a> {
    /// Grey levels of the reference image.
    pub(crate) reference: &'a [f32],
    /// Grey levels of the deformed image.
    pub(crate) deformed: &'a [f32],
    pub(crate) weights: &'a [f32],
    /// Gain and offset of the deformed image.
    pub(crate) correction: [f32; 2],
}

/// Fills `weighted` with `w r` and sums `w r^2`.
pub(crate) fn weighted_residuals(readings: Readings<'_>, weighted: &mut [f32]) -> f64 {
    run(WeightedResiduals { readings, weighted })
}

struct WeightedResiduals<'a> {
    readings: Readings<'a>,
    weighted: &'a mut [f32],
}

impl WithSimd for WeightedResiduals<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { readings, weighted } = self;
        let (weighted, _) = S::as_mut_simd_f32s(weighted);
        let [reference, deformed, weights] = [readings.reference, readings.deformed, readings.weights]
            .map(|row| &S::as_simd_f32s(row).0[..weighted.len()]);
        let gain = simd.splat_f32s(-readings.correction[0]);
        let offset = simd.splat_f32s(readings.correction[1]);
        let mut squares = 0.0;
        for start in (0..weighted.len()).step_by(FLUSH) {
            let mut square = simd.splat_f32s(0.0);
            for k in start..weighted.len().min(start + FLUSH) {
                let residual = simd.mul_add_e_f32s(gain, deformed[k], simd.sub_f32s(reference[k], offset));
                weighted[k] = simd.mul_f32s(weights[k], residual);
                square = simd.mul_add_e_f32s(weighted[k], residual, square);
            }
            squares += f64::from(simd.reduce_sum_f32s(square));
        }
        squares
    }
}

/// Adds the sums of `N q` times a factor at each node of a cell to `node_sums`. The shape functions are made of as many
/// monomials, whose rows serve for other things too.
pub(crate) fn add_node_sums(
    cell_type: CellType,
    rows: Rows<'_>,
    q: [&[f32]; COMPONENTS],
    factors: &[f32],
    node_sums: &mut [[f64; COMPONENTS]; MAX_NODES],
) {
    let fit = Fit::of(cell_type);
    let mut monomial_sums = [[0.0; COMPONENTS]; MAX_NODES];
    let sums = &mut monomial_sums[..fit.spanning.len()];
    for (monomials, sums) in fit.spanning.chunks(SUMMED).zip(sums.chunks_mut(SUMMED)) {
        match monomials.len() {
            4 => run(MonomialSums::<4> { rows, monomials, q, factors, sums }),
            3 => run(MonomialSums::<3> { rows, monomials, q, factors, sums }),
            2 => run(MonomialSums::<2> { rows, monomials, q, factors, sums }),
            _ => run(MonomialSums::<1> { rows, monomials, q, factors, sums }),
        }
    }
    for (shape, node) in fit.shape.iter().zip(&mut node_sums[..rows.num_nodes()]) {
        for (&m, sums) in fit.spanning.iter().zip(&monomial_sums) {
            (0..COMPONENTS).for_each(|c| node[c] += shape[m] * sums[c]);
        }
    }
}

/// Monomials whose sums stay in registers.
const SUMMED: usize = 4;

struct MonomialSums<'a, const N: usize> {
    rows: Rows<'a>,
    monomials: &'a [usize],
    q: [&'a [f32]; COMPONENTS],
    factors: &'a [f32],
    sums: &'a mut [[f64; COMPONENTS]],
}

impl<const N: usize> WithSimd for MonomialSums<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { rows, monomials, q, factors, sums } = self;
        let factors = S::as_simd_f32s(factors).0;
        let [x, y] = q.map(|along| &S::as_simd_f32s(along).0[..factors.len()]);
        let mut powers: [&[S::f32s]; N] = [&[]; N];
        for m in 0..N {
            powers[m] = &S::as_simd_f32s(rows.monomial(monomials[m])).0[..factors.len()];
        }
        for start in (0..factors.len()).step_by(FLUSH) {
            let mut vectors = [[simd.splat_f32s(0.0); COMPONENTS]; N];
            for k in start..factors.len().min(start + FLUSH) {
                let (x, y) = (simd.mul_f32s(factors[k], x[k]), simd.mul_f32s(factors[k], y[k]));
                for m in 0..N {
                    let power = powers[m][k];
                    vectors[m][0] = simd.mul_add_e_f32s(power, x, vectors[m][0]);
                    vectors[m][1] = simd.mul_add_e_f32s(power, y, vectors[m][1]);
                }
            }
            for m in 0..N {
                for c in 0..COMPONENTS {
                    sums[m][c] += f64::from(simd.reduce_sum_f32s(vectors[m][c]));
                }
            }
        }
    }
}

/// Gradients of an image at the points of a cell.
pub(crate) trait Slopes: Copy {
    /// Vector `k` of each component.
    fn vectors<S: Simd>(self, k: usize) -> [S::f32s; 2];
}

impl Slopes for [&[f32]; 2] {
    #[inline(always)]
    fn vectors<S: Simd>(self, k: usize) -> [S::f32s; 2] {
        self.map(|along| S::as_simd_f32s(along).0[k])
    }
}

/// Multiplies the gradient of an image by the transpose of the camera's Jacobian: `q = J^T grad f`. Where the gradient is given
/// in steps, the Jacobian is that of one step.
pub(crate) fn pull_back<G: Slopes>(rows: Rows<'_>, jacobian: &[[f32; 3]; 4], gradient: G, q: [&mut [f32]; COMPONENTS]) {
    run(PullBack { rows, jacobian, gradient, q });
}

struct PullBack<'a, G> {
    rows: Rows<'a>,
    jacobian: &'a [[f32; 3]; 4],
    gradient: G,
    q: [&'a mut [f32]; COMPONENTS],
}

impl<G: Slopes> WithSimd for PullBack<'_, G> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [x, y] = self.q.map(|along| S::as_mut_simd_f32s(along).0);
        let [xi, eta] = [1, 2].map(|m| S::as_simd_f32s(self.rows.monomial(m)).0);
        let mut jacobian = [[simd.splat_f32s(0.0); 3]; 4];
        for entry in 0..4 {
            for c in 0..3 {
                jacobian[entry][c] = simd.splat_f32s(self.jacobian[entry][c]);
            }
        }
        for (k, (((&xi, &eta), x), y)) in xi.iter().zip(eta).zip(x).zip(y).enumerate() {
            let at = |[constant, along_xi, along_eta]: [S::f32s; 3]| {
                simd.mul_add_e_f32s(along_eta, eta, simd.mul_add_e_f32s(along_xi, xi, constant))
            };
            let [ux, uy, vx, vy] = jacobian.map(at);
            let [along_u, along_v] = self.gradient.vectors::<S>(k);
            *x = simd.mul_add_e_f32s(ux, along_u, simd.mul_f32s(vx, along_v));
            *y = simd.mul_add_e_f32s(uy, along_u, simd.mul_f32s(vy, along_v));
        }
    }
}

/// The largest magnitude of some numbers.
pub(crate) fn largest(numbers: &[f32]) -> f32 {
    run(Largest(numbers))
}

struct Largest<'a>(&'a [f32]);

impl WithSimd for Largest<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f32 {
        let mut largest = [simd.splat_f32s(0.0); 2];
        for (index, &vector) in S::as_simd_f32s(self.0).0.iter().enumerate() {
            largest[index % 2] = simd.max_f32s(largest[index % 2], simd.abs_f32s(vector));
        }
        simd.reduce_max_f32s(simd.max_f32s(largest[0], largest[1]))
    }
}

/// Sums of `w N_a N_b (q_0^2, q_0 q_1, q_1^2)` for the pairs of nodes `b <= a`, row after row. In double precision
/// throughout: a singular matrix must look singular.
pub(crate) fn hessian_sums(rows: Rows<'_>, q: [&[f32]; 2], weights: &[f32], sums: &mut [[f64; PRODUCTS]]) {
    run(HessianSums { rows, q, weights, sums });
}

/// Products of two components.
pub(crate) const PRODUCTS: usize = COMPONENTS * (COMPONENTS + 1) / 2;
/// Points whose products are formed at once.
const POINTS: usize = 128;

struct HessianSums<'a> {
    rows: Rows<'a>,
    q: [&'a [f32]; 2],
    weights: &'a [f32],
    sums: &'a mut [[f64; PRODUCTS]],
}

impl WithSimd for HessianSums<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let nodes = self.rows.num_nodes();
        let mut shapes = [[0.0_f64; POINTS]; MAX_NODES];
        let mut products = [[0.0_f64; POINTS]; PRODUCTS];
        for start in (0..self.weights.len()).step_by(POINTS) {
            let n = POINTS.min(self.weights.len() - start);
            let (weights, x, y) = (&self.weights[start..], &self.q[0][start..], &self.q[1][start..]);
            for k in 0..n {
                let (w, x, y) = (f64::from(weights[k]), f64::from(x[k]), f64::from(y[k]));
                (products[0][k], products[1][k], products[2][k]) = (w * x * x, w * x * y, w * y * y);
            }
            for a in 0..nodes {
                let shape = &self.rows.shape(a)[start..];
                for k in 0..n {
                    shapes[a][k] = f64::from(shape[k]);
                }
            }
            let products = [&products[0], &products[1], &products[2]].map(|row| vectors::<S>(row, n));
            let mut rows = self.sums.iter_mut();
            for a in 0..nodes {
                let row = vectors::<S>(&shapes[a], n);
                // Several columns at once, so that no sum waits for the one before.
                for columns in shapes[..=a].chunks(COLUMNS) {
                    match columns {
                        [b, c, d, e] => add_products(simd, row, [b, c, d, e], products, &mut rows),
                        [b, c, d] => add_products(simd, row, [b, c, d], products, &mut rows),
                        [b, c] => add_products(simd, row, [b, c], products, &mut rows),
                        rest => rest.iter().for_each(|b| add_products(simd, row, [b], products, &mut rows)),
                    }
                }
            }
        }
    }
}

/// Columns of a Hessian summed at once.
const COLUMNS: usize = 4;

/// Adds to the next sums those of the products times the shape functions of one row and of some columns.
#[inline(always)]
fn add_products<'a, S: Simd, const N: usize>(
    simd: S,
    row: &[S::f64s],
    columns: [&[f64; POINTS]; N],
    products: [&[S::f64s]; PRODUCTS],
    sums: &mut impl Iterator<Item = &'a mut [f64; PRODUCTS]>,
) {
    let count = row.len();
    let mut columns_of = [row; N];
    for b in 0..N {
        columns_of[b] = &vectors::<S>(columns[b], POINTS)[..count];
    }
    let [xx, xy, yy] = [&products[0][..count], &products[1][..count], &products[2][..count]];
    let mut parts = [[simd.splat_f64s(0.0); PRODUCTS]; N];
    for k in 0..count {
        let weighted = [simd.mul_f64s(row[k], xx[k]), simd.mul_f64s(row[k], xy[k]), simd.mul_f64s(row[k], yy[k])];
        for b in 0..N {
            let shape = columns_of[b][k];
            for p in 0..PRODUCTS {
                parts[b][p] = simd.mul_add_e_f64s(shape, weighted[p], parts[b][p]);
            }
        }
    }
    for (parts, sums) in parts.into_iter().zip(sums) {
        for p in 0..PRODUCTS {
            sums[p] += simd.reduce_sum_f64s(parts[p]);
        }
    }
}

/// The first `n` numbers, a multiple of the lanes.
#[inline(always)]
fn vectors<S: Simd>(numbers: &[f64; POINTS], n: usize) -> &[S::f64s] {
    S::as_simd_f64s(&numbers[..n]).0
}

#[cfg(test)]
mod tests {
    use fedic_mesh::{CellType, Subdivision};

    use super::*;
    use crate::quadrature::shape_table::PointTable;

    fn table(cell: CellType) -> (PointTable, usize) {
        let subdivision = Subdivision::uniform(cell, 9);
        let (xi, eta): (Vec<f64>, Vec<f64>) = subdivision.all_points().into_iter().map(|[x, y]| (x, y)).unzip();
        let mut table = PointTable::default();
        table.fill(cell, &xi, &eta);
        (table, xi.len())
    }

    /// Numbers without order at the points, then zeros.
    fn row(seed: usize, len: usize, padded: usize) -> Vec<f32> {
        let number = |k: usize| ((k * 7919 + seed * 104_729) % 1000) as f32 / 250.0 - 2.0;
        (0..padded).map(|k| if k < len { number(k) } else { 0.0 }).collect()
    }

    #[test]
    fn sums_equal_plain_loops_in_double_precision() {
        for cell in CellType::ALL {
            let (table, len) = table(cell);
            let rows = table.part(0);
            let [f, g, along_u, along_v, w] = [1, 2, 3, 4, 5].map(|seed| row(seed, len, rows.padded()));
            let weights: Vec<f32> = w.iter().map(|w| w * w).collect();
            let jacobian = [[1.1, 0.02, -0.01], [0.1, 0.01, 0.0], [-0.2, 0.0, 0.03], [0.9, -0.02, 0.01]];
            let correction = [1.2, -0.3];
            let mut weighted = f.clone();
            let squares = weighted_residuals(
                Readings { reference: &f, deformed: &g, weights: &weights, correction },
                &mut weighted,
            );
            let mut q = [f.clone(), f.clone()];
            let [x, y] = &mut q;
            pull_back(rows, &jacobian, [along_u.as_slice(), along_v.as_slice()], [x, y]);
            let mut sums = [[0.0; COMPONENTS]; MAX_NODES];
            add_node_sums(cell, rows, [&q[0], &q[1]], &weighted, &mut sums);
            let pairs = rows.num_nodes() * (rows.num_nodes() + 1) / 2;
            let mut hessian = vec![[0.0; PRODUCTS]; pairs];
            hessian_sums(rows, [&q[0], &q[1]], &weights, &mut hessian);

            let (mut expected, mut expected_squares) = ([[0.0; COMPONENTS]; MAX_NODES], 0.0);
            let mut expected_hessian = vec![[0.0; PRODUCTS]; pairs];
            for k in 0..len {
                let [f, g, w] = [f[k], g[k], weights[k]].map(f64::from);
                let residual = f - 1.2 * g + 0.3;
                expected_squares += w * residual * residual;
                let [qx, qy] = [0, 1].map(|c| {
                    let entry = |e: usize| {
                        let [constant, xi, eta] = jacobian[e].map(f64::from);
                        constant + xi * f64::from(rows.monomial(1)[k]) + eta * f64::from(rows.monomial(2)[k])
                    };
                    entry(c) * f64::from(along_u[k]) + entry(2 + c) * f64::from(along_v[k])
                });
                let mut pair = 0;
                for a in 0..rows.num_nodes() {
                    let shape = f64::from(rows.shape(a)[k]);
                    expected[a][0] += w * shape * qx * residual;
                    expected[a][1] += w * shape * qy * residual;
                    for b in 0..=a {
                        let both = w * shape * f64::from(rows.shape(b)[k]);
                        let products = [both * qx * qx, both * qx * qy, both * qy * qy];
                        expected_hessian[pair].iter_mut().zip(products).for_each(|(sum, p)| *sum += p);
                        pair += 1;
                    }
                }
            }
            let close = |found: f64, expected: f64| (found - expected).abs() < 1e-5 * (1.0 + expected.abs());
            assert!(close(squares, expected_squares), "{cell}: {squares} {expected_squares}");
            for (found, expected) in sums.as_flattened().iter().zip(expected.as_flattened()) {
                assert!(close(*found, *expected), "{cell}: {found} {expected}");
            }
            for (found, expected) in hessian.as_flattened().iter().zip(expected_hessian.as_flattened()) {
                assert!(close(*found, *expected), "{cell}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_largest_is_found() {
        let numbers = row(7, 100, 112);
        assert_eq!(largest(&numbers), numbers.iter().fold(0.0, |largest, number| number.abs().max(largest)));
    }

    #[test]
    fn moments_are_counted_from_a_level() {
        let (flat, weights) = (vec![80.0_f32; 64], vec![0.7_f32; 64]);
        assert_eq!(moments(&flat, &weights, 80.0), [0.0; 2]);
        let (grey, weights) = (row(8, 600, 608), row(9, 600, 608));
        let mut expected = [0.0; 2];
        for (grey, weight) in grey.iter().zip(&weights) {
            let counted = f64::from(*grey) - 0.5;
            expected[0] += f64::from(*weight) * counted;
            expected[1] += f64::from(*weight) * counted * counted;
        }
        for (found, expected) in moments(&grey, &weights, 0.5).into_iter().zip(expected) {
            assert!((found - expected).abs() < 1e-4, "{found} {expected}");
        }
    }
}
