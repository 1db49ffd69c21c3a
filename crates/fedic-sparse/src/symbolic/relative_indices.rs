//! Relative indices: positions of the rows of one supernode among those of an ancestor.

use std::ops::Range;

/// A maximal range of consecutive rows that are also consecutive in the ancestor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct RelativeRange {
    /// First row in the descendant.
    pub(crate) source: usize,
    /// First row in the ancestor.
    pub(crate) target: usize,
    pub(crate) len: usize,
}

impl RelativeRange {
    /// Converts rows of nodes to rows of degrees of freedom.
    pub(crate) fn expanded(self, block: usize) -> Self {
        Self { source: self.source * block, target: self.target * block, len: self.len * block }
    }
}

/// Finds the positions of `own` rows among the `columns` of an ancestor followed by its `rows` below. All increase.
///
/// # Panics
///
/// If a row is in neither of them.
pub(crate) fn find_relative_ranges(own: &[u32], columns: &Range<u32>, rows: &[u32], ranges: &mut Vec<RelativeRange>) {
    ranges.clear();
    let first = own.iter().find(|&&row| row >= columns.end);
    let mut at = first.map_or(0, |&row| rows.partition_point(|&other| other < row));
    for (source, &row) in own.iter().enumerate() {
        let target = if row < columns.end {
            (row - columns.start) as usize
        } else {
            while rows[at] < row {
                at += 1;
            }
            columns.len() + at
        };
        match ranges.last_mut() {
            Some(range) if range.target + range.len == target => range.len += 1,
            _ => ranges.push(RelativeRange { source, target, len: 1 }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_rows_form_one_range() {
        let mut ranges = Vec::new();
        find_relative_ranges(&[5, 6, 9, 10, 14], &(4..8), &[9, 10, 12, 14], &mut ranges);
        let expected = [(0, 1, 2), (2, 4, 2), (4, 7, 1)];
        assert_eq!(ranges, expected.map(|(source, target, len)| RelativeRange { source, target, len }));
        assert_eq!(ranges[1].expanded(3), RelativeRange { source: 6, target: 12, len: 6 });
    }
}
