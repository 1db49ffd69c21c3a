//! Lenses of a few coefficients.

use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::distortion::Distortion;
use crate::errors::IntoPyErr;

/// Defines the class of a lens model with its groups of coefficients and their sizes, and the signature of its constructor
/// in Python.
macro_rules! coefficient_lens {
    ($(#[$doc:meta])* $lens:ident($($group:ident: $size:literal),+), $signature:literal) => {
        $(#[$doc])*
        #[pyclass(frozen, extends = Distortion, module = "fedic._core")]
        pub(crate) struct $lens;

        #[pymethods]
        impl $lens {
            #[new]
            #[pyo3(signature = ($($group = [0.0; $size]),+), text_signature = $signature)]
            fn new($($group: [f64; $size]),+) -> PyResult<PyClassInitializer<Self>> {
                let lens = fedic::lens::$lens::new($($group),+).map_err(IntoPyErr::into_py_err)?;
                Ok(PyClassInitializer::from(Distortion(lens.into())).add_subclass(Self))
            }

            $(
                /// Coefficients of this group.
                #[getter]
                fn $group<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
                    slf.as_super().get().group(slf.py(), stringify!($group))
                }
            )+
        }
    };
}

coefficient_lens!(
    /// Brown's lens model: radial, decentering and prismatic distortion (paper, eq. 27-30).
    ///
    /// With ``r2 = x**2 + y**2``, the normalised point ``(x, y)`` is distorted to
    /// ``x + x (k1 r2 + k2 r2**2 + k3 r2**3) + 2 d1 x y + d2 (r2 + 2 x**2) + p1 r2`` and
    /// ``y + y (k1 r2 + k2 r2**2 + k3 r2**3) + d1 (r2 + 2 y**2) + 2 d2 x y + p2 r2``.
    /// In OpenCV's names ``d1 = p1``, ``d2 = p2``, ``p1 = s1``, ``p2 = s3``.
    ///
    /// Parameters
    /// ----------
    /// radial : (k1, k2, k3)
    /// decentering : (d1, d2)
    /// prism : (p1, p2)
    ///
    /// Raises
    /// ------
    /// CameraError
    ///     If a coefficient is not finite.
    BrownDistortion(radial: 3, decentering: 2, prism: 2),
    "(radial=(0.0, 0.0, 0.0), decentering=(0.0, 0.0), prism=(0.0, 0.0))"
);
