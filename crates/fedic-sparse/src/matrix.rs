//! The values of the matrix, and their assembly from cells.

use crate::Pattern;

/// Lower triangle of a symmetric matrix on a [`Pattern`].
#[derive(Debug, Clone)]
pub struct SymmetricMatrix {
    values: Vec<f64>,
}

impl SymmetricMatrix {
    /// The zero matrix.
    pub fn zeros(pattern: &Pattern) -> Self {
        Self { values: vec![0.0; pattern.num_entries()] }
    }

    /// The matrix with these entries of the lower triangle, by columns.
    pub(crate) fn from_values(values: Vec<f64>) -> Self {
        Self { values }
    }

    /// Entries of the lower triangle, by columns.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Adds the matrix of one cell: dense and symmetric, rows and columns in the order of the cell's unknowns.
    ///
    /// # Panics
    ///
    /// If `dense` is smaller than the square of the cell's unknowns.
    pub fn add_cell(&mut self, pattern: &Pattern, cell: usize, dense: &[f64]) {
        let d = pattern.block();
        let nodes = pattern.cell(cell);
        let width = nodes.len() * d;
        let mut places = pattern.pairs(cell).iter();
        for a in 0..nodes.len() {
            for b in 0..=a {
                let Some(&place) = places.next() else { return };
                let (low, high) = if nodes[a] >= nodes[b] { (b, a) } else { (a, b) };
                for j in 0..d {
                    let column = pattern.column_start(nodes[low] as usize, j);
                    for i in 0..d {
                        let row = place as usize * d + i;
                        if row >= j {
                            self.values[column + row - j] += dense[(high * d + i) * width + low * d + j];
                        }
                    }
                }
            }
        }
    }

    /// Entries of a node on the diagonal.
    ///
    /// # Panics
    ///
    /// If the pattern has no such node.
    pub fn node_diagonal(&self, pattern: &Pattern, node: usize) -> impl Iterator<Item = f64> {
        (0..pattern.block()).map(move |j| self.values[pattern.column_start(node, j)])
    }

    /// The block of two nodes; `None` if the pattern does not couple them.
    ///
    /// # Panics
    ///
    /// If the pattern has no such node, or `D` is not the block size.
    pub fn block<const D: usize>(&self, pattern: &Pattern, row: usize, column: usize) -> Option<[[f64; D]; D]> {
        assert_eq!(D, pattern.block(), "blocks of another size");
        let (low, high) = (row.min(column), row.max(column));
        let place = pattern.node_column(low).binary_search(&(high as u32)).ok()?;
        let mut block = [[0.0; D]; D];
        for j in 0..D {
            let start = pattern.column_start(low, j) + place * D - j;
            // The block of the diagonal is stored as its lower triangle.
            for i in if place == 0 { j..D } else { 0..D } {
                let entry = self.values[start + i];
                if row >= column {
                    block[i][j] = entry;
                }
                if row <= column {
                    block[j][i] = entry;
                }
            }
        }
        Some(block)
    }

    /// Adds a number to the entries of a node on the diagonal.
    ///
    /// # Panics
    ///
    /// If the pattern has no such node.
    pub fn add_to_node_diagonal(&mut self, pattern: &Pattern, node: usize, number: f64) {
        (0..pattern.block()).for_each(|j| self.values[pattern.column_start(node, j)] += number);
    }

    /// Adds `factor` times another matrix of the same pattern.
    ///
    /// # Panics
    ///
    /// If the patterns differ in size.
    pub fn add_scaled(&mut self, factor: f64, other: &Self) {
        assert_eq!(self.values.len(), other.values.len(), "matrices of different patterns");
        for (value, &other) in self.values.iter_mut().zip(&other.values) {
            *value += factor * other;
        }
    }

    /// Adds `factor` times `T^T A T` for another matrix `A` of the same pattern and a block-diagonal `T`, of one block for each node.
    ///
    /// # Panics
    ///
    /// If the patterns differ in size, `D` is not the block size, or there are fewer blocks than nodes.
    pub fn add_congruent<const D: usize>(
        &mut self,
        pattern: &Pattern,
        factor: f64,
        other: &Self,
        blocks: &[[[f64; D]; D]],
    ) {
        assert_eq!(self.values.len(), other.values.len(), "matrices of different patterns");
        assert_eq!(D, pattern.block(), "blocks of another size");
        for node in 0..pattern.num_nodes() {
            for (place, &row) in pattern.node_column(node).iter().enumerate() {
                // Entry (i, j) of the block; that of the diagonal is stored as its lower triangle.
                let entry = |i: usize, j: usize| {
                    let (i, j) = if place == 0 && i < j { (j, i) } else { (i, j) };
                    pattern.column_start(node, j) + place * D + i - j
                };
                let (left, right) = (&blocks[row as usize], &blocks[node]);
                for q in 0..D {
                    for p in if place == 0 { q..D } else { 0..D } {
                        let terms = (0..D).flat_map(|i| (0..D).map(move |j| (i, j)));
                        let sum: f64 = terms.map(|(i, j)| left[i][p] * other.values[entry(i, j)] * right[j][q]).sum();
                        self.values[entry(p, q)] += factor * sum;
                    }
                }
            }
        }
    }

    /// Product `y = A x`.
    ///
    /// # Panics
    ///
    /// If `x` is shorter than the number of unknowns.
    pub fn multiply(&self, pattern: &Pattern, x: &[f64]) -> Vec<f64> {
        let d = pattern.block();
        let mut y = vec![0.0; pattern.num_dofs()];
        for node in 0..pattern.num_nodes() {
            let rows = pattern.node_column(node);
            for j in 0..d {
                let column = node * d + j;
                let start = pattern.column_start(node, j);
                for k in j..rows.len() * d {
                    let row = rows[k / d] as usize * d + k % d;
                    let value = self.values[start + k - j];
                    y[row] += value * x[column];
                    if row != column {
                        y[column] += value * x[row];
                    }
                }
            }
        }
        y
    }

    /// Quadratic form `x^T A x`.
    ///
    /// # Panics
    ///
    /// If `x` is shorter than the number of unknowns.
    pub fn quadratic_form(&self, pattern: &Pattern, x: &[f64]) -> f64 {
        let d = pattern.block();
        let mut sum = 0.0;
        for node in 0..pattern.num_nodes() {
            let rows = pattern.node_column(node);
            for j in 0..d {
                let start = pattern.column_start(node, j);
                let mut below = 0.0;
                for (block, &row) in rows.iter().enumerate() {
                    for i in if block == 0 { j + 1..d } else { 0..d } {
                        below += self.values[start + block * d + i - j] * x[row as usize * d + i];
                    }
                }
                let x = x[node * d + j];
                sum += x * (self.values[start] * x + 2.0 * below);
            }
        }
        sum
    }
}
