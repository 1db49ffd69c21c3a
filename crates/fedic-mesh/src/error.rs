//! Errors of this crate.

use std::str::FromStr;

use thiserror::Error;

use crate::{CellType, LineError};

/// A mesh that cannot be used. Variants name the cells or nodes at fault.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum MeshError {
    /// The mesh has no cells.
    #[error("the mesh has no surface cells; give at least one cell of type {}", CellType::names("or"))]
    Empty,
    /// A name that is not a cell type.
    #[error("unknown cell type \"{name}\"; the cell types are {}", CellType::names("and"))]
    UnknownCellType {
        /// The name given.
        name: String,
    },
    /// The connectivity does not hold a whole number of cells.
    #[error(
        "cells of type {cell_type} need {} nodes each, but {found} were given", cell_type.num_nodes()
    )]
    WrongNodeCount {
        /// Type of the cells.
        cell_type: CellType,
        /// Nodes found per cell, or in all.
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
    /// Cells of zero area, or cells whose Jacobian changes sign.
    #[error(
        "{} {} zero area or a Jacobian that changes sign (inverted, folded or nodes in the wrong order); fix the mesh there",
        list_indices("cell", cells),
        if cells.len() == 1 { "has" } else { "have" }
    )]
    DegenerateCells {
        /// Indices of the cells over all blocks.
        cells: Vec<usize>,
    },
    /// Cells that list a node more than once and are no triangles written as quadrilaterals.
    #[error(
        "{} {} a node more than once; a quad with two equal neighbouring corners, or a quad8 with an edge of three equal nodes, \
         counts as a triangle, other cells need different nodes",
        list_indices("cell", cells),
        if cells.len() == 1 { "lists" } else { "list" }
    )]
    RepeatedNodes {
        /// Indices of the cells over all blocks.
        cells: Vec<usize>,
    },
    /// Nodes are joined so far apart that cells lose their area.
    #[error(
        "nodes up to {tolerance} apart are joined, which collapses {}; choose a tolerance below the shortest edge",
        list_indices("cell", cells)
    )]
    CollapsedCells {
        /// Indices of the cells over all blocks.
        cells: Vec<usize>,
        /// The tolerance given.
        tolerance: f64,
    },
    /// A tolerance that is negative or not finite.
    #[error("tolerance must be a finite number from 0 on, in the mesh's unit, got {tolerance}")]
    InvalidTolerance {
        /// The tolerance given.
        tolerance: f64,
    },
    /// A mesh cannot be cut along a line.
    #[error(transparent)]
    Line(#[from] LineError),
    /// A named set refers to a node or cell that does not exist.
    #[error("set \"{name}\" refers to {kind} {index}, but the mesh has {count} {kind}s")]
    SetOutOfRange {
        /// Name of the set.
        name: String,
        /// "node" or "cell".
        kind: &'static str,
        /// The index it refers to.
        index: u32,
        /// Number of nodes or cells of the mesh.
        count: usize,
    },
    /// There is not one label for each node or cell.
    #[error("a mesh of {expected} {kind}s has as many {kind} labels; {found} were given")]
    LabelCount {
        /// "node" or "cell".
        kind: &'static str,
        /// Number of nodes or cells of the mesh.
        expected: usize,
        /// Number of labels.
        found: usize,
    },
    /// A label that is not positive, or too large.
    #[error("{kind} {index} has the label {label}; labels are integers from 1 to 2^53")]
    InvalidLabel {
        /// "node" or "cell".
        kind: &'static str,
        /// Index of the node or cell.
        index: usize,
        /// Its label.
        label: i64,
    },
    /// Two nodes or two cells with the same label.
    #[error("{kind}s {} and {} have the same label {label}; labels tell {kind}s apart", indices[0], indices[1])]
    RepeatedLabel {
        /// "node" or "cell".
        kind: &'static str,
        /// Indices of the nodes or cells.
        indices: [usize; 2],
        /// Their label.
        label: i64,
    },
    /// A mesh is scaled by a factor that is not positive.
    #[error("a mesh is scaled by a positive finite factor, got {factor}")]
    InvalidScale {
        /// The factor given.
        factor: f64,
    },
    /// A matrix is not a rotation.
    #[error("the rotation matrix must be orthonormal with determinant 1")]
    InvalidRotation,
    /// The bounds or the size of a rectangle mesh are out of range.
    #[error(
        "rectangle_mesh needs finite bounds (x0, y0, x1, y1) with x0 < x1 and y0 < y1 and a positive size; got {bounds:?} and {size}"
    )]
    InvalidRectangle {
        /// The bounds given.
        bounds: [f64; 4],
        /// The size given.
        size: f64,
    },
    /// A rectangle mesh would have more nodes than an image can measure, or than fit in memory.
    #[error("a mesh of {cells:.3e} cells is too large; choose a larger element size")]
    TooLarge {
        /// Number of cells asked for.
        cells: f64,
    },
}

impl FromStr for CellType {
    type Err = MeshError;

    fn from_str(name: &str) -> Result<Self, MeshError> {
        let found = Self::ALL.into_iter().find(|cell| cell.name() == name);
        found.ok_or_else(|| MeshError::UnknownCellType { name: name.to_owned() })
    }
}

/// Formats a list of indices for a sentence: "cells 3, 5, 8 and 40 more".
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
