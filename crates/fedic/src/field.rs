//! Nodal fields between the nodes, and integrals over cells.

use fedic_mesh::{Locator, Mesh, Rule, Subdivision, jacobian, shape_values};
use rayon::prelude::*;

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
    let at = |&point: &[f64; 2]| {
        let mut value = vec![f64::NAN; width];
        if let Some((cell, reference)) = locator.find(point) {
            let cell = mesh.cell(cell);
            value.fill(0.0);
            for (&node, n) in cell.nodes.iter().zip(shape_values(cell.cell_type, reference)) {
                for (c, value) in value.iter_mut().enumerate() {
                    *value += n * nodal[node as usize * width + c];
                }
            }
        }
        value
    };
    points.par_iter().flat_map_iter(at).collect()
}

/// Area of each cell in the `(x, y)` plane, in the mesh's unit squared; exact for straight edges.
pub fn cell_areas(mesh: &Mesh) -> Vec<f64> {
    (0..mesh.num_cells())
        .map(|index| {
            let cell_type = mesh.cell(index).cell_type;
            let nodes = mesh.cell_points(index);
            let fine: Vec<[f64; 2]> = cell_type.reference_nodes().iter().map(|c| c.map(|c| 8.0 * c)).collect();
            let subdivision = Subdivision::of_cell(cell_type, &fine, Rule::Edges, 1.0);
            let count = subdivision.num_points();
            let (mut xi, mut eta) = (vec![0.0; count], vec![0.0; count]);
            subdivision.points(0, &mut xi, &mut eta);
            let determinant = |(&x, &y): (&f64, &f64)| {
                let j = jacobian(cell_type, &nodes, [x, y]);
                j[0][0] * j[1][1] - j[0][1] * j[1][0]
            };
            subdivision.part_area() * xi.iter().zip(&eta).map(determinant).sum::<f64>()
        })
        .collect()
}
