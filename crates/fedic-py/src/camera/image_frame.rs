//! The camera of a mesh drawn in pixels.

use pyo3::prelude::*;

use super::methods::camera_methods;
use super::resizing::{size_argument, with_image_size};
use crate::errors::IntoPyErr;

/// The camera of a mesh drawn in the pixels of an image: ``u = X``, ``v = Y``.
///
/// Of a region or a reduction of that image it is ``u = u0 + k X``, ``v = v0 + k Y``; see `cropped` and `binned`.
///
/// Parameters
/// ----------
/// origin : (u0, v0)
///     Image point of the origin of the drawing.
/// scale : float
///     ``k``, pixels per pixel of the drawing.
/// image_size : (int, int), optional
///     Width and height of the images, in pixels; images of another size are then refused.
///
/// Raises
/// ------
/// CameraError
///     If the scale is not positive, a parameter is not finite, or the size is zero.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct ImageFrame(pub(super) fedic::ImageFrame);

camera_methods!(ImageFrame {
    #[new]
    #[pyo3(
        signature = (origin=[0.0, 0.0], scale=1.0, image_size=None),
        text_signature = "(origin=(0.0, 0.0), scale=1.0, image_size=None)"
    )]
    fn new(origin: [f64; 2], scale: f64, image_size: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let camera = fedic::ImageFrame::new(scale, origin).map_err(IntoPyErr::into_py_err)?;
        with_image_size(camera, image_size).map(Self)
    }

    /// Image point of the origin of the drawing.
    #[getter]
    fn origin(&self) -> (f64, f64) {
        self.0.origin().into()
    }

    /// Pixels per pixel of the drawing.
    #[getter]
    fn scale(&self) -> f64 {
        self.0.scale()
    }

    #[allow(clippy::type_complexity)]
    fn __getnewargs__(&self) -> ((f64, f64), f64, Option<(u32, u32)>) {
        (self.origin(), self.scale(), self.image_size())
    }

    fn __repr__(&self) -> String {
        if self.0 == fedic::ImageFrame {
            return "ImageFrame()".to_owned();
        }
        let (origin, scale, size) = (self.origin(), self.scale(), size_argument(&self.0));
        format!("ImageFrame(origin={origin:?}, scale={scale}{size})")
    }
});
