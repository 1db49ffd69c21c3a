//! Where the entries of the matrix are in the columns of a supernode.

use crate::Pattern;

/// Destination and source of one block of the matrix.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    /// Row of the block among the columns and rows of its supernode, in nodes.
    pub(super) row: u32,
    /// Position of the block's first value in the matrix.
    source: u32,
    /// Twice the length of the source column, plus one if the block is transposed.
    length_and_transpose: u32,
}

impl Entry {
    /// The block in the column of the first of two nodes of the pattern and the row of the second, which is `row` in the supernode.
    pub(super) fn new(pattern: &Pattern, row: u32, [own, other]: [u32; 2]) -> Self {
        let block = pattern.block();
        let (low, high) = (own.min(other), own.max(other));
        let rows = pattern.node_column(low as usize);
        let above = rows.partition_point(|&r| r < high) * block;
        Self {
            row,
            source: (pattern.column_start(low as usize, 0) + above) as u32,
            length_and_transpose: 2 * (rows.len() * block) as u32 + u32::from(own > other),
        }
    }

    /// Calls `treat(row, column, source)` for the entries of the block on and below the diagonal, given its column in nodes: row and
    /// column in the supernode, and position in the matrix.
    #[inline]
    pub(super) fn for_each(&self, column: usize, block: usize, mut treat: impl FnMut(usize, usize, usize)) {
        let row = self.row as usize;
        for j in 0..block {
            let above = if row == column { j } else { 0 };
            (above..block).for_each(|i| treat(row * block + i, column * block + j, self.source(i, j)));
        }
    }

    /// Position in the matrix of an entry of the block. Diagonal blocks have entries with `row >= column` only.
    pub(super) fn source(&self, row: usize, column: usize) -> usize {
        let (i, j) = if self.length_and_transpose % 2 == 1 { (column, row) } else { (row, column) };
        let lengths = j * (self.length_and_transpose / 2) as usize - j * j.saturating_sub(1) / 2;
        self.source as usize + lengths + i - j
    }
}
