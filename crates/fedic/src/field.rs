//! Nodal fields between the nodes, and integrals over cells.

use fedic_mesh::{Locator, Mesh, Subdivision, jacobian, shape_values};
use rayon::prelude::*;

/// Parts of each edge over which a cell is integrated.
pub(crate) const PARTS: u32 = 8;

/// Value at each of `points`, in the `(x, y)` plane, of a field of `width` numbers per node; NaN outside the mesh.
///
/// `nodal` holds the numbers of node 0, then those of node 1, and so on; the result likewise for the points.
///
/// # Panics
///
/// If `nodal` does not hold `width` numbers per node.
pub fn interpolate_field(mesh: &Mesh, nodal: &[f64], width: usize, points: &[[f64; 2]]) -> Vec<f64> {
    assert_eq!(nodal.len(), mesh.num_nodes() * width, "a nodal field has {width} numbers per node");
    let locator = Locator::new(mesh);
    let mut values = vec![f64::NAN; points.len() * width];
    values.par_chunks_mut(width.max(1)).zip(points).for_each(|(value, &point)| {
        if let Some((cell, reference)) = locator.find(point) {
            let cell = mesh.cell(cell);
            value.fill(0.0);
            for (&node, n) in cell.nodes.iter().zip(shape_values(cell.cell_type, reference)) {
                for (c, value) in value.iter_mut().enumerate() {
                    *value += n * nodal[node as usize * width + c];
                }
            }
        }
    });
    values
}

/// Area of each cell in the `(x, y)` plane, in the mesh's unit squared; exact for straight edges.
pub fn cell_areas(mesh: &Mesh) -> Vec<f64> {
    (0..mesh.num_cells())
        .map(|index| {
            let cell_type = mesh.cell(index).cell_type;
            let nodes = mesh.cell_points(index);
            let subdivision = Subdivision::uniform(cell_type, PARTS);
            let determinant = |at: [f64; 2]| {
                let [[xx, xy], [yx, yy], _] = jacobian(cell_type, &nodes, at);
                xx * yy - xy * yx
            };
            subdivision.part_area() * subdivision.all_points().into_iter().map(determinant).sum::<f64>()
        })
        .collect()
}
