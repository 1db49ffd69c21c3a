//! Where the factor has entries: supernodes, columns of nodes that share the rows below them, and the tree of their elimination.

use std::ops::Range;

use crate::Pattern;
use crate::graph::Graph;
use crate::panel::num_stored;

/// No node, no supernode.
pub(crate) const NONE: u32 = u32::MAX;

/// Supernodes are merged where that makes few zeros: up to so many columns of unknowns, at most this part of the entries.
const MERGE: [(usize, f64); 4] = [(8, 1.0), (16, 0.8), (48, 0.1), (usize::MAX, 0.05)];

/// Order of the nodes and supernodes of the factor. Nodes are counted in the order of their elimination.
#[derive(Debug)]
pub(crate) struct Symbolic {
    /// Unknowns per node.
    pub(crate) block: usize,
    /// Index in the mesh of each node.
    pub(crate) order: Vec<u32>,
    /// First node of each supernode, and the number of nodes at the end.
    columns: Vec<u32>,
    row_starts: Vec<usize>,
    rows: Vec<u32>,
    /// The supernode that holds the first row below each, or [`NONE`].
    pub(crate) parent: Vec<u32>,
    entry_starts: Vec<u32>,
    entries: Vec<Entry>,
}

/// A block of the matrix in a column of nodes: where it goes and where it comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entry {
    /// Node of the supernode's columns and rows, counted from its first column.
    pub(crate) place: u32,
    /// Its first number among the values of the matrix.
    source: u32,
    /// Length of the column it is taken from, twice, and one more where its transpose is wanted.
    length_and_side: u32,
}

impl Entry {
    /// Where the value of a row and a column of the block is; on the diagonal only of those below.
    pub(crate) fn source(&self, row: usize, column: usize) -> usize {
        let (i, j) = if self.length_and_side % 2 == 1 { (column, row) } else { (row, column) };
        let lengths = j * (self.length_and_side / 2) as usize - j * j.saturating_sub(1) / 2;
        self.source as usize + lengths + i - j
    }
}

impl Symbolic {
    /// The factor of a matrix whose nodes are eliminated in this order, or in one that gives the same.
    pub(crate) fn new(pattern: &Pattern, graph: &Graph, order: &[u32]) -> Self {
        let block = pattern.block();
        let first_parent = elimination_tree(graph, order);
        let post = postorder(&first_parent, None);
        let counts = column_counts(graph, order, &first_parent, &post);
        // The largest child comes last, next to its parent: those two are merged most easily.
        let post = postorder(&first_parent, Some(&counts));
        let inverse = inverse(&post);
        let order: Vec<u32> = post.iter().map(|&node| order[node as usize]).collect();
        let counts: Vec<u32> = post.iter().map(|&node| counts[node as usize]).collect();
        let parent = |node: u32| first_parent[node as usize];
        let tree: Vec<u32> =
            post.iter().map(|&node| if parent(node) == NONE { NONE } else { inverse[parent(node) as usize] }).collect();
        let columns = merged(&supernodes(&tree, &counts), &tree, &counts, block);
        let mut symbolic = Self {
            block,
            order,
            row_starts: Vec::with_capacity(columns.len()),
            rows: Vec::new(),
            parent: Vec::with_capacity(columns.len()),
            columns,
            entry_starts: Vec::new(),
            entries: Vec::with_capacity(pattern.num_blocks()),
        };
        symbolic.find_rows(pattern, graph);
        symbolic.rows.shrink_to_fit();
        symbolic
    }

    pub(crate) fn num_supernodes(&self) -> usize {
        self.parent.len()
    }

    /// Nodes that are the columns of a supernode.
    pub(crate) fn columns(&self, supernode: usize) -> Range<u32> {
        self.columns[supernode]..self.columns[supernode + 1]
    }

    /// Nodes that are its rows below, increasing.
    pub(crate) fn rows(&self, supernode: usize) -> &[u32] {
        &self.rows[self.row_starts[supernode]..self.row_starts[supernode + 1]]
    }

    /// Numbers of unknowns in all rows, columns included, and in the columns.
    pub(crate) fn shape(&self, supernode: usize) -> [usize; 2] {
        let columns = self.columns(supernode).len();
        [columns + self.rows(supernode).len(), columns].map(|nodes| nodes * self.block)
    }

    /// Numbers stored of some supernodes.
    pub(crate) fn num_stored(&self, supernodes: &Range<usize>) -> usize {
        supernodes.clone().map(|supernode| num_stored(self.shape(supernode))).sum()
    }

    /// Multiplications and additions that the elimination of a supernode takes, about.
    pub(crate) fn work(&self, supernode: usize) -> f64 {
        let [rows, columns] = self.shape(supernode).map(|n| n as f64);
        columns * (rows * (rows - columns) + columns * columns / 3.0)
    }

