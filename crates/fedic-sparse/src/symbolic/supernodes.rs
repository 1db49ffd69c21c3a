//! Supernodes: ranges of consecutive columns with the same rows below them.

/// Relaxed amalgamation: supernodes of up to `.0` columns are merged if at most the fraction `.1` of their entries is zero.
const AMALGAMATION: [(usize, f64); 4] = [(8, 1.0), (16, 0.8), (48, 0.1), (usize::MAX, 0.05)];

/// First columns of the fundamental supernodes, given the elimination tree in postorder and the column counts.
pub(super) fn fundamental_supernodes(parent: &[u32], counts: &[u32]) -> Vec<u32> {
    let begins = |&column: &u32| {
        let column = column as usize;
        column == 0 || parent[column - 1] != column as u32 || counts[column - 1] != counts[column] + 1
    };
    (0..parent.len() as u32).filter(begins).collect()
}

/// Merges supernodes with their parents while that adds few zeros; returns first columns, and the number of columns last.
pub(super) fn amalgamate(firsts: &[u32], parent: &[u32], counts: &[u32], block: usize) -> Vec<u32> {
    let size = |columns: f64, rows: f64| columns * rows - columns * (columns - 1.0) / 2.0;
    let mut ends = firsts.iter().skip(1).copied().chain([parent.len() as u32]).rev();
    let mut kept = vec![parent.len() as u32];
    // The current merged supernode: end, columns, rows, zeros and first column.
    let (mut group_end, mut columns, mut rows, mut zeros) = (parent.len() as u32, 0.0, 0.0, 0.0);
    let mut begin = parent.len() as u32;
    for &first in firsts.iter().rev() {
        let end = ends.next().unwrap_or(first);
        let own = f64::from(end - first);
        let above = parent[end as usize - 1];
        let (new_columns, new_rows) = (own + columns, own + rows);
        let new_zeros = zeros + own * (new_rows - f64::from(counts[first as usize]));
        let fraction = new_zeros / size(new_columns, new_rows);
        let allowed = AMALGAMATION.iter().find(|(most, _)| (end - first + group_end - begin) as usize * block <= *most);
        if above < group_end && allowed.is_some_and(|&(_, zeros)| fraction <= zeros) {
            (columns, rows, zeros) = (new_columns, new_rows, new_zeros);
        } else {
            if begin < parent.len() as u32 {
                kept.push(begin);
            }
            (group_end, columns, rows, zeros) = (end, own, f64::from(counts[first as usize]), 0.0);
        }
        begin = first;
    }
    if begin < parent.len() as u32 {
        kept.push(begin);
    }
    kept.reverse();
    kept
}
