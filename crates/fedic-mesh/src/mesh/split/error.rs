//! Lines along which a mesh cannot be cut.

use std::fmt;

use thiserror::Error;

/// A line that does not follow the edges of the cells, or separates nothing; see [`Mesh::split`](crate::Mesh::split).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LineError {
    /// There are not two different points.
    #[error("a line along the edges of the cells needs at least two different points")]
    TooShort,
    /// A coordinate is NaN or infinite.
    #[error("point {point} of the line has a coordinate that is not finite")]
    NonFinite {
        /// Index of the point of the line.
        point: usize,
    },
    /// A point is at no node on the edges of cells.
    #[error(
        "point {point} of the line, {}, is at no node on the edges of the cells; the nearest is node {nearest} at {}, {} away",
        Place(*place), Place(*node_place), rounded(*distance)
    )]
    OffNodes {
        /// Index of the point of the line.
        point: usize,
        /// The point.
        place: [f64; 3],
        /// The nearest node.
        nearest: usize,
        /// Where that is.
        node_place: [f64; 3],
        /// How far away.
        distance: f64,
    },
    /// No edge continues along the line.
    #[error(
        "the line leaves the edges of the cells at node {node}, {}, on the way from its point {point} to the next one; edges have to \
         lie on the line, or give the nodes between as points",
        Place(*place)
    )]
    OffEdges {
        /// Index of the point of the line from which the part in question starts.
        point: usize,
        /// The last node on the line.
        node: usize,
        /// Where that is.
        place: [f64; 3],
    },
    /// The line covers a part of an edge.
    #[error(
        "the line ends or turns back at node {node}, {}, in the middle of an edge; end it at a corner of a cell",
        Place(*place)
    )]
    InsideEdge {
        /// The node in the middle of the edge.
        node: usize,
        /// Where that is.
        place: [f64; 3],
    },
    /// All cells remain joined.
    #[error(
        "the line separates no cells: it runs along the boundary or an earlier cut, or it is a single edge inside the mesh whose ends \
         stay joined"
    )]
    CutsNothing,
}

/// A number of six significant digits.
fn rounded(number: f64) -> f64 {
    format!("{number:.5e}").parse().unwrap_or(number)
}

/// A point as messages write it.
struct Place([f64; 3]);

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0.map(rounded);
        if z == 0.0 { write!(f, "({x}, {y})") } else { write!(f, "({x}, {y}, {z})") }
    }
}
