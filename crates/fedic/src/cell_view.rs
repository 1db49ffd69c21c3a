//! A cell as the camera sees it.

use fedic_camera::Camera;
use fedic_mesh::{CellType, MAX_NODES, Mesh};
use rayon::prelude::*;

use crate::COMPONENTS;
use crate::batch::{BATCH, Batch};
use crate::cell_quadrature::CellQuadrature;
use crate::expansion::{Expansion, NodeView};

/// Where a cell's nodes are, and the polynomials that say where its points are seen, unless only the camera can.
pub(crate) struct CellView<'a> {
    cell_type: CellType,
    nodes: [&'a NodeView; MAX_NODES],
    pub(crate) expansion: Option<Expansion>,
}

/// Every node of a mesh, displaced if asked, as the camera sees it.
pub(crate) fn node_views(
    mesh: &Mesh,
    camera: &dyn Camera,
    displacement: Option<&[[f64; COMPONENTS]]>,
) -> Vec<NodeView> {
    let view = |(node, &point): (usize, &[f64; 3])| {
        let mut place = point;
        if let Some(displacement) = displacement {
            place.iter_mut().zip(displacement[node]).for_each(|(x, u)| *x += u);
        }
        let (pixel, jacobian) = camera.project_with_jacobian(place);
        NodeView { place, pixel, jacobian }
    };
    mesh.points().par_iter().enumerate().map(view).collect()
}

/// Least and greatest pixel coordinate of some nodes, along `u` and along `v`.
pub(crate) fn extents<'a>(views: impl Iterator<Item = &'a NodeView>) -> [[f64; 2]; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    views.fold([none; 2], |extents, view| {
        [0, 1].map(|c| {
            let ([low, high], x) = (extents[c], view.pixel[c]);
            [low.min(x), high.max(x)]
        })
    })
}

impl<'a> CellView<'a> {
    pub(crate) fn new(mesh: &Mesh, cell: usize, views: &'a [NodeView], camera: &dyn Camera) -> Self {
        let cell = mesh.cell(cell);
        let mut nodes = [&views[cell.nodes[0] as usize]; MAX_NODES];
        nodes.iter_mut().zip(cell.nodes).for_each(|(view, &node)| *view = &views[node as usize]);
        let expansion = Expansion::new(cell.cell_type, &nodes[..cell.nodes.len()], camera);
        Self { cell_type: cell.cell_type, nodes, expansion }
    }

    /// Projects the points of the cell one by one, batch by batch; `use_batch` is told which points a batch holds.
    pub(crate) fn for_each_batch(
        &self,
        batch: &mut Batch,
        quadrature: &CellQuadrature,
        cell: usize,
        camera: &dyn Camera,
        mut use_batch: impl FnMut(&mut Batch, std::ops::Range<usize>),
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
