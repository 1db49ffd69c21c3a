//! Slits: edges at one place that belong to different cells and have different nodes.

use super::Mesh;
use super::edges::CellEdge;

impl Mesh {
    /// Pairs of edges at one place that do not have the same nodes, in ascending order: the two sides of cuts and seams, across which
    /// the displacement may jump. The third node of quadratic edges is at one place too.
    ///
    /// Found from the coordinates, as the nodes of [`coincident_nodes`](Self::coincident_nodes) are: nodes are at one place if they are
    /// closer than `relative` times the longest edge at either of them. Sides whose nodes do not match have no pairs; see
    /// [`hanging_nodes`](Self::hanging_nodes).
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_mesh::{CellEdge, CellType, rectangle_mesh, Mesh};
    /// let whole = rectangle_mesh([0.0, 0.0, 2.0, 2.0], 1.0, CellType::Quad)?;
    /// assert!(whole.slits(Mesh::COINCIDENT).is_empty());
    /// let cut = whole.split(&[[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]])?;
    /// // The upper edge of cell 0 and the lower edge of cell 2.
    /// assert_eq!(cut.slits(Mesh::COINCIDENT), [[CellEdge { cell: 0, edge: 2 }, CellEdge { cell: 2, edge: 0 }]]);
    /// # Ok::<(), fedic_mesh::MeshError>(())
    /// ```
    pub fn slits(&self, relative: f64) -> Vec<[CellEdge; 2]> {
        let places = self.places(relative);
        let mut edges = Vec::with_capacity(4 * self.num_cells());
        for cell in 0..self.num_cells() {
            edges.extend(self.edges(cell).map(|nodes| {
                let edge = CellEdge { cell, edge: nodes.edge };
                ((nodes.key(), nodes.middle), edge)
            }));
        }
        edges.sort_unstable();
        let place = |node: u32| places[node as usize];
        let boundary = edges.chunk_by(|(a, _), (b, _)| a == b).filter(|uses| uses.len() == 1);
        let mut boundary: Vec<_> = boundary
            .map(|uses| {
                let ((corners, middle), edge) = uses[0];
                let [a, b] = corners.map(place);
                (([a.min(b), a.max(b)], middle.map(place)), edge)
            })
            .collect();
        boundary.sort_unstable();
        let mut pairs = Vec::new();
        for sides in boundary.chunk_by(|(a, _), (b, _)| a == b) {
            for (k, &(_, first)) in sides.iter().enumerate() {
                pairs.extend(sides[k + 1..].iter().map(|&(_, second)| [first, second]));
            }
        }
        pairs.sort_unstable();
        pairs
    }
}