    /// Blocks of the matrix in the column of a node.
    pub(crate) fn entries(&self, node: u32) -> &[Entry] {
        &self.entries[self.entry_starts[node as usize] as usize..self.entry_starts[node as usize + 1] as usize]
    }

    /// Diagonal of a matrix, in the order of the mesh.
    pub(crate) fn diagonal(&self, values: &[f64]) -> Vec<f64> {
        let d = self.block;
        let mut diagonal = vec![0.0; self.order.len() * d];
        for supernode in 0..self.num_supernodes() {
            for (local, node) in (0..).zip(self.columns(supernode)) {
                for entry in self.entries(node).iter().filter(|entry| entry.place == local) {
                    (0..d).for_each(|j| {
                        diagonal[self.order[node as usize] as usize * d + j] = values[entry.source(j, j)]
                    });
                }
            }
        }
        diagonal
    }

    fn find_rows(&mut self, pattern: &Pattern, graph: &Graph) {
        let inverse = inverse(&self.order);
        let count = self.columns.len() - 1;
        let mut supernode_of = vec![0_u32; self.order.len()];
        for supernode in 0..count {
            self.columns(supernode).for_each(|node| supernode_of[node as usize] = supernode as u32);
        }
        let mut last_child = vec![NONE; count];
        let mut sibling = vec![NONE; count];
        let mut seen = vec![NONE; self.order.len()];
        let mut place = vec![0_u32; self.order.len()];
        self.row_starts.push(0);
        self.entry_starts.push(0);
        for supernode in 0..count {
            let columns = self.columns(supernode);
            let first = self.rows.len();
            let mut add = |row: u32, rows: &mut Vec<u32>| {
                if row >= columns.end && seen[row as usize] != supernode as u32 {
                    seen[row as usize] = supernode as u32;
                    rows.push(row);
                }
            };
            let mut child = last_child[supernode];
            while child != NONE {
                let range = self.row_starts[child as usize]..self.row_starts[child as usize + 1];
                range.for_each(|at| add(self.rows[at], &mut self.rows));
                child = sibling[child as usize];
            }
            for node in columns.clone() {
                let neighbours = graph.neighbours(self.order[node as usize]);
                neighbours.iter().for_each(|&other| add(inverse[other as usize], &mut self.rows));
            }
            self.rows[first..].sort_unstable();
            self.row_starts.push(self.rows.len());
            let parent = self.rows.get(first).map_or(NONE, |&row| supernode_of[row as usize]);
            self.parent.push(parent);
            if parent != NONE {
                sibling[supernode] = last_child[parent as usize];
                last_child[parent as usize] = supernode as u32;
            }
            let rows = &self.rows[first..];
            columns.clone().chain(rows.iter().copied()).zip(0..).for_each(|(row, at)| place[row as usize] = at);
            for node in columns {
                let own = self.order[node as usize];
                let neighbours = graph.neighbours(own).iter().copied().chain([own]);
                for other in neighbours.filter(|&other| inverse[other as usize] >= node) {
                    let (column, row) = (own.min(other), own.max(other));
                    let rows = pattern.node_column(column as usize);
                    let above = rows.partition_point(|&r| r < row) * self.block;
                    self.entries.push(Entry {
                        place: place[inverse[other as usize] as usize],
                        source: (pattern.column_start(column as usize, 0) + above) as u32,
                        length_and_side: 2 * (rows.len() * self.block) as u32 + u32::from(own > other),
                    });
                }
                self.entry_starts.push(self.entries.len() as u32);
            }
        }
    }
}

/// Where each index is in a permutation.
pub(crate) fn inverse(permutation: &[u32]) -> Vec<u32> {
    let mut inverse = vec![0; permutation.len()];
    permutation.iter().zip(0..).for_each(|(&index, at)| inverse[index as usize] = at);
    inverse
}

/// The first row below the diagonal in each column of the factor (Liu 1986).
fn elimination_tree(graph: &Graph, order: &[u32]) -> Vec<u32> {
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
fn postorder(parent: &[u32], size: Option<&[u32]>) -> Vec<u32> {
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
fn column_counts(graph: &Graph, order: &[u32], parent: &[u32], post: &[u32]) -> Vec<u32> {
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
fn supernodes(parent: &[u32], counts: &[u32]) -> Vec<u32> {
    let begins = |&column: &u32| {
        let column = column as usize;
        column == 0 || parent[column - 1] != column as u32 || counts[column - 1] != counts[column] + 1
    };
    (0..parent.len() as u32).filter(begins).collect()
}

/// The same, merged where that makes few zeros, and the number of columns at the end.
fn merged(firsts: &[u32], parent: &[u32], counts: &[u32], block: usize) -> Vec<u32> {
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
