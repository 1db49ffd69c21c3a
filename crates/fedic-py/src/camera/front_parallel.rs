//! The fronto-parallel view.

use pyo3::prelude::*;

use super::methods::{camera_methods, parametric_camera_methods};
use super::resizing::{size_argument, with_image_size};
use crate::errors::IntoPyErr;

/// Fronto-parallel view without distortion: ``u = u0 + k X``, ``v = v0 - k Y`` (paper, eq. 18).
///
/// With an angle ``a`` it is ``u = u0 + k (cos a X - sin a Y)``, ``v = v0 - k (sin a X + cos a Y)``.
///
/// Parameters
/// ----------
/// scale : float
///     ``k``, pixels per world unit.
/// origin : (u0, v0)
///     Image point of the world origin.
/// angle : float
///     ``a``, by which the world is rotated counter-clockwise in the image, in radians.
/// image_size : (int, int), optional
///     Width and height of the images, in pixels; images of another size are then refused.
///
/// Raises
/// ------
/// CameraError
///     If the scale is not positive, a parameter is not finite, or the size is zero.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct FrontParallel(pub(super) fedic::FrontParallel);

parametric_camera_methods!(FrontParallel {
    #[new]
    #[pyo3(
        signature = (scale, origin=[0.0, 0.0], angle=0.0, image_size=None),
        text_signature = "(scale, origin=(0.0, 0.0), angle=0.0, image_size=None)"
    )]
    fn new(scale: f64, origin: [f64; 2], angle: f64, image_size: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let upright = fedic::FrontParallel::new(scale, origin);
        let camera = upright.and_then(|camera| camera.with_angle(angle)).map_err(IntoPyErr::into_py_err)?;
        with_image_size(camera, image_size).map(Self)
    }

    /// Pixels per world unit.
    #[getter]
    fn scale(&self) -> f64 {
        self.0.scale()
    }

    /// Image point of the world origin.
    #[getter]
    fn origin(&self) -> (f64, f64) {
        self.0.origin().into()
    }

    /// Angle by which the world is rotated counter-clockwise in the image, in radians.
    #[getter]
    fn angle(&self) -> f64 {
        self.0.angle()
    }

    #[allow(clippy::type_complexity)]
    fn __getnewargs__(&self) -> (f64, (f64, f64), f64, Option<(u32, u32)>) {
        (self.scale(), self.origin(), self.angle(), self.image_size())
    }

    fn __repr__(&self) -> String {
        let (scale, origin, angle, size) = (self.scale(), self.origin(), self.angle(), size_argument(&self.0));
        format!("FrontParallel(scale={scale}, origin={origin:?}, angle={angle}{size})")
    }
});
