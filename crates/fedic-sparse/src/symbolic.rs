//! Where the factor has entries: supernodes, columns of nodes that share the rows below them, and the tree of their elimination.

use std::ops::Range;

use crate::Pattern;
use crate::elimination_tree::{NONE, column_counts, elimination_tree, inverse, merged, postorder, supernodes};
use crate::graph::Graph;
use crate::panel::num_stored;

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
