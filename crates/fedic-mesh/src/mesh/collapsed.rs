//! Cells that list a node more than once: quadrilaterals that stand for triangles.

use super::Mesh;
use crate::{CellType, MeshError};

impl Mesh {
    /// The mesh with quadrilaterals of one edge of length zero, both corners of which are one node, as triangles: a `quad` as
    /// `triangle`, a `quad8` as `triangle6`. Cells keep their numbers.
    ///
    /// Abaqus, LS-DYNA and Nastran write triangles as quadrilaterals with a repeated node.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellType, Mesh};
    /// let points = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    /// let mesh = Mesh::new(points, &[(CellType::Quad, vec![0, 1, 2, 2])])?.collapsed_as_triangles();
    /// assert_eq!(mesh.cell(0).cell_type, CellType::Triangle);
    /// assert_eq!(mesh.cell(0).nodes, [0, 1, 2]);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    #[must_use]
    pub fn collapsed_as_triangles(&self) -> Self {
        if self.cells().all(|cell| !repeats_a_node(cell.nodes)) {
            return self.clone();
        }
        let num_cells = self.num_cells();
        let mut mesh = Self {
            cell_types: Vec::with_capacity(num_cells),
            offsets: vec![0],
            nodes: Vec::with_capacity(self.nodes.len()),
            ..self.clone()
        };
        for cell in self.cells() {
            match triangle_of(cell.cell_type, cell.nodes) {
                Some((cell_type, nodes)) => {
                    mesh.cell_types.push(cell_type);
                    mesh.nodes.extend(nodes);
                }
                None => {
                    mesh.cell_types.push(cell.cell_type);
                    mesh.nodes.extend(cell.nodes);
                }
            }
            mesh.offsets.push(mesh.nodes.len());
        }
        mesh
    }

    /// Refuses cells that list a node more than once and are no triangles written as quadrilaterals.
    pub(super) fn check_repeated_nodes(&self) -> Result<(), MeshError> {
        let refused = |&cell: &usize| {
            let cell = self.cell(cell);
            repeats_a_node(cell.nodes) && triangle_of(cell.cell_type, cell.nodes).is_none()
        };
        let cells: Vec<usize> = (0..self.num_cells()).filter(refused).collect();
        if cells.is_empty() { Ok(()) } else { Err(MeshError::RepeatedNodes { cells }) }
    }
}

fn repeats_a_node(nodes: &[u32]) -> bool {
    (1..nodes.len()).any(|k| nodes[..k].contains(&nodes[k]))
}

/// The triangle that a quadrilateral with one collapsed edge is, or `None` if it is none.
fn triangle_of(cell_type: CellType, nodes: &[u32]) -> Option<(CellType, Vec<u32>)> {
    let triangle = match cell_type {
        CellType::Quad => CellType::Triangle,
        CellType::Quad8 => CellType::Triangle6,
        _ => return None,
    };
    let edge = (0..4).find(|&edge| nodes[edge] == nodes[(edge + 1) % 4])?;
    // Edges in order, each with its first corner and the node halfway, but for the collapsed one.
    let mut edges = [1, 2, 3].map(|step| (edge + step) % 4);
    edges.sort_unstable();
    let corners = edges.map(|edge| nodes[edge]);
    let mut kept = corners.to_vec();
    if cell_type == CellType::Quad8 {
        if nodes[4 + edge] != nodes[edge] {
            return None;
        }
        kept.extend(edges.map(|edge| nodes[4 + edge]));
    }
    (!repeats_a_node(&kept)).then_some((triangle, kept))
}
