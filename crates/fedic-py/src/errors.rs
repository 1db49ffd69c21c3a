//! From the core's errors to the exceptions of `fedic.errors`, with the cells, nodes or key at fault.

use fedic::{CameraError, Error, ImageError, MeshError, OptionError, SelfCalibrationError, SolveError};
use fedic_synthetic::SyntheticError;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;

mod python {
    #![allow(missing_docs)]
    pyo3::import_exception!(fedic.errors, MeshError);
    pyo3::import_exception!(fedic.errors, ImageError);
    pyo3::import_exception!(fedic.errors, CameraError);
    pyo3::import_exception!(fedic.errors, OptionError);
    pyo3::import_exception!(fedic.errors, SolveError);
    pyo3::import_exception!(fedic.errors, FedicError);
    pyo3::import_exception!(fedic.errors, CalibrationWarning);
}

/// A Python exception made of a core error.
pub(crate) trait IntoPyErr {
    /// The exception.
    fn into_py_err(self) -> PyErr;
}

impl IntoPyErr for MeshError {
    fn into_py_err(self) -> PyErr {
        let message = self.to_string();
        let (cells, nodes) = match self {
            Self::InvalidScale { .. } => return option_error(message, "factor"),
            Self::InvalidTolerance { .. } => return option_error(message, "tolerance"),
            Self::Line(_) => return option_error(message, "line"),
            Self::InvalidRotation => return option_error(message, "rotation"),
            Self::NonFinitePoint { node } => (vec![], vec![node]),
            Self::NodeOutOfRange { cell, .. } => (vec![cell], vec![]),
            Self::DegenerateCells { cells } | Self::RepeatedNodes { cells } | Self::CollapsedCells { cells, .. } => {
                (cells, vec![])
            }
            _ => (vec![], vec![]),
        };
        python::MeshError::new_err((message, cells, nodes))
    }
}

impl IntoPyErr for ImageError {
    fn into_py_err(self) -> PyErr {
        match &self {
            Self::UnknownInterpolation { .. } => option_error(self.to_string(), "interpolation"),
            Self::InvalidSmoothing { .. } => option_error(self.to_string(), "smoothing"),
            _ => image_error(self.to_string()),
        }
    }
}

impl IntoPyErr for CameraError {
    fn into_py_err(self) -> PyErr {
        match self {
            Self::UnknownParameter { .. } | Self::NotAParameter { .. } => option_error(self.to_string(), "parameters"),
            _ => camera_error(self.to_string()),
        }
    }
}

impl IntoPyErr for OptionError {
    fn into_py_err(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Invalid { option, .. } => option_error(message, option),
            _ => option_error(message, ""),
        }
    }
}

impl IntoPyErr for SolveError {
    fn into_py_err(self) -> PyErr {
        let mut message = self.to_string();
        let nodes = match self {
            Self::InvalidStart { .. } => return option_error(message, "initial"),
            Self::Diverged { nodes, .. } => {
                message += "; initial=\"pyramid\" and initial=\"fft\" start closer";
                nodes
            }
            Self::Singular { nodes, .. } | Self::FlatPart { nodes } | Self::FlatEdge { nodes } => nodes,
            _ => vec![],
        };
        python::SolveError::new_err((message, nodes))
    }
}

impl IntoPyErr for SelfCalibrationError {
    fn into_py_err(self) -> PyErr {
        match &self {
            Self::Images { .. } => option_error(self.to_string(), "images"),
            Self::Parameters { .. } => option_error(self.to_string(), "parameters"),
            _ => python::SolveError::new_err(self.to_string()),
        }
    }
}

impl IntoPyErr for SyntheticError {
    fn into_py_err(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::InvalidOption { option, .. } => option_error(message, option),
            Self::NotVisible { .. } => camera_error(message),
            // The exception that a Python function raised is raised again.
            Self::Displacement(error) => match error.downcast::<PyErr>() {
                Ok(error) => *error,
                Err(_) => option_error(message, "displacement"),
            },
            Self::NotInvertible { .. } => option_error(message, "displacement"),
            Self::InvalidPlane { .. } => option_error(message, "z"),
            Self::TooLarge { .. } => option_error(message, "shape"),
            _ => image_error(message),
        }
    }
}

impl IntoPyErr for Error {
    fn into_py_err(self) -> PyErr {
        let message = self.to_string();
        match self {
            Self::Mesh(error) => error.into_py_err(),
            Self::Image(error) => error.into_py_err(),
            Self::Camera(error) => error.into_py_err(),
            Self::Option(error) => error.into_py_err(),
            Self::Solve(error) => error.into_py_err(),
            Self::SelfCalibration(error) => error.into_py_err(),
            Self::EdgeOn { .. } => mesh_error(message),
            Self::MeshOutsideImage { cells, .. } | Self::HiddenCells { cells, .. } => {
                python::MeshError::new_err((message, cells))
            }
            Self::SizeMismatch { .. } | Self::Flat { .. } | Self::ReferenceUnavailable { .. } => image_error(message),
            Self::MaskSize { .. } | Self::NoUsablePoints { masked: true } => option_error(message, "mask"),
            Self::NoUsablePoints { masked: false } => image_error(message),
            Self::Cancelled => PyKeyboardInterrupt::new_err(message),
            _ => internal_error(message),
        }
    }
}

/// A `MeshError` without cells or nodes.
pub(crate) fn mesh_error(message: String) -> PyErr {
    python::MeshError::new_err(message)
}

/// An `ImageError`.
pub(crate) fn image_error(message: String) -> PyErr {
    python::ImageError::new_err(message)
}

/// A `CameraError`.
pub(crate) fn camera_error(message: String) -> PyErr {
    python::CameraError::new_err(message)
}

/// An `OptionError` for the argument `option`.
pub(crate) fn option_error(message: String, option: &str) -> PyErr {
    python::OptionError::new_err((message, option.to_owned()))
}

/// An `OptionError` for an argument that its message names.
pub(crate) fn argument_error(message: String) -> PyErr {
    let option = message.split_whitespace().next().unwrap_or_default().to_owned();
    option_error(message, &option)
}

/// The base class: for faults of fedic itself.
pub(crate) fn internal_error(message: String) -> PyErr {
    python::FedicError::new_err(message)
}

/// A `CalibrationWarning` at the line that called fedic.
pub(crate) fn warn(py: Python<'_>, message: &str) -> PyResult<()> {
    let category = py.get_type::<python::CalibrationWarning>();
    PyErr::warn(py, &category, &std::ffi::CString::new(message)?, 1)
}
