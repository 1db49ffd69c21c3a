//! The camera of a mesh drawn in pixels.

use pyo3::prelude::*;

use super::methods::camera_methods;

/// The camera of a mesh drawn in pixels: ``u = X``, ``v = Y``.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct ImageFrame(pub(super) fedic::ImageFrame);

camera_methods!(ImageFrame {
    #[new]
    fn new() -> Self {
        Self(fedic::ImageFrame)
    }

    fn __repr__(&self) -> &'static str {
        "ImageFrame()"
    }
});
