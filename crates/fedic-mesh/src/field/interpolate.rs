//! Values of nodal fields between the nodes.

use rayon::prelude::*;

use crate::{Locator, shape_values};

/// Values at points of the `(x, y)` plane of a nodal field with `width` components; NaN outside the mesh.
///
/// `nodal` holds the components of node 0, then those of node 1, and so on; the result likewise for the points. A surface in
/// space is searched in its projection onto the `(x, y)` plane.
///
/// # Panics
///
/// If `nodal` does not hold `width` numbers per node of the locator's mesh.
pub fn interpolate_field(locator: &Locator<'_>, nodal: &[f64], width: usize, points: &[[f64; 2]]) -> Vec<f64> {
    let mesh = locator.mesh();
    assert_eq!(nodal.len(), mesh.num_nodes() * width, "a nodal field has {width} numbers per node");
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
