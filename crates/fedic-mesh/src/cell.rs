//! The five surface cells, under meshio's names and in its node order.

use std::fmt;
use std::str::FromStr;

use crate::MeshError;

/// Largest number of nodes of a cell.
pub const MAX_NODES: usize = 9;

/// Type of a surface cell.
///
/// Corners come first, then the nodes in the middle of the edges (the first one between corners 0 and 1), then the
/// centre.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CellType {
    /// Three-node triangle, linear.
    Triangle,
    /// Six-node triangle, quadratic.
    Triangle6,
    /// Four-node quadrilateral, bilinear.
    Quad,
    /// Eight-node quadrilateral, serendipity.
    Quad8,
    /// Nine-node quadrilateral, biquadratic.
    Quad9,
}

const TRIANGLE_NODES: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
const QUAD_NODES: [[f64; 2]; 9] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, 0.0]];

impl CellType {
    /// Every cell type.
    pub const ALL: [Self; 5] = [Self::Triangle, Self::Triangle6, Self::Quad, Self::Quad8, Self::Quad9];

    /// Number of nodes.
    pub const fn num_nodes(self) -> usize {
        match self {
            Self::Triangle => 3,
            Self::Triangle6 => 6,
            Self::Quad => 4,
            Self::Quad8 => 8,
            Self::Quad9 => 9,
        }
    }

    /// Whether the cell is a triangle (three corners) or a quadrilateral (four).
    pub const fn is_triangle(self) -> bool {
        matches!(self, Self::Triangle | Self::Triangle6)
    }

    /// Number of corners, 3 or 4.
    pub const fn num_corners(self) -> usize {
        if self.is_triangle() { 3 } else { 4 }
    }

    /// Area of the reference domain: 1/2 or 4.
    pub const fn reference_area(self) -> f64 {
        if self.is_triangle() { 0.5 } else { 4.0 }
    }

    /// Centre of the reference domain.
    pub const fn reference_centre(self) -> [f64; 2] {
        if self.is_triangle() { [1.0 / 3.0, 1.0 / 3.0] } else { [0.0, 0.0] }
    }

    /// Nodes in the reference domain, `(xi, eta)` each.
    pub fn reference_nodes(self) -> &'static [[f64; 2]] {
        let all: &'static [[f64; 2]] = if self.is_triangle() { &TRIANGLE_NODES } else { &QUAD_NODES };
        &all[..self.num_nodes()]
    }

    /// Local indices of the nodes around the cell, in order.
    pub const fn outline(self) -> &'static [usize] {
        match self {
            Self::Triangle => &[0, 1, 2],
            Self::Triangle6 => &[0, 3, 1, 4, 2, 5],
            Self::Quad => &[0, 1, 2, 3],
            Self::Quad8 | Self::Quad9 => &[0, 4, 1, 5, 2, 6, 3, 7],
        }
    }

    /// Local indices that list the nodes the other way round, first corner kept.
    pub(crate) const fn reversed(self) -> &'static [usize] {
        match self {
            Self::Triangle => &[0, 2, 1],
            Self::Triangle6 => &[0, 2, 1, 5, 4, 3],
            Self::Quad => &[0, 3, 2, 1],
            Self::Quad8 => &[0, 3, 2, 1, 7, 6, 5, 4],
            Self::Quad9 => &[0, 3, 2, 1, 7, 6, 5, 4, 8],
        }
    }

    /// meshio's name of the cell type.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Triangle => "triangle",
            Self::Triangle6 => "triangle6",
            Self::Quad => "quad",
            Self::Quad8 => "quad8",
            Self::Quad9 => "quad9",
        }
    }
}

impl fmt::Display for CellType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for CellType {
    type Err = MeshError;

    fn from_str(name: &str) -> Result<Self, MeshError> {
        Self::ALL
            .into_iter()
            .find(|cell| cell.name() == name)
            .ok_or_else(|| MeshError::UnknownCellType { name: name.to_owned() })
    }
}
