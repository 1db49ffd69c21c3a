//! The boundary of a mesh: edges that belong to one cell only.

use super::Mesh;

/// A piece of the boundary between neighbouring nodes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BoundaryEdge {
    /// The cell that it belongs to.
    pub cell: usize,
    /// Nodes at its ends, in the order of the cell.
    pub nodes: [u32; 2],
}

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
        for edge in self.boundary_edges() {
            edge.nodes.iter().for_each(|&node| boundary[node as usize] = true);
        }
        boundary
    }

    /// Pieces of edges, between neighbouring nodes, of one cell only.
    pub fn boundary_edges(&self) -> Vec<BoundaryEdge> {
        let mut edges: Vec<([u32; 2], BoundaryEdge)> = Vec::with_capacity(4 * self.num_cells());
        for (index, cell) in self.cells().enumerate() {
            let outline = cell.cell_type.outline();
            for (k, &from) in outline.iter().enumerate() {
                let [a, b] = [from, outline[(k + 1) % outline.len()]].map(|local| cell.nodes[local]);
                if a != b {
                    edges.push(([a.min(b), a.max(b)], BoundaryEdge { cell: index, nodes: [a, b] }));
                }
            }
        }
        edges.sort_unstable_by_key(|&(key, edge)| (key, edge.cell));
        edges.chunk_by(|a, b| a.0 == b.0).filter(|uses| uses.len() == 1).map(|uses| uses[0].1).collect()
    }
}
