//! The fronto-parallel view.

use pyo3::prelude::*;

use super::methods::{camera_methods, parametric_camera_methods};
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
///
/// Raises
/// ------
/// CameraError
///     If the scale is not positive or a parameter is not finite.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct FrontParallel(pub(super) fedic::FrontParallel);

parametric_camera_methods!(FrontParallel {
    #[new]
    #[pyo3(
        signature = (scale, origin=[0.0, 0.0], angle=0.0),
        text_signature = "(scale, origin=(0.0, 0.0), angle=0.0)"
    )]
    fn new(scale: f64, origin: [f64; 2], angle: f64) -> PyResult<Self> {
        let upright = fedic::FrontParallel::new(scale, origin);
        upright.and_then(|camera| camera.with_angle(angle)).map(Self).map_err(IntoPyErr::into_py_err)
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

    fn __getnewargs__(&self) -> (f64, (f64, f64), f64) {
        (self.scale(), self.origin(), self.angle())
    }

    fn __repr__(&self) -> String {
        format!("FrontParallel(scale={}, origin={:?}, angle={})", self.scale(), self.origin(), self.angle())
    }
});
