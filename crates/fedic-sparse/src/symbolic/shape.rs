//! Size of a supernode and layout of its packed columns.

/// Numbers of rows (columns included) and columns of a supernode, in degrees of freedom.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Shape {
    pub(crate) rows: usize,
    pub(crate) columns: usize,
}

impl Shape {
    /// Rows below the columns.
    pub(crate) fn rows_below(self) -> usize {
        self.rows - self.columns
    }

    /// Values stored when the columns are packed, each from the diagonal down.
    pub(crate) fn packed_len(self) -> usize {
        self.packed_start(self.columns)
    }

    /// Position of the diagonal entry of a column among the packed values.
    pub(crate) fn packed_start(self, column: usize) -> usize {
        column * self.rows - column * column.saturating_sub(1) / 2
    }

    /// Approximate number of multiply-add operations of the elimination.
    pub(crate) fn work(self) -> f64 {
        let [rows, columns] = [self.rows, self.columns].map(|n| n as f64);
        columns * (rows * (rows - columns) + columns * columns / 3.0)
    }
}
