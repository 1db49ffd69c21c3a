//! Edges of the cells.

use super::Mesh;

/// An edge of a cell: edge `k` runs from corner `k` to the next one, counter-clockwise in a plane mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CellEdge {
    /// Index of the cell.
    pub cell: usize,
    /// Number of the edge within the cell.
    pub edge: usize,
}

/// Nodes of an edge of a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeNodes {
    /// Number of the edge within the cell.
    pub(super) edge: usize,
    /// Its ends, in the order of the cell.
    pub(super) corners: [u32; 2],
    /// The node in the middle, if the cell is quadratic.
    pub(super) middle: Option<u32>,
}

impl EdgeNodes {
    /// The nodes in the order of the cell.
    pub(super) fn nodes(&self) -> impl Iterator<Item = u32> {
        let [first, last] = self.corners;
        [Some(first), self.middle, Some(last)].into_iter().flatten()
    }

    /// The corners in ascending order, which cells that share the edge agree on.
    pub(super) fn key(&self) -> [u32; 2] {
        let [a, b] = self.corners;
        [a.min(b), a.max(b)]
    }
}

impl Mesh {
    /// Edges of a cell. Two equal corners make no edge.
    pub(super) fn edges(&self, cell: usize) -> impl Iterator<Item = EdgeNodes> {
        let cell = self.cell(cell);
        let (outline, intervals) = (cell.cell_type.outline(), cell.cell_type.edge_intervals());
        let node = move |position: usize| cell.nodes[outline[position % outline.len()]];
        let edges = (0..cell.cell_type.num_corners()).map(move |edge| EdgeNodes {
            edge,
            corners: [node(edge * intervals), node((edge + 1) * intervals)],
            middle: (intervals == 2).then(|| node(edge * intervals + 1)),
        });
        edges.filter(|edge| edge.corners[0] != edge.corners[1])
    }
}
