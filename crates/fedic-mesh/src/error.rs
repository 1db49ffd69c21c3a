//! What can be wrong with a mesh.

use thiserror::Error;

use crate::CellType;

/// A mesh that cannot be used; every variant says which cell or node is at fault.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeshError {
    /// No cell at all.
    #[error("the mesh has no surface cells; give at least one triangle, quad, triangle6, quad8 or quad9")]
    Empty,
    /// A name that is none of the five cell types.
    #[error("unknown cell type \"{name}\"; fedic measures on triangle, triangle6, quad, quad8 and quad9")]
    UnknownCellType {
        /// The name given.
        name: String,
    },
    /// The connectivity does not have a whole number of cells.
    #[error(
        "cells of type {cell_type} need {} nodes each, but {found} were given", cell_type.num_nodes()
    )]
    WrongNodeCount {
        /// Type of the cells.
        cell_type: CellType,
        /// Nodes found per cell, or in all where they do not divide.
        found: usize,
    },
    /// A node coordinate is NaN or infinite.
    #[error("node {node} has a coordinate that is not finite; check the mesh file")]
    NonFinitePoint {
        /// Index of the node.
        node: usize,
    },
    /// A cell refers to a node that does not exist.
    #[error("cell {cell} ({cell_type}) refers to node {node}, but the nodes are 0 to {}", num_points.saturating_sub(1))]
    NodeOutOfRange {
        /// Index of the cell over all blocks.
        cell: usize,
        /// Its type.
        cell_type: CellType,
        /// The index it refers to.
        node: i64,
        /// Number of nodes of the mesh.
        num_points: usize,
    },
    /// Cells of zero area, or folded so that their Jacobian changes sign.
    #[error(
        "{} {} zero area or a Jacobian that changes sign (inverted, folded or nodes in the wrong order); mend the mesh there",
        list_indices("cell", cells),
        if cells.len() == 1 { "has" } else { "have" }
    )]
    DegenerateCells {
        /// Indices of the cells over all blocks.
        cells: Vec<usize>,
    },
    /// Bounds or size of a generated mesh make no sense.
    #[error(
        "rectangle_mesh needs finite bounds (x0, y0, x1, y1) with x0 < x1 and y0 < y1 and a positive size; got {bounds:?} and {size}"
    )]
    InvalidRectangle {
        /// The bounds given.
        bounds: [f64; 4],
        /// The size given.
        size: f64,
    },
    /// A generated mesh would have more nodes than can be numbered.
    #[error("a mesh of {cells:.3e} cells is too large; choose a larger element size")]
    TooLarge {
        /// Number of cells asked for.
        cells: f64,
    },
}

/// Names a list of indices in a sentence: "cells 3, 5, 8 and 40 more".
pub fn list_indices(noun: &str, indices: &[usize]) -> String {
    const SHOWN: usize = 8;
    let shown: Vec<String> = indices.iter().take(SHOWN).map(ToString::to_string).collect();
    let plural = if indices.len() == 1 { "" } else { "s" };
    let rest = match indices.len().saturating_sub(SHOWN) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{noun}{plural} {}{rest}", shown.join(", "))
}
