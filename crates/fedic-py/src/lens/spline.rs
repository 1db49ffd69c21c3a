//! Lenses made of a spline field.

use fedic::lens::{LensVisitor, Plane};
use fedic::{CameraError, Lens, SplineField};
use numpy::{AllowTypeChange, PyArray, PyArray3, PyArrayLike3, PyArrayMethods};
use pyo3::prelude::*;

use super::distortion::{Distortion, any_lens};
use crate::arrays::{self, rows};
use crate::errors::{IntoPyErr, argument_error, internal_error};
use crate::worker::run;

type Rectangle = (f64, f64, f64, f64);

/// Defines the class of a lens made of a field whose domain lies in the given plane.
macro_rules! spline_lens {
    ($(#[$doc:meta])* $lens:ident, $plane:ident) => {
        $(#[$doc])*
        #[pyclass(frozen, extends = Distortion, module = "fedic._core")]
        pub(crate) struct $lens;

        #[pymethods]
        impl $lens {
            #[new]
            fn new(domain: [f64; 4], coefficients: &Bound<'_, PyAny>) -> PyResult<PyClassInitializer<Self>> {
                let lens = fedic::lens::$lens::new(spline_field(domain, coefficients)?);
                Ok(PyClassInitializer::from(Distortion(lens.into())).add_subclass(Self))
            }

            /// Domain ``(x0, y0, x1, y1)`` of the field, in normalised image coordinates.
            #[getter]
            fn domain(slf: &Bound<'_, Self>) -> PyResult<Rectangle> {
                Ok(field_of(slf.as_super())?.domain().into())
            }

            /// Coefficients of the field, (ny + 3, nx + 3, 2) float64.
            #[getter]
            fn coefficients<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray3<f64>>> {
                coefficient_array(slf.py(), field_of(slf.as_super())?)
            }

            fn __getnewargs__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Rectangle, Bound<'py, PyArray3<f64>>)> {
                Ok((Self::domain(slf)?, Self::coefficients(slf)?))
            }

            fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
                let field = field_of(slf.as_super())?;
                let ([x0, y0, x1, y1], [nx, ny]) = (field.domain(), field.intervals());
                let name = stringify!($lens);
                Ok(format!("{name}(domain=({x0}, {y0}, {x1}, {y1}), coefficients=<{} x {} x 2>)", ny + 3, nx + 3))
            }

            /// Approximate another lens.
            ///
            /// Parameters
            /// ----------
            /// lens : Distortion
            ///     The lens to approximate.
            /// domain : (x0, y0, x1, y1), optional
            ///     Domain of the field; by default, the bounding box of the lens's own domain, if it has one.
            /// tolerance : float
            ///     Largest difference of the fields in normalised image coordinates; times the focal length, in pixels.
            ///
            /// Returns
            /// -------
            #[doc = stringify!($lens)]
            ///     With the fewest intervals that reach the tolerance.
            ///
            /// Raises
            /// ------
            /// CameraError
            ///     If the domain is empty or missing, the lens does not reach all of it, or the tolerance cannot be
            ///     reached.
            #[staticmethod]
            #[pyo3(signature = (lens, domain=None, tolerance=1e-8))]
            fn from_lens(
                py: Python<'_>,
                lens: &Bound<'_, PyAny>,
                domain: Option<[f64; 4]>,
                tolerance: f64,
            ) -> PyResult<Py<Self>> {
                struct Approximate {
                    domain: [f64; 4],
                    tolerance: f64,
                }

                impl LensVisitor for Approximate {
                    type Output = Result<fedic::lens::$lens, CameraError>;

                    fn visit(self, lens: &impl Lens) -> Self::Output {
                        fedic::lens::$lens::from_lens(lens, self.domain, self.tolerance)
                    }
                }

                let lens = any_lens(lens, "lens")?;
                let domain = match domain {
                    Some(domain) => domain,
                    None => lens.bounding_box(Plane::$plane).map_err(IntoPyErr::into_py_err)?,
                };
                let spline = run(py, None, |_| Ok(lens.visit(Approximate { domain, tolerance })?))?;
                Py::new(py, PyClassInitializer::from(Distortion(spline.into())).add_subclass(Self))
            }
        }
    };
}

