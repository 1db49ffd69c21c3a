//! Everything that can go wrong in a correlation, each with where it went wrong.

use fedic_camera::CameraError;
use fedic_image::ImageError;
use fedic_mesh::{MeshError, list_indices};
use thiserror::Error;

use crate::error::self_calibration::SelfCalibrationError;
use crate::options::OptionError;

pub(crate) mod self_calibration;

/// Why a correlation could not be prepared or solved.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// The mesh is at fault.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// An image is at fault.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// The camera is at fault.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// An option has a value that it cannot take.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The problem has no solution.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The images of a specimen do not give the camera.
    #[error(transparent)]
    SelfCalibration(#[from] SelfCalibrationError),
    /// The mesh does not project into the reference image.
    #[error(
        "{} outside the reference image of {width} x {height} pixels, as this camera sees it: {}; check the camera, the \
         mesh's unit and its position",
        if cells.len() == *num_cells { "the whole mesh lies".to_owned() }
        else { format!("{} of {num_cells} cells lie at least partly", cells.len()) },
        list_indices("cell", cells)
    )]
    MeshOutsideImage {
        /// Cells with at least one quadrature point outside.
        cells: Vec<usize>,
        /// Number of cells of the mesh.
        num_cells: usize,
        /// Columns of the image.
        width: usize,
        /// Rows of the image.
        height: usize,
    },
    /// The two images differ in size.
    #[error(
        "the reference image has {} x {} pixels (columns x rows), the deformed one {} x {}; both must come from the same camera",
        reference[0], reference[1], deformed[0], deformed[1]
    )]
    SizeMismatch {
        /// Columns and rows of the reference image.
        reference: [usize; 2],
        /// Columns and rows of the deformed image.
        deformed: [usize; 2],
    },
    /// The grey levels under the mesh are all the same.
    #[error(
        "the {which} image is flat where the mesh lies: its grey levels have a standard deviation of {std:.2e}; nothing can be measured without a texture"
    )]
    Flat {
        /// `reference` or `deformed`.
        which: &'static str,
        /// Standard deviation of the grey levels at the quadrature points.
        std: f64,
    },
    /// The reference image is needed again and cannot be viewed.
    #[error("the reference image cannot be read again: {reason}")]
    ReferenceUnavailable {
        /// The reason given by its source.
        reason: String,
    },
    /// The caller asked to stop.
    #[error("the correlation was cancelled")]
    Cancelled,
}

/// Why the system could not be solved.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SolveError {
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
