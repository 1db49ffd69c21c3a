//! Shape functions and monomials tabulated at the quadrature points of a cell, in single precision.

use fedic_memory::AlignedBuffer;
use fedic_mesh::{CellType, MAX_NODES, Rule, Subdivision, shape_values, shape_values_batch};

use crate::quadrature::monomials::{MONOMIALS, monomials};

/// Rows are padded to a multiple of this many points, a multiple of the widest vector.
pub(crate) const PADDING: usize = 16;
/// Largest number of points processed at once: their rows fit in the first-level cache.
pub(crate) const CHUNK: usize = 512;
/// Largest number of points of a shared table.
const MAX_SHARED: usize = 4096;
/// Number of points per unit of the reference cell in means over it.
const SAMPLES: f64 = 16.0;
/// Smallest number of cells for which a shared table is kept.
const MIN_SHARING: usize = 8;

/// One row per shape function, then one per monomial, the constant first; one entry per point. Entries past the last point are
/// zero.
#[derive(Debug, Clone, Default)]
pub(crate) struct ShapeTable {
    num_nodes: usize,
    padded: usize,
    rows: AlignedBuffer<f32>,
}

/// Up to [`CHUNK`] consecutive points of a table.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ShapeTableChunk<'a> {
    table: &'a ShapeTable,
    first: usize,
    padded: usize,
}

impl ShapeTable {
    /// Fills the table for the points of a cell.
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

    /// Up to [`CHUNK`] points from `first`, a multiple of [`PADDING`], on.
    pub(crate) fn chunk(&self, first: usize) -> ShapeTableChunk<'_> {
        ShapeTableChunk { table: self, first, padded: CHUNK.min(self.padded - first) }
    }
}

impl<'a> ShapeTableChunk<'a> {
    /// Number of nodes of the cell.
    pub(crate) fn num_nodes(self) -> usize {
        self.table.num_nodes
    }

    /// Length of each row.
    pub(crate) fn padded(self) -> usize {
        self.padded
    }

    /// Shape function of one node at the points.
    pub(crate) fn shape(self, node: usize) -> &'a [f32] {
        self.row(node)
    }

    /// Monomial `m` of the reference coordinates at the points; monomial 0 is the constant.
    pub(crate) fn monomial(self, m: usize) -> &'a [f32] {
        self.row(self.table.num_nodes + m)
    }

    /// A row of ones.
    pub(crate) fn ones(self) -> &'a [f32] {
        self.monomial(0)
    }

    fn row(self, row: usize) -> &'a [f32] {
        let start = row * self.table.padded + self.first;
        &self.table.rows[start..start + self.padded]
    }
}

/// Mean over the reference cell of the square of each shape function.
pub(crate) fn mean_squared_shapes(cell_type: CellType) -> Vec<f64> {
    let enlarged: Vec<[f64; 2]> = cell_type.reference_nodes().iter().map(|node| node.map(|c| SAMPLES * c)).collect();
    let points = Subdivision::of_cell(cell_type, &enlarged, Rule::default(), 1.0).all_points();
    let mut means = vec![0.0; cell_type.num_nodes()];
    for &at in &points {
        let values = shape_values(cell_type, at);
        means.iter_mut().zip(values).for_each(|(mean, value)| *mean += value * value / points.len() as f64);
    }
    means
}

/// Tables shared by the cells of one type and subdivision.
#[derive(Debug, Clone)]
pub(crate) struct SharedShapeTables {
    tables: Vec<ShapeTable>,
    /// Index of the table of each cell, if it is shared.
    of_cell: Vec<Option<u32>>,
}

impl SharedShapeTables {
    /// Tabulates every subdivision that enough cells share.
    pub(crate) fn new(cells: &[(CellType, Subdivision)]) -> Self {
        let mut order: Vec<usize> = (0..cells.len()).collect();
        order.sort_unstable_by_key(|&cell| (cells[cell], cell));
        let mut shared = Self { tables: Vec::new(), of_cell: vec![None; cells.len()] };
        for group in order.chunk_by(|&a, &b| cells[a] == cells[b]) {
            let (cell_type, subdivision) = cells[group[0]];
            if group.len() >= MIN_SHARING && subdivision.num_points() <= MAX_SHARED {
                let table = Some(shared.tables.len() as u32);
                shared.tables.push(ShapeTable::of(cell_type, subdivision));
                group.iter().for_each(|&cell| shared.of_cell[cell] = table);
            }
        }
        shared
    }

    /// No shared table.
    pub(crate) fn none(num_cells: usize) -> Self {
        Self { tables: Vec::new(), of_cell: vec![None; num_cells] }
    }

    /// Shared table of a cell, if any.
    pub(crate) fn of(&self, cell: usize) -> Option<&ShapeTable> {
        self.of_cell[cell].map(|table| &self.tables[table as usize])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact moments: 1/9 of a quad, 1/6 of a triangle, and of a quad9 the products of 2/15 (ends) and 8/15 (middle).
    #[test]
    fn mean_squared_shapes_are_the_exact_moments() {
        let (end, middle) = (2.0 / 15.0, 8.0 / 15.0);
        let quad9 =
            [end * end, end * end, end * end, end * end, end * middle, end * middle, end * middle, end * middle];
        let expected = [
            (CellType::Quad, vec![1.0 / 9.0; 4]),
            (CellType::Triangle, vec![1.0 / 6.0; 3]),
            (CellType::Quad9, quad9.into_iter().chain([middle * middle]).collect()),
        ];
        for (cell_type, expected) in expected {
            for (found, expected) in mean_squared_shapes(cell_type).into_iter().zip(expected) {
                assert!((found - expected).abs() < 0.02 * expected, "{cell_type}: {found} {expected}");
            }
        }
    }
}
