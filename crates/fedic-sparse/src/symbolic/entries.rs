//! Where the entries of the matrix are in the columns of the supernodes.

use crate::Pattern;
use crate::ordering::Graph;

use super::elimination_tree::inverse;
use super::structure::Structure;

/// Destination and source of one block of the matrix.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    /// Row of the block among the columns and rows of its supernode, in nodes.
    row: u32,
    /// Position of the block's first value in the matrix.
    source: u32,
    /// Twice the length of the source column, plus one if the block is transposed.
    length_and_transpose: u32,
}

impl Entry {
    /// Position in the matrix of an entry of the block. Diagonal blocks have entries with `row >= column` only.
    fn source(&self, row: usize, column: usize) -> usize {
        let (i, j) = if self.length_and_transpose % 2 == 1 { (column, row) } else { (row, column) };
        let lengths = j * (self.length_and_transpose / 2) as usize - j * j.saturating_sub(1) / 2;
        self.source as usize + lengths + i - j
    }
}

impl Structure {
    /// Number of entries of the lower triangle of the matrix.
    pub(crate) fn num_entries(&self) -> usize {
        let (d, nodes) = (self.block, self.order.len());
        self.entries.len() * d * d - nodes * (d * (d - 1) / 2)
    }

    /// Calls `treat(position, source)` for every entry of the matrix in the columns of a supernode: its position in the dense columns,
    /// of all rows, and that among the values of the matrix.
    #[inline]
    pub(crate) fn for_each_entry(&self, supernode: usize, mut treat: impl FnMut(usize, usize)) {
        let d = self.block;
        let rows = self.shape(supernode).rows;
        for (local, node) in self.columns(supernode).enumerate() {
            for entry in self.entries(node) {
                for j in 0..d {
                    let first = (local * d + j) * rows + entry.row as usize * d;
                    let above = if entry.row as usize == local { j } else { 0 };
                    (above..d).for_each(|i| treat(first + i, entry.source(i, j)));
                }
            }
        }
    }

    /// Diagonal of a matrix, in the order of the degrees of freedom.
    pub(crate) fn diagonal(&self, values: &[f64]) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.num_dofs()];
        for supernode in 0..self.num_supernodes() {
            for (local, node) in (0..).zip(self.columns(supernode)) {
                for entry in self.entries(node).iter().filter(|entry| entry.row == local) {
                    self.dofs(node).enumerate().for_each(|(j, dof)| diagonal[dof] = values[entry.source(j, j)]);
                }
            }
        }
        diagonal
    }

    /// Blocks of the matrix in the column of a node.
    fn entries(&self, node: u32) -> &[Entry] {
        &self.entries[self.entry_starts[node as usize] as usize..self.entry_starts[node as usize + 1] as usize]
    }

    /// Finds the blocks of the matrix in each column: on and below the diagonal in the order of elimination.
    pub(super) fn find_entries(&mut self, pattern: &Pattern, graph: &Graph) {
        let inverse = inverse(&self.order);
        let mut local = vec![0_u32; self.order.len()];
        self.entry_starts.push(0);
        for supernode in 0..self.num_supernodes() {
            let columns = self.columns(supernode);
            let rows = self.rows(supernode).iter().copied();
            columns.clone().chain(rows).zip(0..).for_each(|(row, at)| local[row as usize] = at);
            for node in columns {
                let own = self.order[node as usize];
                let neighbours = graph.neighbours(own).iter().copied().chain([own]);
                for other in neighbours.filter(|&other| inverse[other as usize] >= node) {
                    let (column, row) = (own.min(other), own.max(other));
                    let rows = pattern.node_column(column as usize);
                    let above = rows.partition_point(|&r| r < row) * self.block;
                    self.entries.push(Entry {
                        row: local[inverse[other as usize] as usize],
                        source: (pattern.column_start(column as usize, 0) + above) as u32,
                        length_and_transpose: 2 * (rows.len() * self.block) as u32 + u32::from(own > other),
                    });
                }
                self.entry_starts.push(self.entries.len() as u32);
            }
        }
    }
}
