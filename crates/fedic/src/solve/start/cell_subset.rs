//! A small, spatially stratified subset of the cells, from which global quantities are estimated cheaply.

use fedic_mesh::Mesh;

use crate::projection::projected_points::{ProjectedPoint, pixel_bounds};

/// Number of squares along each side of the mesh. The subset has a few hundred cells, evaluated in a millisecond.
const SIDE: usize = 16;

/// One cell of every square of a grid over the projected mesh, so that regions of few large cells are covered too.
pub(crate) fn stratified_cells(mesh: &Mesh, projected: &[ProjectedPoint]) -> Vec<usize> {
    let bounds = pixel_bounds(projected.iter());
    let mut first_of = [None; SIDE * SIDE];
    for cell in 0..mesh.num_cells() {
        let nodes = mesh.cell(cell).nodes;
        let square = [0, 1].map(|c| {
            let centre = nodes.iter().map(|&node| projected[node as usize].pixel[c]).sum::<f64>() / nodes.len() as f64;
            let [low, high] = bounds[c];
            let position = (centre - low) / (high - low);
            // A NaN is put in the first square.
            ((position * SIDE as f64) as usize).min(SIDE - 1)
        });
        first_of[square[1] * SIDE + square[0]].get_or_insert(cell);
    }
    let mut cells: Vec<usize> = first_of.into_iter().flatten().collect();
    cells.sort_unstable();
    cells
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_camera::ImageFrame;
    use fedic_mesh::{CellType, rectangle_mesh};

    use super::*;
    use crate::projection::projected_points::project_nodes;

    #[test]
    fn the_subset_covers_the_mesh() {
        let mesh = rectangle_mesh([0.0, 0.0, 320.0, 160.0], 4.0, CellType::Quad).unwrap();
        let subset = stratified_cells(&mesh, &project_nodes::<2>(&mesh, &ImageFrame, None));
        assert_eq!(subset.len(), SIDE * SIDE);
        assert!(subset.is_sorted_by(|a, b| a < b));
        for corner in [0, 79, 80 * 39, 80 * 40 - 1] {
            let near = |&cell: &usize| {
                let [column, row] = [cell % 80, cell / 80];
                column.abs_diff(corner % 80) < 5 && row.abs_diff(corner / 80) < 3
            };
            assert!(subset.iter().any(near), "no cell near the corner {corner}");
        }
    }

    #[test]
    fn large_cells_are_included_beside_many_small_ones() {
        // A strip of four large cells beside 1600 small ones.
        let fine = rectangle_mesh([0.0, 0.0, 40.0, 40.0], 1.0, CellType::Quad).unwrap();
        let coarse = rectangle_mesh([40.0, 0.0, 200.0, 40.0], 40.0, CellType::Quad).unwrap();
        let shift = fine.num_nodes() as i64;
        let points = [fine.points(), coarse.points()].concat();
        let quads = |mesh: &Mesh, shift: i64| -> Vec<i64> {
            mesh.cells().flat_map(|cell| cell.nodes.iter().map(move |&node| i64::from(node) + shift)).collect()
        };
        let cells = [quads(&fine, 0), quads(&coarse, shift)].concat();
        let mesh = Mesh::new(points, &[(CellType::Quad, cells)]).unwrap();
        let subset = stratified_cells(&mesh, &project_nodes::<2>(&mesh, &ImageFrame, None));
        assert!((1600..1604).all(|cell| subset.contains(&cell)), "{subset:?}");
    }
}
