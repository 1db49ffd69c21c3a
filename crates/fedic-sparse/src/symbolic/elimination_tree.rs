//! Elimination tree of the nodes and its postorder.

use crate::ordering::Graph;

/// Marks an absent parent: a root.
pub(crate) const NONE: u32 = u32::MAX;

/// Inverse of a permutation.
pub(super) fn inverse(permutation: &[u32]) -> Vec<u32> {
    let mut inverse = vec![0; permutation.len()];
    permutation.iter().zip(0..).for_each(|(&index, at)| inverse[index as usize] = at);
    inverse
}

/// Parent of each column: the first row below the diagonal in that column of the factor (Liu 1986).
pub(super) fn elimination_tree(graph: &Graph, order: &[u32]) -> Vec<u32> {
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

/// Nodes of a forest in postorder. Siblings are in increasing order of `size`, or of their index without it.
pub(super) fn postorder(parent: &[u32], size: Option<&[u32]>) -> Vec<u32> {
    let mut nodes: Vec<u32> = (0..parent.len() as u32).collect();
    if let Some(size) = size {
        nodes.sort_by_key(|&node| size[node as usize]);
    }
    // Linked lists of children; the roots are the children of node `parent.len()`.
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
