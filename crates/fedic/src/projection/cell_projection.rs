//! Projection of the points of one cell: by a polynomial where one is accurate, else point by point.

use std::ops::Range;

use fedic_camera::Camera;
use fedic_mesh::{Cell, CellType, MAX_NODES, Mesh};

use crate::projection::cell_polynomial::{CELLS_AT_ONCE, CellPolynomial, fit_cells};
use crate::projection::pointwise::PointwiseProjector;
use crate::projection::projected_points::ProjectedPoint;
use crate::quadrature::cell_quadrature::CellQuadrature;

/// The projected nodes of a cell and, where it is accurate enough, a polynomial approximation of the projection.
pub(crate) struct CellProjection<'a, const D: usize> {
    cell_type: CellType,
    nodes: [&'a ProjectedPoint; MAX_NODES],
    pub(crate) polynomial: Option<CellPolynomial<D>>,
}

impl<'a, const D: usize> CellProjection<'a, D> {
    /// Projects one cell of a mesh with these projected nodes.
    pub(crate) fn new(mesh: &Mesh, cell: usize, nodes: &'a [ProjectedPoint], camera: &dyn Camera) -> Self {
        let mut polynomial = [None];
        fit_cells(std::iter::once(mesh.cell(cell)), nodes, camera, None, &mut polynomial);
        Self::with_polynomial(mesh.cell(cell), nodes, polynomial[0])
    }

    /// Projects one cell exactly, without a polynomial.
    pub(crate) fn exact(cell: Cell<'_>, nodes: &'a [ProjectedPoint]) -> Self {
        Self::with_polynomial(cell, nodes, None)
    }

    fn with_polynomial(cell: Cell<'_>, nodes: &'a [ProjectedPoint], polynomial: Option<CellPolynomial<D>>) -> Self {
        let mut of_cell = [&nodes[cell.nodes[0] as usize]; MAX_NODES];
        of_cell.iter_mut().zip(cell.nodes).for_each(|(point, &node)| *point = &nodes[node as usize]);
        Self { cell_type: cell.cell_type, nodes: of_cell, polynomial }
    }

    /// Projects the points of the cell exactly, batch by batch. `use_batch` gets the batch and the points that it holds.
    pub(crate) fn for_each_batch(
        &self,
        batch: &mut PointwiseProjector,
        quadrature: &CellQuadrature,
        cell: usize,
        camera: &dyn Camera,
        use_batch: impl FnMut(&mut PointwiseProjector, Range<usize>),
    ) {
        let positions = self.nodes.map(|node| node.world);
        let nodes = &positions[..self.cell_type.num_nodes()];
        batch.for_each_batch(quadrature, (cell, self.cell_type), nodes, camera, use_batch);
    }
}

/// Polynomials of consecutive cells, fitted together.
pub(crate) struct CellProjectionCache<const D: usize> {
    cells: Range<usize>,
    polynomials: [Option<CellPolynomial<D>>; CELLS_AT_ONCE],
}

impl<const D: usize> Default for CellProjectionCache<D> {
    fn default() -> Self {
        Self { cells: 0..0, polynomials: [None; CELLS_AT_ONCE] }
    }
}

impl<const D: usize> CellProjectionCache<D> {
    /// Projects a cell. `accepted`, if given, holds for every cell of the mesh whether its polynomial is accurate, see [`fit_cells`].
    ///
    /// A cache serves one pass over the cells: all arguments but `cell` must be those of the calls before.
    pub(crate) fn project<'a>(
        &mut self,
        mesh: &Mesh,
        cell: usize,
        nodes: &'a [ProjectedPoint],
        camera: &dyn Camera,
        accepted: Option<&[bool]>,
    ) -> CellProjection<'a, D> {
        if !self.cells.contains(&cell) {
            self.cells = cell..mesh.num_cells().min(cell + CELLS_AT_ONCE);
            let cells = self.cells.clone().map(|cell| mesh.cell(cell));
            let accepted = accepted.map(|accepted| &accepted[self.cells.clone()]);
            fit_cells(cells, nodes, camera, accepted, &mut self.polynomials);
        }
        CellProjection::with_polynomial(mesh.cell(cell), nodes, self.polynomials[cell - self.cells.start])
    }
}
