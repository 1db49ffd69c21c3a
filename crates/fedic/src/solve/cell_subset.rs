//! Some cells that tell of the whole mesh.

use fedic_mesh::Mesh;

use crate::projection::cell_projection::extents;
use crate::projection::projected_points::Sight;

/// Squares along each side of the mesh: a few hundred cells, read in a millisecond.
const SIDE: usize = 16;

/// One cell of every square of a grid over the mesh as it is seen: also of parts where cells are large and few.
pub(crate) fn spread_cells(mesh: &Mesh, views: &[Sight]) -> Vec<usize> {
    let extents = extents(views.iter());
    let mut first_of = [None; SIDE * SIDE];
    for cell in 0..mesh.num_cells() {
        let nodes = mesh.cell(cell).nodes;
        let square = [0, 1].map(|c| {
            let centre = nodes.iter().map(|&node| views[node as usize].pixel[c]).sum::<f64>() / nodes.len() as f64;
            let [low, high] = extents[c];
            let place = (centre - low) / (high - low);
            // A NaN falls in the first square.
            ((place * SIDE as f64) as usize).min(SIDE - 1)
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
    use crate::projection::cell_projection::node_views;

    #[test]
    fn a_sample_covers_the_mesh() {
        let mesh = rectangle_mesh([0.0, 0.0, 320.0, 160.0], 4.0, CellType::Quad).unwrap();
        let sample = spread_cells(&mesh, &node_views(&mesh, &ImageFrame, None));
        assert_eq!(sample.len(), SIDE * SIDE);
        assert!(sample.is_sorted_by(|a, b| a < b));
        for corner in [0, 79, 80 * 39, 80 * 40 - 1] {
            let near = |&cell: &usize| {
                let [column, row] = [cell % 80, cell / 80];
                column.abs_diff(corner % 80) < 5 && row.abs_diff(corner / 80) < 3
            };
            assert!(sample.iter().any(near), "no cell near the corner {corner}");
        }
    }

    #[test]
    fn large_cells_are_sampled_beside_many_small_ones() {
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
        let sample = spread_cells(&mesh, &node_views(&mesh, &ImageFrame, None));
        assert!((1600..1604).all(|cell| sample.contains(&cell)), "{sample:?}");
    }
}
