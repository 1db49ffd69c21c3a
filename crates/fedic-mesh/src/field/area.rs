//! Areas of cells.

use crate::isoparametric::{cross, tangents};
use crate::{Mesh, Subdivision};

/// Intervals per edge of the subdivision that integrates a cell.
const INTERVALS: u32 = 8;

/// Area of each cell in space, in the mesh's unit squared.
///
/// Exact for plane cells with straight edges; otherwise by the midpoint rule on 8 intervals per edge.
pub fn cell_areas(mesh: &Mesh) -> Vec<f64> {
    (0..mesh.num_cells())
        .map(|index| {
            let cell_type = mesh.cell(index).cell_type;
            let nodes = mesh.cell_points(index);
            let subdivision = Subdivision::uniform(cell_type, INTERVALS);
            let area_element = |at: [f64; 2]| {
                let [x, y, z] = cross(tangents(cell_type, &nodes, at));
                (x * x + y * y + z * z).sqrt()
            };
            subdivision.subcell_area() * subdivision.all_points().into_iter().map(area_element).sum::<f64>()
        })
        .collect()
}
