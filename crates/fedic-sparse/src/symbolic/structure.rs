//! Supernodal structure of the factor: columns, rows, elimination tree, and places of the matrix entries.

use std::ops::Range;

use crate::Pattern;
use crate::ordering::Graph;

use super::column_counts::column_counts;
use super::elimination_tree::{NONE, elimination_tree, inverse, postorder};
use super::entries::Entry;
use super::shape::Shape;
use super::supernodes::{amalgamate, fundamental_supernodes};

/// Order of the nodes and supernodes of the factor. Nodes are numbered in the order of their elimination.
#[derive(Debug)]
pub(crate) struct Structure {
    /// Degrees of freedom per node.
    pub(crate) block: usize,
    /// Index in the pattern of each node.
    pub(crate) order: Vec<u32>,
    /// First node of each supernode, and the number of nodes at the end.
    columns: Vec<u32>,
    row_starts: Vec<usize>,
    rows: Vec<u32>,
    /// Parent of each supernode, the one that holds its first row below, or [`NONE`].
    pub(crate) parent: Vec<u32>,
    entry_starts: Vec<u32>,
    entries: Vec<Entry>,
}

impl Structure {
    /// Analyses a pattern whose nodes are eliminated in this order or an equivalent one.
    pub(crate) fn new(pattern: &Pattern, graph: &Graph, order: &[u32]) -> Self {
        let block = pattern.block();
        let first_parent = elimination_tree(graph, order);
        let post = postorder(&first_parent, None);
        let counts = column_counts(graph, order, &first_parent, &post);
        // The largest child comes last, next to its parent, so that the two can be merged.
        let post = postorder(&first_parent, Some(&counts));
        let inverse = inverse(&post);
        let order: Vec<u32> = post.iter().map(|&node| order[node as usize]).collect();
        let counts: Vec<u32> = post.iter().map(|&node| counts[node as usize]).collect();
        let parent = |node: u32| first_parent[node as usize];
        let tree: Vec<u32> =
            post.iter().map(|&node| if parent(node) == NONE { NONE } else { inverse[parent(node) as usize] }).collect();
        let columns = amalgamate(&fundamental_supernodes(&tree, &counts), &tree, &counts, block);
        let mut structure = Self {
            block,
            order,
            row_starts: Vec::with_capacity(columns.len()),
            rows: Vec::new(),
            parent: Vec::with_capacity(columns.len()),
            columns,
            entry_starts: Vec::new(),
            entries: Vec::with_capacity(pattern.num_blocks()),
        };
        structure.find_rows(graph);
        structure.find_entries(pattern, graph);
        structure
    }

    /// Number of supernodes.
    pub(crate) fn num_supernodes(&self) -> usize {
        self.columns.len() - 1
    }

    /// Number of degrees of freedom.
    pub(crate) fn num_dofs(&self) -> usize {
        self.order.len() * self.block
    }

    /// Degrees of freedom of a node.
    pub(crate) fn dofs(&self, node: u32) -> Range<usize> {
        let first = self.order[node as usize] as usize * self.block;
        first..first + self.block
    }

    /// Columns of a supernode, in nodes.
    pub(crate) fn columns(&self, supernode: usize) -> Range<u32> {
        self.columns[supernode]..self.columns[supernode + 1]
    }

    /// Rows below the columns of a supernode, in nodes, increasing.
    pub(crate) fn rows(&self, supernode: usize) -> &[u32] {
        &self.rows[self.row_starts[supernode]..self.row_starts[supernode + 1]]
    }

    /// Size of a supernode in degrees of freedom.
    pub(crate) fn shape(&self, supernode: usize) -> Shape {
        let columns = self.columns(supernode).len();
        let rows = columns + self.rows(supernode).len();
        Shape { rows: rows * self.block, columns: columns * self.block }
    }

    /// Values stored for a range of supernodes.
    pub(crate) fn packed_len(&self, supernodes: &Range<usize>) -> usize {
        supernodes.clone().map(|supernode| self.shape(supernode).packed_len()).sum()
    }

    /// Children of each supernode, increasing.
    pub(crate) fn children(&self) -> Vec<Vec<usize>> {
        let mut children = vec![Vec::new(); self.num_supernodes()];
        for (supernode, &parent) in self.parent.iter().enumerate().filter(|&(_, &parent)| parent != NONE) {
            children[parent as usize].push(supernode);
        }
        children
    }

    /// Number of entries of the lower triangle of the matrix.
    pub(crate) fn num_entries(&self) -> usize {
        let (d, nodes) = (self.block, self.order.len());
        self.entries.len() * d * d - nodes * (d * (d - 1) / 2)
    }

    /// Calls `treat(position, source)` for every entry of the matrix in the columns of a supernode: its position in the dense columns,
    /// of all rows, and that among the values of the matrix.
    #[inline]
    pub(crate) fn for_each_entry(&self, supernode: usize, mut treat: impl FnMut(usize, usize)) {
        let rows = self.shape(supernode).rows;
        for (local, node) in self.columns(supernode).enumerate() {
            for entry in self.entries(node) {
                entry.for_each(local, self.block, |i, j, source| treat(j * rows + i, source));
            }
        }
    }

    /// Diagonal of a matrix, in the order of the degrees of freedom.
    pub(crate) fn diagonal(&self, values: &[f64]) -> Vec<f64> {
        let mut diagonal = vec![0.0; self.num_dofs()];
        for supernode in 0..self.num_supernodes() {
            for (local, node) in (0..).zip(self.columns(supernode)) {
                for entry in self.entries(node).iter().filter(|entry| entry.row == local) {
                    self.dofs(node).enumerate().for_each(|(j, dof)| diagonal[dof] = values[entry.source(j, j)]);
                }
            }
        }
        diagonal
    }

    /// Blocks of the matrix in the column of a node.
    fn entries(&self, node: u32) -> &[Entry] {
        &self.entries[self.entry_starts[node as usize] as usize..self.entry_starts[node as usize + 1] as usize]
    }

    /// Finds the rows below each supernode, those of its children and of its own nodes' neighbours, and its parent.
    fn find_rows(&mut self, graph: &Graph) {
        let inverse = inverse(&self.order);
        let count = self.num_supernodes();
        let mut supernode_of = vec![0_u32; self.order.len()];
        for supernode in 0..count {
            self.columns(supernode).for_each(|node| supernode_of[node as usize] = supernode as u32);
        }
        let mut last_child = vec![NONE; count];
        let mut sibling = vec![NONE; count];
        let mut seen = vec![NONE; self.order.len()];
        self.row_starts.push(0);
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
        }
        self.rows.shrink_to_fit();
    }

    /// Finds the blocks of the matrix in each column: on and below the diagonal in the order of elimination.
    fn find_entries(&mut self, pattern: &Pattern, graph: &Graph) {
        let inverse = inverse(&self.order);
        let mut local = vec![0_u32; self.order.len()];
        self.entry_starts.push(0);
        for supernode in 0..self.num_supernodes() {
            let columns = self.columns(supernode);
            let rows = self.rows(supernode).iter().copied();
            columns.clone().chain(rows).zip(0..).for_each(|(row, at)| local[row as usize] = at);
            for node in columns {
                let own = self.order[node as usize];
                let neighbours = graph.neighbours(own).iter().copied().chain([own]);
                for other in neighbours.filter(|&other| inverse[other as usize] >= node) {
                    let row = local[inverse[other as usize] as usize];
                    self.entries.push(Entry::new(pattern, row, [own, other]));
                }
                self.entry_starts.push(self.entries.len() as u32);
            }
        }
    }
}
