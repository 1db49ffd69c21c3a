//! The pinhole camera.

use std::f64::consts::FRAC_PI_2;

use fedic::{CameraError, rotation_from_vector};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use super::methods::{camera_methods, parametric_camera_methods};
use super::resizing::{size_argument, with_image_size};
use crate::arrays::{self, matrix, to_array};
use crate::errors::{IntoPyErr, argument_error};
use crate::lens::{any_lens, lens_object};

/// Pinhole camera with skewed pixels and lens distortion (paper, Sect. 5.1).
///
/// The camera frame is OpenCV's: ``x`` right, ``y`` down, ``z`` forward, ``X_c = R X_w + t``. The pixel of a distorted
/// point ``(x, y)``, in normalised image coordinates, is ``u = fx x + fx cot(theta) y + cx``,
/// ``v = fy / sin(theta) y + cy``.
///
/// Parameters
/// ----------
/// focal : (fx, fy)
///     In pixels.
/// principal_point : (cx, cy)
///     In pixels.
/// rotation : (3,) or (3, 3) array_like, optional
///     Rotation vector (axis times angle in radians) or rotation matrix ``R``; the identity by default.
/// translation : (3,)
///     ``t``, in the world unit.
/// skew_angle : float
///     ``theta``, the angle between the pixel axes, in radians.
/// distortion : Distortion, optional
///     The lens distortion; none by default.
/// image_size : (int, int), optional
///     Width and height of the images the camera was calibrated on, in pixels; images of another size are then refused.
///
/// Raises
/// ------
/// CameraError
///     If a parameter is not finite or out of range, the matrix is not a rotation, or the size is zero.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct Pinhole(pub(crate) fedic::Pinhole);

parametric_camera_methods!(Pinhole {
    #[new]
    #[pyo3(
        signature = (
            focal, principal_point, rotation=None, translation=[0.0, 0.0, 0.0], skew_angle=FRAC_PI_2, distortion=None,
            image_size=None
        ),
        text_signature = "(focal, principal_point, rotation=None, translation=(0.0, 0.0, 0.0), \
                          skew_angle=1.5707963267948966, distortion=None, image_size=None)"
    )]
    fn new(
        focal: [f64; 2],
        principal_point: [f64; 2],
        rotation: Option<&Bound<'_, PyAny>>,
        translation: [f64; 3],
        skew_angle: f64,
        distortion: Option<&Bound<'_, PyAny>>,
        image_size: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let rotation = rotation.map_or(Ok(rotation_from_vector([0.0; 3])), rotation_matrix)?;
        let mut camera = fedic::Pinhole::new(focal, principal_point, rotation, translation)
            .and_then(|camera| camera.with_skew_angle(skew_angle))
            .map_err(IntoPyErr::into_py_err)?;
        if let Some(lens) = distortion {
            camera = camera.with_distortion(any_lens(lens, "distortion")?);
        }
        with_image_size(camera, image_size).map(Self)
    }

    /// Focal lengths ``(fx, fy)`` in pixels.
    #[getter]
    fn focal(&self) -> (f64, f64) {
        self.0.focal().into()
    }

    /// Principal point ``(cx, cy)`` in pixels.
    #[getter]
    fn principal_point(&self) -> (f64, f64) {
        self.0.principal_point().into()
    }

    /// Rotation matrix, (3, 3) float64.
    #[getter]
    fn rotation<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &self.0.rotation())
    }

    /// Translation, in the world unit.
    #[getter]
    fn translation(&self) -> (f64, f64, f64) {
        self.0.translation().into()
    }

    /// Angle between the pixel axes, in radians.
    #[getter]
    fn skew_angle(&self) -> f64 {
        self.0.skew_angle()
    }

    /// The lens distortion, or None.
    #[getter]
    fn distortion<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.0.distortion().map(|lens| lens_object(py, lens)).transpose()
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let (rotation, lens) = (self.rotation(py)?, self.distortion(py)?);
        (self.focal(), self.principal_point(), rotation, self.translation(), self.skew_angle(), lens, self.image_size())
            .into_pyobject(py)
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let lens = match self.distortion(py)? {
            Some(lens) => lens.repr()?.to_string(),
            None => "None".to_owned(),
        };
        Ok(format!(
            "Pinhole(focal={:?}, principal_point={:?}, rotation={:?}, translation={:?}, skew_angle={}, \
             distortion={lens}{})",
            self.focal(),
            self.principal_point(),
            self.0.rotation(),
            self.translation(),
            self.skew_angle(),
            size_argument(&self.0)
        ))
    }
});

/// A rotation matrix from a rotation vector or a matrix.
fn rotation_matrix(object: &Bound<'_, PyAny>) -> PyResult<[[f64; 3]; 3]> {
    if let Ok(vector) = object.extract::<[f64; 3]>() {
        if !vector.iter().all(|c| c.is_finite()) {
            return Err(CameraError::NonFinite { parameter: "rotation" }.into_py_err());
        }
        return Ok(rotation_from_vector(vector));
    }
    let refuse = || {
        argument_error(format!(
            "rotation must be a rotation vector (3,) or a matrix (3, 3), got {}",
            arrays::describe(object)
        ))
    };
    let given = matrix(object, "rotation", argument_error).map_err(|_| refuse())?;
    let view = given.as_array();
    if view.shape() != [3, 3] {
        return Err(refuse());
    }
    Ok(std::array::from_fn(|r| std::array::from_fn(|c| view[[r, c]])))
}
