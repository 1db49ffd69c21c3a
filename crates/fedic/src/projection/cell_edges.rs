//! Edges of cells in the image, and the distance of image points from them.

use fedic_mesh::Mesh;

use crate::projection::projected_points::ProjectedPoint;

/// Some edges of some cells, as straight lines between image points.
#[derive(Debug, Default)]
pub(crate) struct CellEdges {
    /// Both ends of the edges of each cell; empty if there is no edge at all.
    of_cell: Vec<Vec<[[f64; 2]; 2]>>,
}

impl CellEdges {
    /// Edges given by their cell and the nodes at their ends. `nodes` are the projected nodes of the mesh.
    pub(crate) fn new(
        mesh: &Mesh,
        nodes: &[ProjectedPoint],
        edges: impl IntoIterator<Item = (usize, [u32; 2])>,
    ) -> Self {
        let mut found = Self::default();
        for (cell, ends) in edges {
            found.of_cell.resize(mesh.num_cells(), Vec::new());
            found.of_cell[cell].push(ends.map(|node| nodes[node as usize].pixel));
        }
        found
    }

    /// Edges at which the mesh is cut: others lie at the same place, with other nodes.
    pub(crate) fn cuts(mesh: &Mesh, nodes: &[ProjectedPoint]) -> Self {
        let ends = |cell: usize, edge: usize| {
            let corners = mesh.cell(cell).cell_type.num_corners();
            [edge, (edge + 1) % corners].map(|corner| mesh.cell(cell).nodes[corner])
        };
        let slits = mesh.slits(Mesh::COINCIDENT);
        Self::new(mesh, nodes, slits.into_iter().flatten().map(|edge| (edge.cell, ends(edge.cell, edge.edge))))
    }

    /// Edges on the border of the mesh, which no other cell shares.
    pub(crate) fn borders(mesh: &Mesh, nodes: &[ProjectedPoint]) -> Self {
        Self::new(mesh, nodes, mesh.boundary_edges().into_iter().map(|edge| (edge.cell, edge.nodes)))
    }

    /// Whether a cell has edges.
    pub(crate) fn has(&self, cell: usize) -> bool {
        self.of_cell.get(cell).is_some_and(|edges| !edges.is_empty())
    }

    /// Distances in pixels of an image point from the edges of a cell that it lies beside, between their ends.
    pub(crate) fn distances(&self, cell: usize, point: [f64; 2]) -> impl Iterator<Item = f64> {
        self.of_cell.get(cell).into_iter().flatten().filter_map(move |[a, b]| {
            let [along, from] = [[b[0] - a[0], b[1] - a[1]], [point[0] - a[0], point[1] - a[1]]];
            let square = along[0] * along[0] + along[1] * along[1];
            let place = (along[0] * from[0] + along[1] * from[1]) / square;
            let across = (along[0] * from[1] - along[1] * from[0]) / square.sqrt();
            (0.0..1.0).contains(&place).then_some(across.abs())
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_camera::ImageFrame;
    use fedic_mesh::{CellType, rectangle_mesh};

    use super::*;
    use crate::projection::projected_points::project_nodes;

    #[test]
    fn cuts_are_the_edges_of_both_sides() {
        for cell_type in [CellType::Quad, CellType::Quad8, CellType::Quad9] {
            let whole = rectangle_mesh([0.0, 0.0, 40.0, 40.0], 10.0, cell_type).unwrap();
            let mesh = whole.split(&[[0.0, 20.0, 0.0], [20.0, 20.0, 0.0]]).unwrap();
            let nodes = project_nodes::<2>(&mesh, &ImageFrame, None);
            let cuts = CellEdges::cuts(&mesh, &nodes);
            let cells: Vec<usize> = (0..mesh.num_cells()).filter(|&cell| cuts.has(cell)).collect();
            assert_eq!(cells, [4, 5, 8, 9], "{cell_type}");
            let distances: Vec<f64> = cuts.distances(4, [3.0, 17.5]).collect();
            assert!(distances.len() == 1 && (distances[0] - 2.5).abs() < 1e-12);
            let whole = CellEdges::cuts(&whole, &nodes);
            assert!((0..16).all(|cell| !whole.has(cell)));
        }
    }

    #[test]
    fn borders_are_the_edges_of_one_cell() {
        for cell_type in CellType::ALL {
            let mesh = rectangle_mesh([0.0, 0.0, 30.0, 30.0], 10.0, cell_type).unwrap();
            let nodes = project_nodes::<2>(&mesh, &ImageFrame, None);
            let borders = CellEdges::borders(&mesh, &nodes);
            let inside = |cell: usize| {
                let points = mesh.cell_points(cell);
                points.iter().all(|p| p[0] >= 10.0 && p[0] <= 20.0 && p[1] >= 10.0 && p[1] <= 20.0)
            };
            for cell in (0..mesh.num_cells()).filter(|&cell| inside(cell)) {
                assert!(!borders.has(cell), "{cell_type}");
            }
            assert!(borders.has(0));
        }
    }
}
