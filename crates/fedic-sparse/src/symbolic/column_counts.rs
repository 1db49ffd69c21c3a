//! Column counts of the factor.

use crate::ordering::Graph;

use super::elimination_tree::{NONE, inverse};

/// Number of entries of each column of the factor, the diagonal included (Gilbert, Ng and Peyton 1994).
///
/// `parent` is the elimination tree of the nodes in this `order`, `post` its postorder.
pub(super) fn column_counts(graph: &Graph, order: &[u32], parent: &[u32], post: &[u32]) -> Vec<u32> {
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
            // The column must be a leaf of the row's subtree.
            let seen = largest_first[row as usize];
            if row <= column || (seen != NONE && first[column as usize] <= seen) {
                continue;
            }
            largest_first[row as usize] = first[column as usize];
            delta[column as usize] += 1;
            let previous = std::mem::replace(&mut previous_leaf[row as usize], column);
            if previous != NONE {
                let root = compressed_root(&mut ancestor, previous);
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

/// Root of a node in a disjoint-set forest; compresses the path to it.
fn compressed_root(ancestor: &mut [u32], node: u32) -> u32 {
    let mut root = node;
    while root != ancestor[root as usize] {
        root = ancestor[root as usize];
    }
    let mut at = node;
    while at != root {
        at = std::mem::replace(&mut ancestor[at as usize], root);
    }
    root
}
