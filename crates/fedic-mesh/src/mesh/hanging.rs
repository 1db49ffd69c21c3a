//! Nodes on the edge of a cell that does not have them.

use super::Mesh;

impl Mesh {
    /// Nodes that lie on the edge of a cell without being its nodes, ascending: parts whose nodes do not match along a seam.
    ///
    /// A node lies on an edge if it is closer to it than `relative` times the length of the edge, and further than that from its
    /// ends. Edges are straight between their nodes. Only edges and nodes at the boundary of connected parts are looked at.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellType, Mesh};
    /// let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.5], [2.0, 0.0], [2.0, 1.0]];
    /// let cells = [(CellType::Quad, vec![0, 1, 2, 3]), (CellType::Triangle, vec![1, 5, 4, 4, 6, 2, 5, 6, 4])];
    /// let mesh = Mesh::new(points.map(|[x, y]| [x, y, 0.0]).to_vec(), &cells)?;
    /// assert_eq!(mesh.hanging_nodes(1e-4), [4]);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    pub fn hanging_nodes(&self, relative: f64) -> Vec<u32> {
        let edges: Vec<[u32; 2]> = self.boundary_edges().into_iter().map(|edge| edge.nodes).collect();
        let mut nodes: Vec<u32> = edges.iter().flatten().copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let along = self.sorting_coordinates();
        nodes.sort_by(|&a, &b| along[a as usize].total_cmp(&along[b as usize]));
        let mut hanging = Vec::new();
        for [a, b] in edges {
            let reach = relative * self.distance(a, b);
            let [a_along, b_along] = [a, b].map(|node| along[node as usize]);
            let start = nodes.partition_point(|&node| along[node as usize] < a_along.min(b_along) - reach);
            let near = nodes[start..].iter().take_while(|&&node| along[node as usize] <= a_along.max(b_along) + reach);
            hanging.extend(near.filter(|&&node| self.is_inside_edge(node, [a, b], reach)));
        }
        hanging.sort_unstable();
        hanging.dedup();
        hanging
    }

    /// Whether a node is within `reach` of the line between two others, and further from both.
    fn is_inside_edge(&self, node: u32, [a, b]: [u32; 2], reach: f64) -> bool {
        let [from_a, from_b, length] = [self.distance(node, a), self.distance(node, b), self.distance(a, b)];
        if from_a <= reach || from_b <= reach || from_a >= length || from_b >= length {
            return false;
        }
        let at = (from_a * from_a - from_b * from_b + length * length) / (2.0 * length);
        from_a * from_a - at * at <= reach * reach
    }
}
