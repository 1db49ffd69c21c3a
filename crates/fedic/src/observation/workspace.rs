//! Per-thread scratch buffers of a pass over the cells.

use fedic_memory::AlignedBuffer;
use fedic_mesh::CellType;

use crate::projection::cell_projection::CellProjectionCache;
use crate::projection::pointwise::PointwiseProjector;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::quadrature::shape_table::{CHUNK, PADDING, ShapeTable, ShapeTableChunk};

/// Scratch buffers of one thread, reused for every cell.
pub(crate) struct Workspace<const D: usize> {
    pub(crate) projections: CellProjectionCache<D>,
    pub(crate) projector: Projector,
    pub(crate) points: PointBuffers<D>,
    /// Weighted residuals of the points of a chunk.
    pub(crate) weighted: AlignedBuffer<f32>,
}

/// Buffers of the projection of a cell's points.
pub(crate) struct Projector {
    pub(crate) pointwise: Box<PointwiseProjector>,
    pub(crate) shapes: UnsharedShapeTable,
    /// Image coordinates of the points of a chunk, relative to the origin of the cell's polynomial.
    pub(crate) pixel: [AlignedBuffer<f32>; 2],
}

/// Quantities at all points of a cell.
pub(crate) struct PointBuffers<const D: usize> {
    /// Grey levels.
    pub(crate) grey: AlignedBuffer<f32>,
    /// Image gradients.
    pub(crate) gradient: [AlignedBuffer<f32>; 2],
    /// Sensitivities.
    pub(crate) q: [AlignedBuffer<f32>; D],
    /// Weights.
    pub(crate) weights: AlignedBuffer<f32>,
    /// Grey levels of the deformed image before the correction by the light, in units of the contrast.
    pub(crate) scaled: AlignedBuffer<f32>,
    /// Residuals.
    pub(crate) residual: AlignedBuffer<f32>,
}

/// Shape table of a cell that shares none, filled chunk by chunk.
pub(crate) struct UnsharedShapeTable {
    coordinates: [Vec<f64>; 2],
    table: ShapeTable,
}

impl<const D: usize> Default for Workspace<D> {
    fn default() -> Self {
        Self {
            projections: CellProjectionCache::default(),
            projector: Projector {
                pointwise: PointwiseProjector::new(),
                shapes: UnsharedShapeTable {
                    coordinates: [vec![0.0; CHUNK], vec![0.0; CHUNK]],
                    table: ShapeTable::default(),
                },
                pixel: [AlignedBuffer::zeros(CHUNK), AlignedBuffer::zeros(CHUNK)],
            },
            points: PointBuffers {
                grey: AlignedBuffer::default(),
                gradient: Default::default(),
                q: std::array::from_fn(|_| AlignedBuffer::default()),
                weights: AlignedBuffer::default(),
                scaled: AlignedBuffer::default(),
                residual: AlignedBuffer::default(),
            },
            weighted: AlignedBuffer::zeros(CHUNK),
        }
    }
}

impl<const D: usize> PointBuffers<D> {
    /// Makes room for the `count` points of a cell and clears the padding.
    pub(crate) fn resize(&mut self, count: usize) {
        let padded = count.next_multiple_of(PADDING);
        let rows = [&mut self.grey, &mut self.weights, &mut self.scaled, &mut self.residual];
        for row in rows.into_iter().chain(&mut self.gradient).chain(&mut self.q) {
            row.resize_for_overwrite(padded);
            row[count..].fill(0.0);
        }
    }
}

impl UnsharedShapeTable {
    /// The chunk of the points of a cell from `first` on: of the shared table of the cell if it has one, else computed here.
    pub(crate) fn chunk<'a>(
        &'a mut self,
        quadrature: &'a CellQuadrature,
        cell: usize,
        cell_type: CellType,
        first: usize,
    ) -> ShapeTableChunk<'a> {
        if let Some(table) = quadrature.shared_table(cell) {
            return table.chunk(first);
        }
        let count = CHUNK.min(quadrature.range(cell).len() - first);
        let [xi, eta] = &mut self.coordinates;
        quadrature.coordinates(cell, first, &mut xi[..count], &mut eta[..count]);
        self.table.fill(cell_type, &xi[..count], &eta[..count]);
        self.table.chunk(0)
    }
}
