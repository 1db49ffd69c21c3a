//! Hessian of one cell: `M = sum w (N^T q)(N^T q)^T` (paper, eq. 16).

use fedic_mesh::MAX_NODES;
use pulp::{Simd, WithSimd};

use crate::kernels::dispatch::run;
use crate::quadrature::shape_table::ShapeTableChunk;

/// Products of the components `i` and `j <= i` of a vector; entries above the diagonal are unused.
type Products<const D: usize> = [[f64; D]; D];

/// Hessian of a cell, accumulated chunk by chunk. Its unknowns run over components first, then over nodes.
#[derive(Debug, Clone)]
pub(crate) struct CellMatrix<const D: usize> {
    num_nodes: usize,
    /// Sums for the pairs of nodes `b <= a`, row after row: `w N_a N_b` times the products of the components of `q`.
    sums: Vec<Products<D>>,
}

impl<const D: usize> CellMatrix<D> {
    /// A zero matrix.
    pub(crate) fn zeros(num_nodes: usize) -> Self {
        Self { num_nodes, sums: vec![[[0.0; D]; D]; num_nodes * (num_nodes + 1) / 2] }
    }

    /// Adds the points of a chunk. In double precision throughout, so that a singular matrix is recognised as singular.
    pub(crate) fn add(&mut self, chunk: ShapeTableChunk<'_>, q: [&[f32]; D], weights: &[f32]) {
        run(PairSums { chunk, q, weights, sums: &mut self.sums });
    }

    /// Multiplies the matrix by a factor.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.sums.as_flattened_mut().as_flattened_mut().iter_mut().for_each(|sum| *sum *= factor);
    }

    /// Entries of the dense matrix, row after row.
    pub(crate) fn entries(&self) -> Vec<f64> {
        let size = self.num_nodes * D;
        let mut entries = vec![0.0; size * size];
        let mut pairs = self.sums.iter();
        for a in 0..self.num_nodes {
            for (b, sums) in (0..=a).zip(&mut pairs) {
                for i in 0..D {
                    for j in 0..=i {
                        for (p, q) in [(i, j), (j, i)] {
                            let (row, column) = (a * D + p, b * D + q);
                            entries[row * size + column] = sums[i][j];
                            entries[column * size + row] = sums[i][j];
                        }
                    }
                }
            }
        }
        entries
    }

    /// Block of node `a` on the diagonal.
    pub(crate) fn node_block(&self, a: usize) -> [[f64; D]; D] {
        let sums = &self.sums[a * (a + 1) / 2 + a];
        std::array::from_fn(|i| std::array::from_fn(|j| if i >= j { sums[i][j] } else { sums[j][i] }))
    }

    /// Sum of the diagonal.
    pub(crate) fn trace(&self) -> f64 {
        let diagonal = |sums: Products<D>| (1..D).fold(sums[0][0], |sum, c| sum + sums[c][c]);
        (0..self.num_nodes).map(|a| diagonal(self.sums[a * (a + 1) / 2 + a])).sum()
    }
}

/// Number of points whose products are formed at once.
const BATCH: usize = 128;

struct PairSums<'a, const D: usize> {
    chunk: ShapeTableChunk<'a>,
    q: [&'a [f32]; D],
    weights: &'a [f32],
    sums: &'a mut [Products<D>],
}

impl<const D: usize> WithSimd for PairSums<'_, D> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let nodes = self.chunk.num_nodes();
        let mut shapes = [[0.0_f64; BATCH]; MAX_NODES];
        let mut products = [[[0.0_f64; BATCH]; D]; D];
        for start in (0..self.weights.len()).step_by(BATCH) {
            let n = BATCH.min(self.weights.len() - start);
            let weights = &self.weights[start..];
            let q = self.q.map(|along| &along[start..]);
            for k in 0..n {
                let (w, q) = (f64::from(weights[k]), q.map(|along| f64::from(along[k])));
                for i in 0..D {
                    for j in 0..=i {
                        products[i][j][k] = w * q[j] * q[i];
                    }
                }
            }
            for a in 0..nodes {
                let shape = &self.chunk.shape(a)[start..];
                for k in 0..n {
                    shapes[a][k] = f64::from(shape[k]);
                }
            }
            let products = products.each_ref().map(|row| row.each_ref().map(|product| vectors::<S>(product, n)));
            let mut rows = self.sums.iter_mut();
            for a in 0..nodes {
                let row = vectors::<S>(&shapes[a], n);
                // Several columns at once: their sums are independent, so that none waits for another.
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

/// Number of columns of the matrix summed at once.
const COLUMNS: usize = 4;

/// Adds, for one row and `N` columns, the sums of the products times both shape functions.
#[inline(always)]
fn add_products<'a, S: Simd, const N: usize, const D: usize>(
    simd: S,
    row: &[S::f64s],
    columns: [&[f64; BATCH]; N],
    products: [[&[S::f64s]; D]; D],
    sums: &mut impl Iterator<Item = &'a mut Products<D>>,
) {
    let count = row.len();
    let mut columns_of = [row; N];
    for b in 0..N {
        columns_of[b] = &vectors::<S>(columns[b], BATCH)[..count];
    }
    let mut products_of = products;
    for i in 0..D {
        for j in 0..=i {
            products_of[i][j] = &products[i][j][..count];
        }
    }
    let zero = simd.splat_f64s(0.0);
    let mut totals = [[[zero; D]; D]; N];
    for k in 0..count {
        let mut weighted = [[zero; D]; D];
        for i in 0..D {
            for j in 0..=i {
                weighted[i][j] = simd.mul_f64s(row[k], products_of[i][j][k]);
            }
        }
        for b in 0..N {
            let shape = columns_of[b][k];
            for i in 0..D {
                for j in 0..=i {
                    totals[b][i][j] = simd.mul_add_e_f64s(shape, weighted[i][j], totals[b][i][j]);
                }
            }
        }
    }
    for (totals, sums) in totals.into_iter().zip(sums) {
        for i in 0..D {
            for j in 0..=i {
                sums[i][j] += simd.reduce_sum_f64s(totals[i][j]);
            }
        }
    }
}

/// The first `n` entries, a multiple of the vector length, as vectors.
#[inline(always)]
fn vectors<S: Simd>(values: &[f64; BATCH], n: usize) -> &[S::f64s] {
    S::as_simd_f64s(&values[..n]).0
}
