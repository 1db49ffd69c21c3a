//! What one thread works with.

use fedic_memory::AlignedBuffer;
use fedic_mesh::CellType;

use crate::COMPONENTS;
use crate::projection::cell_projection::CellsInTurn;
use crate::projection::pointwise::Batch;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::quadrature::shape_table::{PADDING, PART, PointTable, Rows};

/// Memory of one thread, used again for every cell.
pub(crate) struct Work {
    pub(crate) cells: CellsInTurn,
    pub(crate) batch: Box<Batch>,
    pub(crate) own_table: OwnTable,
    /// Pixel coordinates of the points of a part, from the origin of the cell's expansion.
    pub(crate) pixel: [AlignedBuffer<f32>; 2],
    /// Of all points of a cell: grey levels, gradients, gradients pulled back, weights.
    pub(crate) grey: AlignedBuffer<f32>,
    pub(crate) gradient: [AlignedBuffer<f32>; 2],
    pub(crate) q: [AlignedBuffer<f32>; COMPONENTS],
    pub(crate) weights: AlignedBuffer<f32>,
    /// Of the points of a part: residuals times weights.
    pub(crate) weighted: AlignedBuffer<f32>,
}

/// The table of a cell that shares none, part by part.
pub(crate) struct OwnTable {
    coordinates: [Vec<f64>; 2],
    table: PointTable,
}

impl Work {
    pub(crate) fn new() -> Self {
        Self {
            cells: CellsInTurn::default(),
            batch: Batch::new(),
            own_table: OwnTable { coordinates: [vec![0.0; PART], vec![0.0; PART]], table: PointTable::default() },
            pixel: [AlignedBuffer::zeros(PART), AlignedBuffer::zeros(PART)],
            grey: AlignedBuffer::default(),
            gradient: Default::default(),
            q: Default::default(),
            weights: AlignedBuffer::default(),
            weighted: AlignedBuffer::zeros(PART),
        }
    }

    /// Makes room for the `count` points of a cell, and clears what lies between its last point and the end of the rows.
    pub(crate) fn resize(&mut self, count: usize) {
        let padded = count.next_multiple_of(PADDING);
        for row in [&mut self.grey, &mut self.weights].into_iter().chain(&mut self.gradient).chain(&mut self.q) {
            row.resize_for_overwrite(padded);
            row[count..].fill(0.0);
        }
    }
}

impl OwnTable {
    /// The rows of the points of a cell from `first` on: those it shares, or else its own.
    pub(crate) fn rows<'a>(
        &'a mut self,
        quadrature: &'a CellQuadrature,
        cell: usize,
        cell_type: CellType,
        first: usize,
    ) -> Rows<'a> {
        if let Some(table) = quadrature.shared_table(cell) {
            return table.part(first);
        }
        let count = PART.min(quadrature.range(cell).len() - first);
        let [xi, eta] = &mut self.coordinates;
        quadrature.coordinates(cell, first, &mut xi[..count], &mut eta[..count]);
        self.table.fill(cell_type, &xi[..count], &eta[..count]);
        self.table.part(0)
    }
}
