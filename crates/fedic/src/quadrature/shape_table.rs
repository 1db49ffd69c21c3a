//! What the points of a cell know of its reference domain: their shape functions and monomials, in single precision.

use fedic_memory::AlignedBuffer;
use fedic_mesh::{CellType, MAX_NODES, Subdivision, shape_values_batch};

use crate::projection::polynomial_basis::{MONOMIALS, monomials};

/// Rows are padded to a multiple of this many points, so that no vector is cut short.
pub(crate) const PADDING: usize = 16;
/// Most points treated at once: their rows stay in the cache next to the processor.
pub(crate) const PART: usize = 512;
/// Most points of a cell whose table is shared.
const MAX_SHARED: usize = 4096;
/// Cells that must share a table for it to be worth its memory.
const MIN_SHARING: usize = 8;

/// Rows of one number per point: shape functions, then the constant and the other monomials. Past the last point they vanish.
#[derive(Debug, Clone, Default)]
pub(crate) struct PointTable {
    num_nodes: usize,
    padded: usize,
    rows: AlignedBuffer<f32>,
}

/// Some points of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rows<'a> {
    table: &'a PointTable,
    first: usize,
    padded: usize,
}

impl PointTable {
    /// Fills the table for points of a cell of this type.
    pub(crate) fn fill(&mut self, cell_type: CellType, xi: &[f64], eta: &[f64]) {
        let (len, num_nodes) = (xi.len(), cell_type.num_nodes());
        let padded = len.next_multiple_of(PADDING);
        (self.num_nodes, self.padded) = (num_nodes, padded);
        self.rows.resize_for_overwrite((num_nodes + MONOMIALS + 1) * padded);
        self.rows.fill(0.0);
        let mut shape = [0.0; MAX_NODES * PADDING];
        for start in (0..len).step_by(PADDING) {
            let block = start..len.min(start + PADDING);
            let n = block.len();
            shape_values_batch(cell_type, &xi[block.clone()], &eta[block.clone()], &mut shape);
            for a in 0..num_nodes {
                for k in 0..n {
                    self.rows[a * padded + start + k] = shape[a * n + k] as f32;
                }
            }
            for k in block {
                self.rows[num_nodes * padded + k] = 1.0;
                for (m, value) in monomials([xi[k], eta[k]]).into_iter().enumerate() {
                    self.rows[(num_nodes + 1 + m) * padded + k] = value as f32;
                }
            }
        }
    }

    fn of(cell_type: CellType, subdivision: Subdivision) -> Self {
        let (xi, eta): (Vec<f64>, Vec<f64>) = subdivision.all_points().into_iter().map(|[x, y]| (x, y)).unzip();
        let mut table = Self::default();
        table.fill(cell_type, &xi, &eta);
        table
    }

    /// The rows of up to [`PART`] points from `first`, a multiple of [`PADDING`], on.
    pub(crate) fn part(&self, first: usize) -> Rows<'_> {
        Rows { table: self, first, padded: PART.min(self.padded - first) }
    }
}

impl<'a> Rows<'a> {
    /// Number of nodes of the cell.
    pub(crate) fn num_nodes(self) -> usize {
        self.table.num_nodes
    }

    /// Number of entries of a row.
    pub(crate) fn padded(self) -> usize {
        self.padded
    }

    /// Shape function of one node.
    pub(crate) fn shape(self, node: usize) -> &'a [f32] {
        self.row(node)
    }

    /// A monomial of the reference coordinates; the first is the constant.
    pub(crate) fn monomial(self, m: usize) -> &'a [f32] {
        self.row(self.table.num_nodes + m)
    }

    /// One at every point.
    pub(crate) fn ones(self) -> &'a [f32] {
        self.monomial(0)
    }

    fn row(self, row: usize) -> &'a [f32] {
        let start = row * self.table.padded + self.first;
        &self.table.rows[start..start + self.padded]
    }
}

/// The tables that cells of one type and subdivision share.
#[derive(Debug, Clone)]
pub(crate) struct SharedTables {
    tables: Vec<PointTable>,
    /// Table of each cell, where it shares one.
    of_cell: Vec<Option<u32>>,
}

impl SharedTables {
    /// Tables of the subdivisions that enough cells share.
    pub(crate) fn new(cells: &[(CellType, Subdivision)]) -> Self {
        let mut order: Vec<usize> = (0..cells.len()).collect();
        order.sort_unstable_by_key(|&cell| (cells[cell], cell));
        let mut shared = Self { tables: Vec::new(), of_cell: vec![None; cells.len()] };
        for group in order.chunk_by(|&a, &b| cells[a] == cells[b]) {
            let (cell_type, subdivision) = cells[group[0]];
            if group.len() >= MIN_SHARING && subdivision.num_points() <= MAX_SHARED {
                let table = Some(shared.tables.len() as u32);
                shared.tables.push(PointTable::of(cell_type, subdivision));
                group.iter().for_each(|&cell| shared.of_cell[cell] = table);
            }
        }
        shared
    }

    /// No table.
    pub(crate) fn none(num_cells: usize) -> Self {
        Self { tables: Vec::new(), of_cell: vec![None; num_cells] }
    }

    /// The table of a cell, where it shares one.
    pub(crate) fn of(&self, cell: usize) -> Option<&PointTable> {
        self.of_cell[cell].map(|table| &self.tables[table as usize])
    }
}
