//! Hessian of one cell: `M = sum w (N^T q)(N^T q)^T` (paper, eq. 16).

use crate::COMPONENTS;
use crate::batch::{BATCH, Batch, Lane};

/// Entries of a symmetric `COMPONENTS x COMPONENTS` matrix.
const PRODUCTS: usize = COMPONENTS * (COMPONENTS + 1) / 2;

/// Dense Hessian of a cell, built up batch by batch; unknowns run over components first, then over nodes.
pub(crate) struct CellHessian {
    size: usize,
    entries: Vec<f64>,
}

impl CellHessian {
    pub(crate) fn new(num_nodes: usize) -> Self {
        let size = num_nodes * COMPONENTS;
        Self { size, entries: vec![0.0; size * size] }
    }

    /// Adds the points of a batch: `weight * q` and `q`, by component.
    pub(crate) fn add(&mut self, batch: &Batch, weighted: &[Lane; COMPONENTS], q: &[Lane; COMPONENTS]) {
        let mut products = [[0.0; BATCH]; PRODUCTS];
        let mut pair = 0;
        for i in 0..COMPONENTS {
            for j in 0..=i {
                for k in 0..batch.len() {
                    products[pair][k] = weighted[i][k] * q[j][k];
                }
                pair += 1;
            }
        }
        let mut shapes = [0.0; BATCH];
        for a in 0..batch.num_nodes() {
            let shape_a = batch.shape(a);
            for b in 0..=a {
                let shape_b = batch.shape(b);
                let shapes = &mut shapes[..shape_a.len()];
                for k in 0..shapes.len() {
                    shapes[k] = shape_a[k] * shape_b[k];
                }
                self.add_block(a, b, &batch.sums(shapes, &products));
            }
        }
    }

    fn add_block(&mut self, a: usize, b: usize, sums: &[f64; PRODUCTS]) {
        let mut pair = 0;
        for i in 0..COMPONENTS {
            for j in 0..=i {
                let mut add = |row: usize, column: usize| self.entries[row * self.size + column] += sums[pair];
                let (ai, aj, bi, bj) = (a * COMPONENTS + i, a * COMPONENTS + j, b * COMPONENTS + i, b * COMPONENTS + j);
                add(ai, bj);
                if i != j {
                    add(aj, bi);
                }
                if a != b {
                    add(bj, ai);
                    if i != j {
                        add(bi, aj);
                    }
                }
                pair += 1;
            }
        }
    }

    /// Rows of the dense matrix, one after the other.
    pub(crate) fn entries(&self) -> &[f64] {
        &self.entries
    }

    /// Sum of the diagonal.
    pub(crate) fn trace(&self) -> f64 {
        self.entries.iter().step_by(self.size + 1).sum()
    }
}
