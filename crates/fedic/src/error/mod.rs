//! Errors of the correlation and of the specimen calibration; each says where it occurred.
//!
//! May import: options.

use fedic_camera::CameraError;
use fedic_image::ImageError;
use fedic_memory::is_available;
use fedic_mesh::{MeshError, list_indices};
use thiserror::Error;

use crate::error::self_calibration::SelfCalibrationError;
use crate::error::solve::SolveError;
use crate::options::OptionError;

pub(crate) mod self_calibration;
pub(crate) mod solve;

/// Error of a correlation or calibration.
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
    /// The camera cannot be calibrated on the images of the specimen.
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
    /// One camera cannot measure a surface in this position.
    #[error(
        "{}; one camera measures the motion along x and y of a surface that faces z and the camera: turn the mesh, and the camera \
         with it, so that the surface lies about parallel to the (x, y) plane (mesh.rotated)",
        if *vertical { "the surface of the mesh is parallel to the z axis" }
        else { "the camera looks along the surface of the mesh, or along the (x, y) plane" }
    )]
    EdgeOn {
        /// Whether the surface is parallel to the `z` axis.
        vertical: bool,
    },
    /// Cells face away from the camera.
    #[error(
        "{} of {num_cells} cells face away from the camera, which sees the other side of the surface: {}; leave them out, or \
         measure that part in other images", cells.len(), list_indices("cell", cells)
    )]
    HiddenCells {
        /// The cells.
        cells: Vec<usize>,
        /// Number of cells of the mesh.
        num_cells: usize,
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
    /// A mask does not fit the reference image.
    #[error(
        "the mask has {found} pixels; the reference image has {} x {} pixels (columns x rows)", expected[0], expected[1]
    )]
    MaskSize {
        /// Columns and rows of the reference image.
        expected: [usize; 2],
        /// Number of pixels of the mask.
        found: usize,
    },
    /// Masked and saturated points leave nothing to measure.
    #[error(
        "no cell of the mesh has enough points in the reference image that are {}",
        if *masked { "neither masked nor saturated; check the mask (true where a pixel is left out) and the exposure" }
        else { "not saturated; reduce the exposure" }
    )]
    NoUsablePoints {
        /// Whether pixels are masked.
        masked: bool,
    },
    /// The reference image cannot be viewed.
    #[error("the reference image cannot be used: {reason}")]
    ReferenceUnavailable {
        /// The reason given by its source.
        reason: String,
    },
    /// There is not enough memory.
    #[error("{what} needs {:.1} GB of memory, which are not available; {remedy}", *bytes as f64 / 1e9)]
    OutOfMemory {
        /// What needs the memory.
        what: &'static str,
        /// Number of bytes.
        bytes: usize,
        /// What to do.
        remedy: &'static str,
    },
    /// The caller asked to stop.
    #[error("the correlation was cancelled")]
    Cancelled,
}

/// Checks, before an allocation that would end the process if it failed, that there is enough memory.
///
/// # Errors
///
/// [`Error::OutOfMemory`].
pub(crate) fn check_memory(what: &'static str, bytes: usize, remedy: &'static str) -> Result<(), Error> {
    if is_available(bytes) { Ok(()) } else { Err(Error::OutOfMemory { what, bytes, remedy }) }
}
