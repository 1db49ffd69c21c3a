//! Hessian of one cell: `M = sum w (N^T q)(N^T q)^T` (paper, eq. 16).

use crate::COMPONENTS;
use crate::kernels::simd::{PRODUCTS, hessian_sums};
use crate::quadrature::shape_table::Rows;

/// Hessian of a cell, built up part by part; its unknowns run over components first, then over nodes.
pub(crate) struct CellHessian {
    num_nodes: usize,
    /// Sums for the pairs of nodes `b <= a`, row after row: `w N_a N_b` times the products of components `j <= i` of `q`.
    sums: Vec<[f64; PRODUCTS]>,
}

impl CellHessian {
    pub(crate) fn new(num_nodes: usize) -> Self {
        Self { num_nodes, sums: vec![[0.0; PRODUCTS]; num_nodes * (num_nodes + 1) / 2] }
    }

    /// Adds the points of some rows, as long as which are all others.
    pub(crate) fn add(&mut self, rows: Rows<'_>, q: [&[f32]; COMPONENTS], weights: &[f32]) {
        hessian_sums(rows, q, weights, &mut self.sums);
    }

    /// Multiplies by a weight that the points have in common.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.sums.iter_mut().flatten().for_each(|sum| *sum *= factor);
    }

    /// Rows of the dense matrix, one after the other.
    pub(crate) fn entries(&self) -> Vec<f64> {
        let size = self.num_nodes * COMPONENTS;
        let mut entries = vec![0.0; size * size];
        let mut pairs = self.sums.iter();
        for a in 0..self.num_nodes {
            for (b, sums) in (0..=a).zip(&mut pairs) {
                let mut product = 0;
                for i in 0..COMPONENTS {
                    for j in 0..=i {
                        for (i, j) in [(i, j), (j, i)] {
                            let (row, column) = (a * COMPONENTS + i, b * COMPONENTS + j);
                            entries[row * size + column] = sums[product];
                            entries[column * size + row] = sums[product];
                        }
                        product += 1;
                    }
                }
            }
        }
        entries
    }

    /// Sum of the diagonal.
    pub(crate) fn trace(&self) -> f64 {
        (0..self.num_nodes).map(|a| self.sums[a * (a + 1) / 2 + a]).map(|[xx, _, yy]| xx + yy).sum()
    }
}