spline_lens!(
    /// Non-parametric lens model of the distortion (paper, Fig. 12): the normalised point ``x`` is distorted to ``x + S(x)``.
    ///
    /// ``S`` is a tensor-product cubic B-spline on equal intervals of a rectangle of undistorted coordinates. Beyond it the
    /// lens is extrapolated linearly, and a camera warns.
    ///
    /// Parameters
    /// ----------
    /// domain : (x0, y0, x1, y1)
    ///     The rectangle, in normalised image coordinates.
    /// coefficients : (ny + 3, nx + 3, 2) array_like
    ///     Displacements ``(dx, dy)`` for ``nx`` intervals along ``x`` and ``ny`` along ``y``, row by row along ``y``.
    ///
    /// Raises
    /// ------
    /// CameraError
    ///     If the domain is empty, the shape is wrong or a number is not finite.
    SplineDistortion,
    Undistorted
);

spline_lens!(
    /// Non-parametric lens model of the correction (paper, Fig. 13): the distorted point ``x_d`` is corrected to
    /// ``x_d + C(x_d)``.
    ///
    /// ``C`` is a tensor-product cubic B-spline on equal intervals of a rectangle of distorted coordinates. Beyond it the lens
    /// is extrapolated linearly, and a camera warns. Projecting solves for ``x_d`` by Newton's method.
    ///
    /// Parameters
    /// ----------
    /// domain : (x0, y0, x1, y1)
    ///     The rectangle, in distorted normalised image coordinates.
    /// coefficients : (ny + 3, nx + 3, 2) array_like
    ///     Corrections ``(dx, dy)`` for ``nx`` intervals along ``x`` and ``ny`` along ``y``, row by row along ``y``.
    ///
    /// Raises
    /// ------
    /// CameraError
    ///     If the domain is empty, the shape is wrong or a number is not finite.
    InverseSplineDistortion,
    Distorted
);

/// The field of a lens that is made of one.
fn field_of<'a>(lens: &'a Bound<'_, Distortion>) -> PyResult<&'a SplineField> {
    lens.get().0.field().ok_or_else(|| internal_error("a spline lens has no field".to_owned()))
}

/// A field from its domain and coefficients.
fn spline_field(domain: [f64; 4], coefficients: &Bound<'_, PyAny>) -> PyResult<SplineField> {
    let refuse = || {
        argument_error(format!(
            "coefficients must be an array (ny + 3, nx + 3, 2) of real numbers for nx x ny intervals, got {}",
            arrays::describe(coefficients)
        ))
    };
    let array: PyArrayLike3<'_, f64, AllowTypeChange> = coefficients.extract().map_err(|_| refuse())?;
    let view = array.as_array();
    let [height, width, 2] = *view.shape() else { return Err(refuse()) };
    if height < 4 || width < 4 {
        return Err(refuse());
    }
    let numbers: Vec<f64> = view.iter().copied().collect();
    SplineField::new(domain, [width - 3, height - 3], numbers.as_chunks().0.to_vec()).map_err(IntoPyErr::into_py_err)
}

fn coefficient_array<'py>(py: Python<'py>, field: &SplineField) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let [width, height] = field.intervals().map(|intervals| intervals + 3);
    PyArray::from_slice(py, field.coefficients().as_flattened()).reshape([height, width, 2])
}

/// Basis functions of a tensor-product cubic B-spline at points, and their derivatives.
///
/// Parameters
/// ----------
/// domain : (x0, y0, x1, y1)
///     The rectangle.
/// intervals : (nx, ny)
///     Intervals along ``x`` and ``y``.
/// points : (n, 2) array_like
///     Points at which to evaluate.
///
/// Returns
/// -------
/// (3, n, (ny + 3) * (nx + 3)) float64
///     Values, derivatives by ``x`` and by ``y``; one row per point, the coefficients row by row along ``y``.
///
/// Raises
/// ------
/// CameraError
///     If the domain is empty or there is no interval.
#[pyfunction]
pub(crate) fn spline_basis<'py>(
    py: Python<'py>,
    domain: [f64; 4],
    intervals: [usize; 2],
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let points = rows::<2>(points, "points", argument_error)?;
    let width = intervals.iter().map(|count| count + 3).product();
    let field = SplineField::new(domain, intervals, vec![[0.0; 2]; width]).map_err(IntoPyErr::into_py_err)?;
    let mut entries = vec![0.0; 3 * points.len() * width];
    let (values, slopes) = entries.split_at_mut(points.len() * width);
    let (by_x, by_y) = slopes.split_at_mut(points.len() * width);
    let rows = values.chunks_exact_mut(width).zip(by_x.chunks_exact_mut(width)).zip(by_y.chunks_exact_mut(width));
    for (((value, by_x), by_y), &point) in rows.zip(&points) {
        field.add_basis(point, [value, by_x, by_y]);
    }
    PyArray::from_vec(py, entries).reshape([3, points.len(), width])
}
