//! Rows of one supernode among those of another above it.

use std::ops::Range;

/// Rows that follow each other in both: the first in the one, the first in the other, their number.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Run {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) len: usize,
}

/// Where `own` rows are among `columns`, and `rows` after them.
///
/// # Panics
///
/// If one of them is in neither.
pub(crate) fn find_runs(own: &[u32], columns: &Range<u32>, rows: &[u32], runs: &mut Vec<Run>) {
    runs.clear();
    let first = own.iter().find(|&&row| row >= columns.end);
    let mut at = first.map_or(0, |&row| rows.partition_point(|&other| other < row));
    for (from, &row) in own.iter().enumerate() {
        let to = if row < columns.end {
            (row - columns.start) as usize
        } else {
            while rows[at] < row {
                at += 1;
            }
            columns.len() + at
        };
        match runs.last_mut() {
            Some(run) if run.to + run.len == to => run.len += 1,
            _ => runs.push(Run { from, to, len: 1 }),
        }
    }
}

impl Run {
    /// The same for `block` rows in place of each.
    pub(crate) fn expanded(self, block: usize) -> Self {
        Self { from: self.from * block, to: self.to * block, len: self.len * block }
    }
}
