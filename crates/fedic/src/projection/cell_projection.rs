//! A cell as the camera sees it.

use std::ops::Range;

use fedic_camera::Camera;
use fedic_mesh::{Cell, CellType, MAX_NODES, Mesh};
use rayon::prelude::*;

use crate::COMPONENTS;
use crate::projection::cell_polynomial::{Expansion, TOGETHER, expand};
use crate::projection::pointwise::{BATCH, Batch};
use crate::projection::projected_points::{MOST_SIGHTS, Sight, Sights};
use crate::quadrature::cell_quadrature::CellQuadrature;

/// Where a cell's nodes are, and the polynomials that say where its points are seen, unless only the camera can.
pub(crate) struct CellView<'a> {
    cell_type: CellType,
    nodes: [&'a Sight; MAX_NODES],
    pub(crate) expansion: Option<Expansion>,
}

/// Every node of a mesh, displaced if asked, as the camera sees it.
pub(crate) fn node_views(mesh: &Mesh, camera: &dyn Camera, displacement: Option<&[[f64; COMPONENTS]]>) -> Vec<Sight> {
    let mut views = vec![Sight::default(); mesh.num_nodes()];
    views.par_chunks_mut(MOST_SIGHTS).enumerate().for_each(|(chunk, views)| {
        let sights = sights(mesh, camera, displacement, chunk);
        views.iter_mut().enumerate().for_each(|(k, view)| *view = sights.at(k));
    });
    views
}

/// A displacement of the nodes as the camera sees it, in pixels.
pub(crate) fn seen_displacement(mesh: &Mesh, camera: &dyn Camera, displacement: &[[f64; COMPONENTS]]) -> Vec<[f64; 2]> {
    let mut seen = vec![[0.0; 2]; mesh.num_nodes()];
    seen.par_chunks_mut(MOST_SIGHTS).enumerate().for_each(|(chunk, seen)| {
        let [from, to] = [None, Some(displacement)].map(|displacement| sights(mesh, camera, displacement, chunk));
        for (k, seen) in seen.iter_mut().enumerate() {
            let (from, to) = (from.at(k).pixel, to.at(k).pixel);
            *seen = [to[0] - from[0], to[1] - from[1]];
        }
    });
    seen
}

/// The nodes of a chunk of [`MOST_SIGHTS`].
fn sights(mesh: &Mesh, camera: &dyn Camera, displacement: Option<&[[f64; COMPONENTS]]>, chunk: usize) -> Sights {
    let nodes = chunk * MOST_SIGHTS..mesh.num_nodes();
    let places = nodes.map(|node| {
        let mut place = mesh.points()[node];
        if let Some(displacement) = displacement {
            place.iter_mut().zip(displacement[node]).for_each(|(x, u)| *x += u);
        }
        place
    });
    Sights::new(camera, places)
}

/// Least and greatest pixel coordinate of some nodes, along `u` and along `v`.
pub(crate) fn extents<'a>(views: impl Iterator<Item = &'a Sight>) -> [[f64; 2]; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    views.fold([none; 2], |extents, view| {
        [0, 1].map(|c| {
            let ([low, high], x) = (extents[c], view.pixel[c]);
            [low.min(x), high.max(x)]
        })
    })
}

impl<'a> CellView<'a> {
    pub(crate) fn new(mesh: &Mesh, cell: usize, views: &'a [Sight], camera: &dyn Camera) -> Self {
        let mut expansion = [None];
        expand(std::iter::once(mesh.cell(cell)), views, camera, None, &mut expansion);
        Self::expanded(mesh.cell(cell), views, expansion[0])
    }

    fn expanded(cell: Cell<'_>, views: &'a [Sight], expansion: Option<Expansion>) -> Self {
        let mut nodes = [&views[cell.nodes[0] as usize]; MAX_NODES];
        nodes.iter_mut().zip(cell.nodes).for_each(|(view, &node)| *view = &views[node as usize]);
        Self { cell_type: cell.cell_type, nodes, expansion }
    }

    /// Projects the points of the cell one by one, batch by batch; `use_batch` is told which points a batch holds.
    pub(crate) fn for_each_batch(
        &self,
        batch: &mut Batch,
        quadrature: &CellQuadrature,
        cell: usize,
        camera: &dyn Camera,
        mut use_batch: impl FnMut(&mut Batch, Range<usize>),
    ) {
        let count = quadrature.range(cell).len();
        let places = self.nodes.map(|node| node.place);
        for first in (0..count).step_by(BATCH) {
            let points = first..count.min(first + BATCH);
            batch.take(quadrature, cell, self.cell_type, first, points.len());
            batch.project_with_jacobian(camera, &places[..self.cell_type.num_nodes()]);
            use_batch(batch, points);
        }
    }
}

/// Cells that follow one another, expanded together.
#[derive(Default)]
pub(crate) struct CellsInTurn {
    cells: Range<usize>,
    expansions: [Option<Expansion>; TOGETHER],
}

impl CellsInTurn {
    /// A cell as the camera sees it; `followed` says of every cell of the mesh what [`expand`] may know of some. All but `cell`
    /// must be as in the calls before: it serves one pass over the cells.
    pub(crate) fn view<'a>(
        &mut self,
        mesh: &Mesh,
        cell: usize,
        views: &'a [Sight],
        camera: &dyn Camera,
        followed: Option<&[bool]>,
    ) -> CellView<'a> {
        if !self.cells.contains(&cell) {
            self.cells = cell..mesh.num_cells().min(cell + TOGETHER);
            let cells = self.cells.clone().map(|cell| mesh.cell(cell));
            let followed = followed.map(|followed| &followed[self.cells.clone()]);
            expand(cells, views, camera, followed, &mut self.expansions);
        }
        CellView::expanded(mesh.cell(cell), views, self.expansions[cell - self.cells.start])
    }
}
