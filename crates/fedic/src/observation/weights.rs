//! Weights of the quadrature points: the area of the surface that each stands for.

use fedic_mesh::{CellType, Mesh, jacobian};
use rayon::prelude::*;

use crate::quadrature::cell_quadrature::CellQuadrature;

/// Relative difference up to which the weights of a cell count as equal: below the resolution of `f32`.
const UNIFORM: f64 = 3e-8;
/// Number of points processed at once.
const BLOCK: usize = 64;

/// Scale of the weights of each cell, and whether the weights vary over it: they do where the map of the cell is not affine, and
/// where points may be dropped.
pub(crate) fn cell_weights(
    mesh: &Mesh,
    quadrature: &CellQuadrature,
    may_drop: impl Fn(usize) -> bool + Sync,
) -> Vec<(f64, bool)> {
    let weights = |cell: usize| {
        let may_drop = may_drop(cell);
        let Some(area) = quadrature.point_area(cell) else { return (1.0, may_drop) };
        let (cell_type, nodes) = (mesh.cell(cell).cell_type, mesh.cell_points(cell));
        let centre = surface_element(cell_type, &nodes, cell_type.reference_centre());
        let differs = |&at: &[f64; 2]| (surface_element(cell_type, &nodes, at) - centre).abs() > UNIFORM * centre;
        let varying = may_drop || cell_type.reference_nodes().iter().any(differs);
        (if varying { area } else { area * centre }, varying)
    };
    (0..mesh.num_cells()).into_par_iter().map(weights).collect()
}

/// Writes the weights of the points of a cell, before its scale.
pub(crate) fn fill_weights(mesh: &Mesh, quadrature: &CellQuadrature, cell: usize, weights: &mut [f32]) {
    if quadrature.point_area(cell).is_none() {
        return weights.fill(1.0);
    }
    let (cell_type, nodes) = (mesh.cell(cell).cell_type, mesh.cell_points(cell));
    let (mut xi, mut eta) = ([0.0; BLOCK], [0.0; BLOCK]);
    for (block, weights) in weights.chunks_mut(BLOCK).enumerate() {
        let n = weights.len();
        quadrature.coordinates(cell, block * BLOCK, &mut xi[..n], &mut eta[..n]);
        for (k, weight) in weights.iter_mut().enumerate() {
            *weight = surface_element(cell_type, &nodes, [xi[k], eta[k]]) as f32;
        }
    }
}

/// Area of the surface per area of the reference cell.
fn surface_element(cell_type: CellType, nodes: &[[f64; 3]], at: [f64; 2]) -> f64 {
    let [[xx, xy], [yx, yy], [zx, zy]] = jacobian(cell_type, nodes, at);
    let normal = [yx * zy - yy * zx, zx * xy - zy * xx, xx * yy - xy * yx];
    normal.iter().map(|c| c * c).sum::<f64>().sqrt()
}
