//! Cameras.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use fedic::{Camera, CameraError, rotation_from_vector, unproject};
use numpy::{PyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{self, matrix, rows, to_array};
use crate::errors::{IntoPyErr, argument_error, camera_error, warn};
use crate::lens::{any_lens, lens_object, lens_repr};
use crate::worker::run;

/// Points per parallel task, at the least.
const GRAIN: usize = 1024;

/// Any of the cameras, for the correlator.
pub(crate) fn any_camera(object: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Camera>> {
    if object.cast::<ImageFrame>().is_ok() {
        Ok(Arc::new(fedic::ImageFrame))
    } else if let Ok(camera) = object.cast::<FrontParallel>() {
        Ok(Arc::new(camera.get().0))
    } else if let Ok(camera) = object.cast::<Pinhole>() {
        Ok(Arc::new(camera.get().0.clone()))
    } else {
        Err(argument_error(format!(
            "camera must be an ImageFrame, a FrontParallel or a Pinhole, got {}",
            arrays::describe(object)
        )))
    }
}

fn project<'py>(
    py: Python<'py>,
    camera: &dyn Camera,
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (points, _) = arrays::points(points, "points", argument_error)?;
    let project = |&point: &[f64; 3]| camera.project(point);
    let pixels = run(py, None, |_| Ok(points.par_iter().with_min_len(GRAIN).map(project).collect::<Vec<_>>()))?;
    warn_of_extrapolation(py, camera, &points)?;
    to_array(py, &pixels)
}

fn jacobian<'py>(
    py: Python<'py>,
    camera: &dyn Camera,
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let (points, _) = arrays::points(points, "points", argument_error)?;
    let jacobian = |&point: &[f64; 3]| camera.project_with_jacobian(point).1;
    let jacobians = run(py, None, |_| Ok(points.par_iter().with_min_len(GRAIN).map(jacobian).collect::<Vec<_>>()))?;
    warn_of_extrapolation(py, camera, &points)?;
    PyArray::from_slice(py, jacobians.as_flattened().as_flattened()).reshape([points.len(), 2, 3])
}

fn unproject_pixels<'py>(
    py: Python<'py>,
    camera: &dyn Camera,
    pixels: &Bound<'py, PyAny>,
    z: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let pixels = rows::<2>(pixels, "pixels", argument_error)?;
    let unproject = |&pixel: &[f64; 2]| unproject(camera, pixel, z);
    let points = run(py, None, |_| Ok(pixels.par_iter().with_min_len(GRAIN).map(unproject).collect::<Vec<_>>()))?;
    let failed = points.iter().filter(|point| point.is_none()).count();
    if let Some(first) = points.iter().position(Option::is_none) {
        let [u, v] = pixels[first];
        return Err(camera_error(format!(
            "{failed} of {} pixels cannot be taken back to the plane Z = {z}, the first of them number {first} at \
             ({u}, {v}): the camera or its lens model does not reach there",
            pixels.len()
        )));
    }
    let points: Vec<[f64; 3]> = points.into_iter().flatten().collect();
    warn_of_extrapolation(py, camera, &points)?;
    to_array(py, &points)
}

fn covers<'py>(
    py: Python<'py>,
    camera: &dyn Camera,
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let (points, _) = arrays::points(points, "points", argument_error)?;
    Ok(PyArray1::from_iter(py, points.iter().map(|&point| camera.covers(point))))
}

/// Warns where the projection of points goes beyond what the lens was calibrated for; points that the camera does not see at
/// all have no projection. The sentence has no numbers in it, so that Python shows it once.
fn warn_of_extrapolation(py: Python<'_>, camera: &dyn Camera, points: &[[f64; 3]]) -> PyResult<()> {
    let extrapolated = |&point: &[f64; 3]| !camera.covers(point) && camera.project(point)[0].is_finite();
    if !camera.is_in_pieces() || !run(py, None, |_| Ok(points.par_iter().with_min_len(GRAIN).any(extrapolated)))? {
        return Ok(());
    }
    warn(
        py,
        "some points lie outside the domain the lens was calibrated in, where it is extrapolated: camera.covers(points) \
         tells which",
    )
}

/// The methods that every camera has.
macro_rules! camera_methods {
    ($type:ident { $($own:item)* }) => {
        #[pymethods]
        impl $type {
            $($own)*

            /// Image points of world points.
            ///
            /// Parameters
            /// ----------
            /// points : (n, 2) or (n, 3) array_like
            ///     World points; ``Z = 0`` where there are two coordinates.
            ///
            /// Returns
            /// -------
            /// (n, 2) float64
            ///     ``(u, v)`` in pixels; NaN where the camera cannot see the point.
            fn project<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
                project(py, &self.0, points)
            }

            /// Derivatives of the image points by the world points.
            ///
            /// Parameters
            /// ----------
            /// points : (n, 2) or (n, 3) array_like
            ///     World points.
            ///
            /// Returns
            /// -------
            /// (n, 2, 3) float64
            ///     ``[i, 0] = du/d(X, Y, Z)``, ``[i, 1] = dv/d(X, Y, Z)`` in pixels per world unit.
            fn jacobian<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray3<f64>>> {
                jacobian(py, &self.0, points)
            }

            /// Whether world points lie where the lens was calibrated; true everywhere but for lenses made of splines.
            ///
            /// Parameters
            /// ----------
            /// points : (n, 2) or (n, 3) array_like
            ///     World points.
            ///
            /// Returns
            /// -------
            /// (n,) bool
            ///     False where a projection is an extrapolation.
            fn covers<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<bool>>> {
                covers(py, &self.0, points)
            }

            /// World points of the plane ``Z = z`` seen at image points, by Newton's method (paper, Sect. 5.2).
            ///
            /// Parameters
            /// ----------
            /// pixels : (n, 2) array_like
            ///     ``(u, v)`` in pixels.
            /// z : float
            ///     The plane.
            ///
            /// Returns
            /// -------
            /// (n, 3) float64
            ///     World points.
            ///
            /// Raises
            /// ------
            /// CameraError
            ///     If a pixel cannot be taken back to the plane.
            #[pyo3(signature = (pixels, z=0.0))]
            fn unproject<'py>(&self, py: Python<'py>, pixels: &Bound<'py, PyAny>, z: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
                unproject_pixels(py, &self.0, pixels, z)
            }
        }
    };
}

