//! Which entries of the matrix are not zero, and where each cell's entries go.

/// Pattern of the lower triangle of a symmetric finite element matrix, by columns, with the place of every cell's blocks.
#[derive(Debug, Clone)]
pub struct Pattern {
    block: usize,
    /// Neighbours of each node, itself first, then those of higher index, increasing.
    node_starts: Vec<usize>,
    node_rows: Vec<u32>,
    cell_starts: Vec<usize>,
    cell_nodes: Vec<u32>,
    /// For each pair of local nodes `b <= a` of each cell, the place of its block among the rows of its column.
    pair_starts: Vec<usize>,
    pair_places: Vec<u32>,
}

impl Pattern {
    /// Pattern of `num_nodes` blocks of `block` unknowns, coupled where a cell holds both nodes.
    ///
    /// # Panics
    ///
    /// If a cell refers to a node past `num_nodes`.
    pub fn new<'a>(num_nodes: usize, block: usize, cells: impl IntoIterator<Item = &'a [u32]>) -> Self {
        let mut cell_starts = vec![0];
        let mut cell_nodes = Vec::new();
        for nodes in cells {
            cell_nodes.extend_from_slice(nodes);
            cell_starts.push(cell_nodes.len());
        }
        let (node_starts, node_rows) = node_columns(num_nodes, &cell_starts, &cell_nodes);
        let mut pair_starts = vec![0];
        let mut pair_places = Vec::new();
        for range in cell_starts.windows(2) {
            let nodes = &cell_nodes[range[0]..range[1]];
            for (a, &row) in nodes.iter().enumerate() {
                for &column in &nodes[..=a] {
                    let (low, high) = (row.min(column), row.max(column));
                    let rows = &node_rows[node_starts[low as usize]..node_starts[low as usize + 1]];
                    pair_places.push(rows.partition_point(|&r| r < high) as u32);
                }
            }
            pair_starts.push(pair_places.len());
        }
        cell_nodes.shrink_to_fit();
        pair_places.shrink_to_fit();
        Self { block, node_starts, node_rows, cell_starts, cell_nodes, pair_starts, pair_places }
    }

    /// Unknowns per node.
    pub fn block(&self) -> usize {
        self.block
    }

    /// Number of nodes.
    pub fn num_nodes(&self) -> usize {
        self.node_starts.len() - 1
    }

    /// Number of unknowns.
    pub fn num_dofs(&self) -> usize {
        self.num_nodes() * self.block
    }

    /// Number of cells.
    pub fn num_cells(&self) -> usize {
        self.cell_starts.len() - 1
    }

    /// Nodes of a cell.
    pub fn cell(&self, cell: usize) -> &[u32] {
        &self.cell_nodes[self.cell_starts[cell]..self.cell_starts[cell + 1]]
    }

    /// Compressed columns of the lower triangle, unknown by unknown: where each column starts, and the rows of its entries, which
    /// [`SymmetricMatrix::values`](crate::SymmetricMatrix::values) are in the order of. What other libraries take a matrix as.
    pub fn lower_triangle(&self) -> (Vec<usize>, Vec<usize>) {
        let d = self.block;
        let mut starts = Vec::with_capacity(self.num_dofs() + 1);
        let mut rows = Vec::with_capacity(self.num_entries());
        for node in 0..self.num_nodes() {
            for j in 0..d {
                starts.push(rows.len());
                let dofs = self.node_column(node).iter().flat_map(|&row| (0..d).map(move |i| row as usize * d + i));
                rows.extend(dofs.skip(j));
            }
        }
        starts.push(rows.len());
        (starts, rows)
    }

    /// Nodes of higher or equal index coupled to `node`, increasing.
    #[inline]
    pub(crate) fn node_column(&self, node: usize) -> &[u32] {
        &self.node_rows[self.node_starts[node]..self.node_starts[node + 1]]
    }

    /// Number of blocks of the lower triangle.
    pub(crate) fn num_blocks(&self) -> usize {
        self.node_rows.len()
    }

    pub(crate) fn pairs(&self, cell: usize) -> &[u32] {
        &self.pair_places[self.pair_starts[cell]..self.pair_starts[cell + 1]]
    }

    /// First entry of column `(node, component)` in the lower triangle.
    #[inline]
    pub(crate) fn column_start(&self, node: usize, component: usize) -> usize {
        let d = self.block;
        let triangles_before = node * (d * (d - 1) / 2);
        let blocks_before = self.node_starts[node] * d * d;
        let rows = (self.node_starts[node + 1] - self.node_starts[node]) * d;
        blocks_before - triangles_before + component * rows - component * component.saturating_sub(1) / 2
    }

    /// Number of entries of the lower triangle.
    pub fn num_entries(&self) -> usize {
        self.column_start(self.num_nodes() - 1, self.block - 1)
            + self.node_column(self.num_nodes() - 1).len() * self.block
            - (self.block - 1)
    }
}

/// Lower triangle of the node graph by columns, rows increasing.
fn node_columns(num_nodes: usize, cell_starts: &[usize], cell_nodes: &[u32]) -> (Vec<usize>, Vec<u32>) {
    let cells = || cell_starts.windows(2).map(|range| &cell_nodes[range[0]..range[1]]);
    let pairs = |nodes: &[u32], treat: &mut dyn FnMut(u32, u32)| {
        for (a, &row) in nodes.iter().enumerate() {
            nodes[..a].iter().for_each(|&column| treat(row.min(column), row.max(column)));
        }
    };
    // Every pair of every cell first, each column with room for its own; then once each, moved together.
    let mut ends = vec![1; num_nodes];
    cells().for_each(|nodes| pairs(nodes, &mut |column, _| ends[column as usize] += 1));
    let mut total = 0;
    ends.iter_mut().for_each(|end| total += std::mem::replace(end, total));
    let mut rows = vec![0; total];
    let mut add = |column: u32, row: u32| {
        rows[ends[column as usize]] = row;
        ends[column as usize] += 1;
    };
    (0..num_nodes as u32).for_each(|node| add(node, node));
    cells().for_each(|nodes| pairs(nodes, &mut add));
    let mut starts = vec![0];
    let (mut first, mut kept) = (0, 0);
    for end in ends {
        rows[first..end].sort_unstable();
        let begin = kept;
        for at in first..end {
            if kept == begin || rows[kept - 1] != rows[at] {
                rows[kept] = rows[at];
                kept += 1;
            }
        }
        starts.push(kept);
        first = end;
    }
    rows.truncate(kept);
    rows.shrink_to_fit();
    (starts, rows)
}
