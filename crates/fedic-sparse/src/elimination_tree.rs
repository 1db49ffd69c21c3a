//! The elimination tree and what follows from it: counts of the columns and supernodes.

use crate::graph::Graph;

/// No node, no supernode.
pub(crate) const NONE: u32 = u32::MAX;

/// Supernodes are merged where that makes few zeros: up to so many columns of unknowns, at most this part of the entries.
const MERGE: [(usize, f64); 4] = [(8, 1.0), (16, 0.8), (48, 0.1), (usize::MAX, 0.05)];

/// Where each index is in a permutation.
pub(crate) fn inverse(permutation: &[u32]) -> Vec<u32> {
    let mut inverse = vec![0; permutation.len()];
    permutation.iter().zip(0..).for_each(|(&index, at)| inverse[index as usize] = at);
    inverse
}

/// The first row below the diagonal in each column of the factor (Liu 1986).
pub(crate) fn elimination_tree(graph: &Graph, order: &[u32]) -> Vec<u32> {
    let inverse = inverse(order);
    let mut parent = vec![NONE; order.len()];
    let mut ancestor = vec![NONE; order.len()];
    for (column, &node) in (0_u32..).zip(order) {
        for &other in graph.neighbours(node) {
            let mut at = inverse[other as usize];
            while at != NONE && at < column {
                let next = std::mem::replace(&mut ancestor[at as usize], column);
                if next == NONE {
                    parent[at as usize] = column;
                }
                at = next;
            }
        }
    }
    parent
}

/// The nodes of a forest, each after all of its children; these by increasing `size` where it is given.
pub(crate) fn postorder(parent: &[u32], size: Option<&[u32]>) -> Vec<u32> {
    let mut nodes: Vec<u32> = (0..parent.len() as u32).collect();
    if let Some(size) = size {
        nodes.sort_by_key(|&node| size[node as usize]);
    }
    // Lists of children, the first at the head.
    let mut head = vec![NONE; parent.len() + 1];
    let mut next = vec![NONE; parent.len()];
    for &node in nodes.iter().rev() {
        let of = (parent[node as usize] as usize).min(parent.len());
        next[node as usize] = std::mem::replace(&mut head[of], node);
    }
    let mut order = Vec::with_capacity(parent.len());
    let mut stack = Vec::new();
    let mut root = head[parent.len()];
    while root != NONE {
        stack.push(root);
        while let Some(&node) = stack.last() {
            let child = head[node as usize];
            if child == NONE {
                stack.pop();
                order.push(node);
            } else {
                head[node as usize] = next[child as usize];
                stack.push(child);
            }
        }
        root = next[root as usize];
    }
    order
}

/// Entries of each column of the factor, the diagonal included (Gilbert, Ng and Peyton 1994).
pub(crate) fn column_counts(graph: &Graph, order: &[u32], parent: &[u32], post: &[u32]) -> Vec<u32> {
    let inverse = inverse(order);
    let n = order.len();
    let mut first = vec![NONE; n];
    let mut delta = vec![0_i32; n];
    for (k, &node) in (0_u32..).zip(post) {
        delta[node as usize] = i32::from(first[node as usize] == NONE);
        let mut at = node;
        while at != NONE && first[at as usize] == NONE {
            first[at as usize] = k;
            at = parent[at as usize];
        }
    }
    let mut largest_first = vec![NONE; n];
    let mut previous_leaf = vec![NONE; n];
    let mut ancestor: Vec<u32> = (0..n as u32).collect();
    for &column in post {
        if parent[column as usize] != NONE {
            delta[parent[column as usize] as usize] -= 1;
        }
        for &other in graph.neighbours(order[column as usize]) {
            let row = inverse[other as usize];
            // Whether the column is a leaf in the subtree of the row.
            let seen = largest_first[row as usize];
            if row <= column || (seen != NONE && first[column as usize] <= seen) {
                continue;
            }
            largest_first[row as usize] = first[column as usize];
            delta[column as usize] += 1;
            let previous = std::mem::replace(&mut previous_leaf[row as usize], column);
            if previous != NONE {
                let mut root = previous;
                while root != ancestor[root as usize] {
                    root = ancestor[root as usize];
                }
                let mut at = previous;
                while at != root {
                    at = std::mem::replace(&mut ancestor[at as usize], root);
                }
                delta[root as usize] -= 1;
            }
        }
        if parent[column as usize] != NONE {
            ancestor[column as usize] = parent[column as usize];
        }
    }
    for &column in post {
        if parent[column as usize] != NONE {
            delta[parent[column as usize] as usize] += delta[column as usize];
        }
    }
    delta.into_iter().map(|count| count as u32).collect()
}

/// First columns of the runs of columns that share their rows.
pub(crate) fn supernodes(parent: &[u32], counts: &[u32]) -> Vec<u32> {
    let begins = |&column: &u32| {
        let column = column as usize;
        column == 0 || parent[column - 1] != column as u32 || counts[column - 1] != counts[column] + 1
    };
    (0..parent.len() as u32).filter(begins).collect()
}

/// The same, merged where that makes few zeros, and the number of columns at the end.
pub(crate) fn merged(firsts: &[u32], parent: &[u32], counts: &[u32], block: usize) -> Vec<u32> {
    let size = |columns: f64, rows: f64| columns * rows - columns * (columns - 1.0) / 2.0;
    let mut ends = firsts.iter().skip(1).copied().chain([parent.len() as u32]).rev();
    let mut kept = vec![parent.len() as u32];
    // The merged supernode that begins last: its columns, rows and zeros.
    let (mut group_end, mut columns, mut rows, mut zeros) = (parent.len() as u32, 0.0, 0.0, 0.0);
    let mut begin = parent.len() as u32;
    for &first in firsts.iter().rev() {
        let end = ends.next().unwrap_or(first);
        let own = f64::from(end - first);
        let above = parent[end as usize - 1];
        let (new_columns, new_rows) = (own + columns, own + rows);
        let new_zeros = zeros + own * (new_rows - f64::from(counts[first as usize]));
        let part = new_zeros / size(new_columns, new_rows);
        let allowed = MERGE.iter().find(|(most, _)| (end - first + group_end - begin) as usize * block <= *most);
        if above < group_end && allowed.is_some_and(|&(_, zeros)| part <= zeros) {
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