/// The mesh drawn in the image itself: ``u = X``, ``v = Y``.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct ImageFrame(fedic::ImageFrame);

camera_methods!(ImageFrame {
    #[new]
    fn new() -> Self {
        Self(fedic::ImageFrame)
    }

    fn __repr__(&self) -> &'static str {
        "ImageFrame()"
    }
});

/// Front-parallel view without distortion: ``u = u0 + k X``, ``v = v0 - k Y`` (paper, eq. 18).
///
/// With an angle ``a`` it is ``u = u0 + k (cos a X - sin a Y)``, ``v = v0 - k (sin a X + cos a Y)``.
///
/// Parameters
/// ----------
/// scale : float
///     ``k``, pixels per world unit.
/// origin : (u0, v0)
///     Image point of the world's origin.
/// angle : float
///     ``a``, by which the world is turned counter-clockwise in the image, in radians.
///
/// Raises
/// ------
/// CameraError
///     If the scale is not positive or a parameter not finite.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct FrontParallel(fedic::FrontParallel);

camera_methods!(FrontParallel {
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

    /// Image point of the world's origin.
    #[getter]
    fn origin(&self) -> (f64, f64) {
        self.0.origin().into()
    }

    /// Angle by which the world is turned counter-clockwise in the image, in radians.
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

/// Pinhole camera with skewed pixels and a distorting lens (paper, Sect. 5.1).
///
/// The camera frame is OpenCV's: ``x`` right, ``y`` down, ``z`` forward, ``X_c = R X_w + t``. A retinal point falls at
/// ``u = fx x + fx cot(theta) y + cx``, ``v = fy / sin(theta) y + cy``.
///
/// Parameters
/// ----------
/// focal : (fx, fy)
///     In pixels.
/// principal_point : (cx, cy)
///     In pixels.
/// rotation : (3,) or (3, 3) array_like, optional
///     Rotation vector (axis times angle in radians) or rotation matrix ``R``; none unless given.
/// translation : (3,)
///     ``t``, in the world unit.
/// skew_angle : float
///     ``theta``, the angle between the pixel axes, in radians.
/// distortion : BrownDistortion, SplineDistortion or InverseSplineDistortion, optional
///     The lens; none unless given.
///
/// Raises
/// ------
/// CameraError
///     If a parameter is not finite or out of its range, or the matrix no rotation.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct Pinhole(pub(crate) fedic::Pinhole);

camera_methods!(Pinhole {
    #[new]
    #[pyo3(
        signature = (
            focal, principal_point, rotation=None, translation=[0.0, 0.0, 0.0], skew_angle=FRAC_PI_2, distortion=None
        ),
        text_signature = "(focal, principal_point, rotation=None, translation=(0.0, 0.0, 0.0), \
                          skew_angle=1.5707963267948966, distortion=None)"
    )]
    fn new(
        focal: [f64; 2],
        principal_point: [f64; 2],
        rotation: Option<&Bound<'_, PyAny>>,
        translation: [f64; 3],
        skew_angle: f64,
        distortion: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let rotation = rotation.map_or(Ok(rotation_from_vector([0.0; 3])), rotation_matrix)?;
        let mut camera = fedic::Pinhole::new(focal, principal_point, rotation, translation)
            .and_then(|camera| camera.with_skew_angle(skew_angle))
            .map_err(IntoPyErr::into_py_err)?;
        if let Some(lens) = distortion {
            camera = camera.with_distortion(any_lens(lens)?);
        }
        Ok(Self(camera))
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

    /// The lens, or None where it does not distort.
    #[getter]
    fn distortion<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.0.distortion().map(|lens| lens_object(py, lens)).transpose()
    }

    #[allow(clippy::type_complexity)]
    fn __getnewargs__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<((f64, f64), (f64, f64), Bound<'py, PyArray2<f64>>, (f64, f64, f64), f64, Option<Bound<'py, PyAny>>)> {
        let (rotation, lens) = (self.rotation(py)?, self.distortion(py)?);
        Ok((self.focal(), self.principal_point(), rotation, self.translation(), self.skew_angle(), lens))
    }

    fn __repr__(&self) -> String {
        let lens = self.0.distortion().map_or_else(|| "None".to_owned(), lens_repr);
        format!(
            "Pinhole(focal={:?}, principal_point={:?}, rotation={:?}, translation={:?}, skew_angle={}, distortion={lens})",
            self.focal(),
            self.principal_point(),
            self.0.rotation(),
            self.translation(),
            self.skew_angle()
        )
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
        camera_error(format!(
            "rotation must be a rotation vector (3,) or a matrix (3, 3), got {}",
            arrays::describe(object)
        ))
    };
    let given = matrix(object, "rotation", camera_error).map_err(|_| refuse())?;
    let view = given.as_array();
    if view.shape() != [3, 3] {
        return Err(refuse());
    }
    Ok(std::array::from_fn(|r| std::array::from_fn(|c| view[[r, c]])))
}
