//! The boundary of a mesh: edges that belong to one cell only.

use super::Mesh;

impl Mesh {
    /// For each node, whether it lies on the boundary: on a piece of an edge, between neighbouring nodes, that one cell only has.
    ///
    /// The two sides of a crack, whose nodes are doubled, are boundary. So are the two sides of a seam whose nodes do not match.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellType, rectangle_mesh};
    /// let mesh = rectangle_mesh([0.0, 0.0, 2.0, 2.0], 1.0, CellType::Quad)?;
    /// let inside: Vec<usize> = (0..9).filter(|&node| !mesh.boundary_nodes()[node]).collect();
    /// assert_eq!(inside, [4]);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    pub fn boundary_nodes(&self) -> Vec<bool> {
        let mut boundary = vec![false; self.num_nodes()];
        self.boundary_edges().as_flattened().iter().for_each(|&node| boundary[node as usize] = true);
        boundary
    }

    /// Pieces of edges, between neighbouring nodes, of one cell only.
    pub(super) fn boundary_edges(&self) -> Vec<[u32; 2]> {
        let mut edges: Vec<[u32; 2]> = Vec::with_capacity(4 * self.num_cells());
        for cell in self.cells() {
            let outline = cell.cell_type.outline();
            for (k, &from) in outline.iter().enumerate() {
                let [a, b] = [from, outline[(k + 1) % outline.len()]].map(|local| cell.nodes[local]);
                if a != b {
                    edges.push([a.min(b), a.max(b)]);
                }
            }
        }
        edges.sort_unstable();
        edges.chunk_by(|a, b| a == b).filter(|uses| uses.len() == 1).map(|uses| uses[0]).collect()
    }
}
