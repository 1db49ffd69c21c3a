//! The edges of cells that a path covers.

use std::collections::HashMap;

use super::LineError;
use crate::Mesh;
use crate::mesh::edges::EdgeNodes;

/// Edges of cells covered by a path. Nodes at one place are one here, the lowest of them.
pub(super) struct Cut<'a> {
    places: &'a [u32],
    /// For each pair of neighbours on the path, in ascending order: its number and its first node.
    pieces: HashMap<[u32; 2], (usize, u32)>,
}

/// An edge of a cell that is cut.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct CutEdge {
    /// Its number along the path.
    number: usize,
    /// Whether the cell is to the left of the path.
    is_left: bool,
}

impl CutEdge {
    /// Number of the edge along the path if the cell is to the left of it.
    pub(super) fn left_number(self) -> Option<usize> {
        self.is_left.then_some(self.number)
    }
}

impl<'a> Cut<'a> {
    pub(super) fn new(places: &'a [u32], path: &[u32]) -> Self {
        let mut pieces = HashMap::new();
        for (number, pair) in path.windows(2).enumerate() {
            pieces.entry(ascending([pair[0], pair[1]])).or_insert((number, pair[0]));
        }
        Self { places, pieces }
    }

    /// What is cut of an edge.
    ///
    /// # Errors
    ///
    /// [`LineError::InsideEdge`] if that is a part of the edge.
    pub(super) fn of(&self, mesh: &Mesh, edge: &EdgeNodes) -> Result<Option<CutEdge>, LineError> {
        let places: Vec<u32> = edge.nodes().map(|node| self.places[node as usize]).collect();
        let piece = |pair: &[u32]| {
            let &(number, first) = self.pieces.get(&ascending([pair[0], pair[1]]))?;
            Some(CutEdge { number, is_left: first == pair[0] })
        };
        let mut pieces = places.windows(2).map(piece);
        match (pieces.next().flatten(), pieces.next(), edge.middle) {
            (Some(_), Some(None), Some(node)) | (None, Some(Some(_)), Some(node)) => {
                let node = node as usize;
                Err(LineError::InsideEdge { node, place: mesh.points()[node] })
            }
            (piece, _, _) => Ok(piece),
        }
    }
}

fn ascending([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
