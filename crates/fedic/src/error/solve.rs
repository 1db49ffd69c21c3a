//! Errors of the solution of the system.

use fedic_mesh::list_indices;
use thiserror::Error;

/// Error of the solution of the system.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SolveError {
    /// No cell has enough points in the deformed image.
    #[error(
        "no cell has enough points left in the deformed image that are neither outside it nor saturated: the start is too far \
         off, the specimen has left the view, or the image is overexposed; try another initial displacement"
    )]
    LeftView,
    /// The starting displacement does not have one finite entry per used node.
    #[error("the initial displacement must have one finite value per component and node ({expected} nodes): {found}")]
    InvalidStart {
        /// Number of nodes of the mesh.
        expected: usize,
        /// What was found instead.
        found: String,
    },
    /// The grey levels do not determine the displacement of some nodes.
    #[error(
        "the images do not determine the displacement of {}: the poorest cell there holds {points} quadrature points for \
         {unknowns} unknowns; use larger elements, a texture with more contrast there, or a regularization length",
        list_indices("node", nodes)
    )]
    Singular {
        /// Nodes whose displacement is not determined.
        nodes: Vec<usize>,
        /// Fewest quadrature points in a cell that touches them.
        points: usize,
        /// Unknowns of that cell.
        unknowns: usize,
    },
    /// A part of the mesh has no texture at all, from which a regularization could continue the displacement.
    #[error(
        "the images do not determine the displacement of {}: no cell of that part of the mesh has a texture, and a \
         regularization continues the displacement across the edges of cells alone; leave the part out of the mesh",
        list_indices("node", nodes)
    )]
    FlatPart {
        /// Nodes of such parts.
        nodes: Vec<usize>,
    },
    /// Nodes of an edge that is not free have no texture.
    #[error(
        "the images do not determine the displacement of {}: no cell there has a texture, and the equilibrium gap continues the \
         displacement to nodes inside the mesh and at free edges alone; name the edge as free, if no load acts on it, or leave \
         these cells out of the mesh",
        list_indices("node", nodes)
    )]
    FlatEdge {
        /// Nodes whose displacement is not determined.
        nodes: Vec<usize>,
    },
    /// The images do not determine the parameters of a reduced basis.
    #[error("the images do not determine the {parameters} parameters of the displacement field")]
    UndeterminedParameters {
        /// Number of parameters.
        parameters: usize,
    },
    /// The factorisation does not fit in memory.
    #[error("the factorisation of the system of {dofs} unknowns does not fit in memory")]
    TooLarge {
        /// Number of unknowns.
        dofs: usize,
    },
    /// The quadrature points do not fit in memory.
    #[error("{points} quadrature points do not fit in memory; lower the density")]
    TooManyPoints {
        /// Number of points asked for.
        points: usize,
    },
    /// The corrections grow without bound.
    #[error(
        "the correlation diverged at iteration {iteration}: {} by {correction:.3e} pixels in one step; start closer to the \
         solution, use larger elements or a regularization length",
        if nodes.len() == 1 { format!("node {} moved", nodes[0]) } else { format!("{} moved", list_indices("node", nodes)) }
    )]
    Diverged {
        /// Iteration at which it was seen.
        iteration: usize,
        /// Nodes that moved out of all proportion.
        nodes: Vec<usize>,
        /// Largest correction in pixels.
        correction: f64,
    },
}
