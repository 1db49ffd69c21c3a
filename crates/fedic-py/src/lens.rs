//! Lenses: the distortion of the retinal plane.

use fedic::{Distortion, SplineField};
use numpy::{AllowTypeChange, PyArray, PyArray2, PyArray3, PyArrayLike3, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{self, rows, to_array};
use crate::errors::{IntoPyErr, argument_error, camera_error};
use crate::worker::run;

type Domain = (f64, f64, f64, f64);

/// Any of the lenses, for a camera.
pub(crate) fn any_lens(object: &Bound<'_, PyAny>) -> PyResult<Distortion> {
    if let Ok(lens) = object.cast::<BrownDistortion>() {
        Ok(lens.get().0.into())
    } else if let Ok(lens) = object.cast::<SplineDistortion>() {
        Ok(lens.get().0.clone().into())
    } else if let Ok(lens) = object.cast::<InverseSplineDistortion>() {
        Ok(lens.get().0.clone().into())
    } else {
        Err(camera_error(format!(
            "distortion must be a BrownDistortion, a SplineDistortion or an InverseSplineDistortion, got {}",
            arrays::describe(object)
        )))
    }
}

/// A lens as Python sees it.
pub(crate) fn lens_object<'py>(py: Python<'py>, lens: &Distortion) -> PyResult<Bound<'py, PyAny>> {
    Ok(match lens {
        Distortion::Brown(lens) => Bound::new(py, BrownDistortion(*lens))?.into_any(),
        Distortion::Spline(lens) => Bound::new(py, SplineDistortion(lens.clone()))?.into_any(),
        Distortion::InverseSpline(lens) => Bound::new(py, InverseSplineDistortion(lens.clone()))?.into_any(),
    })
}

/// A lens in a line.
pub(crate) fn lens_repr(lens: &Distortion) -> String {
    let of_field = |name: &str, field: &SplineField| {
        let ([x0, y0, x1, y1], [nx, ny]) = (field.domain(), field.intervals());
        format!("{name}(domain=({x0}, {y0}, {x1}, {y1}), coefficients=<{} x {} x 2>)", ny + 3, nx + 3)
    };
    match lens {
        Distortion::Brown(lens) => format!(
            "BrownDistortion(radial={:?}, decentering={:?}, prism={:?})",
            <(f64, f64, f64)>::from(lens.radial()),
            <(f64, f64)>::from(lens.decentering()),
            <(f64, f64)>::from(lens.prism())
        ),
        Distortion::Spline(lens) => of_field("SplineDistortion", lens.field()),
        Distortion::InverseSpline(lens) => of_field("InverseSplineDistortion", lens.field()),
    }
}

/// The methods that every lens has.
macro_rules! lens_methods {
    ($type:ident { $($own:item)* }) => {
        #[pymethods]
        impl $type {
            $($own)*

            /// Where the lens shows points of the retinal plane.
            ///
            /// Parameters
            /// ----------
            /// points : (n, 2) array_like
            ///     Retinal points ``(x, y)``, without unit: pixels from the principal point over the focal length.
            ///
            /// Returns
            /// -------
            /// (n, 2) float64
            ///     Distorted retinal points; NaN where it cannot be told.
            fn distort<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
                let (lens, points) = (Distortion::from(self.0.clone()), rows::<2>(points, "points", argument_error)?);
                let seen: Vec<[f64; 2]> = py.detach(|| points.iter().map(|&point| lens.distort(point)).collect());
                to_array(py, &seen)
            }

            /// The retinal points that the lens shows at others.
            ///
            /// Parameters
            /// ----------
            /// points : (n, 2) array_like
            ///     Distorted retinal points.
            ///
            /// Returns
            /// -------
            /// (n, 2) float64
            ///     Retinal points; NaN where there is none, or only beyond a fold of the model.
            fn undistort<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
                let (lens, points) = (Distortion::from(self.0.clone()), rows::<2>(points, "points", argument_error)?);
                let undistort = |&point: &[f64; 2]| lens.undistort(point).unwrap_or([f64::NAN; 2]);
                let found: Vec<[f64; 2]> = py.detach(|| points.iter().map(undistort).collect());
                to_array(py, &found)
            }
        }
    };
}

/// Lens distortion after Brown: radial, decentering and prismatic (paper, eq. 27-30).
///
/// With ``r2 = x**2 + y**2`` the retinal point ``(x, y)`` is seen at
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
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct BrownDistortion(fedic::BrownDistortion);

lens_methods!(BrownDistortion {
    #[new]
    #[pyo3(
        signature = (radial=[0.0, 0.0, 0.0], decentering=[0.0, 0.0], prism=[0.0, 0.0]),
        text_signature = "(radial=(0.0, 0.0, 0.0), decentering=(0.0, 0.0), prism=(0.0, 0.0))"
    )]
    fn new(radial: [f64; 3], decentering: [f64; 2], prism: [f64; 2]) -> PyResult<Self> {
        fedic::BrownDistortion::new(radial, decentering, prism).map(Self).map_err(IntoPyErr::into_py_err)
    }

    /// ``(k1, k2, k3)``.
    #[getter]
    fn radial(&self) -> (f64, f64, f64) {
        self.0.radial().into()
    }

    /// ``(d1, d2)``.
    #[getter]
    fn decentering(&self) -> (f64, f64) {
        self.0.decentering().into()
    }

    /// ``(p1, p2)``.
    #[getter]
    fn prism(&self) -> (f64, f64) {
        self.0.prism().into()
    }

    #[allow(clippy::type_complexity)]
    fn __getnewargs__(&self) -> ((f64, f64, f64), (f64, f64), (f64, f64)) {
        (self.radial(), self.decentering(), self.prism())
    }

    fn __repr__(&self) -> String {
        lens_repr(&self.0.into())
    }
});

/// A lens made of a field: what both have, beside what every lens has.
macro_rules! spline_methods {
    ($type:ident { $($own:item)* }) => {
        lens_methods!($type {
            #[new]
            fn new(domain: [f64; 4], coefficients: &Bound<'_, PyAny>) -> PyResult<Self> {
                spline_field(domain, coefficients).map(|field| Self(fedic::$type::new(field)))
            }

            /// ``(x0, y0, x1, y1)`` on the retinal plane.
            #[getter]
            fn domain(&self) -> Domain {
                self.0.field().domain().into()
            }

            /// Coefficients of the field, (ny + 3, nx + 3, 2) float64.
            #[getter]
            fn coefficients<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
                coefficient_array(py, self.0.field())
            }

            fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<(Domain, Bound<'py, PyArray3<f64>>)> {
                Ok((self.domain(), self.coefficients(py)?))
            }

            fn __repr__(&self) -> String {
                lens_repr(&self.0.clone().into())
            }

            $($own)*
        });
    };
}

/// A field from its domain and its coefficients.
fn spline_field(domain: [f64; 4], coefficients: &Bound<'_, PyAny>) -> PyResult<SplineField> {
    let refuse = || {
        camera_error(format!(
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

/// The rectangle that holds what `map` makes of the border of another lens's domain, or the one given.
fn wanted_domain(
    given: Option<[f64; 4]>,
    lens: &Distortion,
    map: impl Fn([f64; 2]) -> Option<[f64; 2]>,
) -> PyResult<[f64; 4]> {
    const ALONG_A_SIDE: usize = 64;
    if let Some(domain) = given {
        return Ok(domain);
    }
    let Some(field) = lens.field() else {
        return Err(camera_error(
            "domain: a BrownDistortion has none; give (x0, y0, x1, y1) on the retinal plane, such as the borders of the \
             image, less the principal point, over the focal length"
                .to_owned(),
        ));
    };
    let [x0, y0, x1, y1] = field.domain();
    let mut domain = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for k in 0..=ALONG_A_SIDE {
        let part = k as f64 / ALONG_A_SIDE as f64;
        let (x, y) = (x0 + part * (x1 - x0), y0 + part * (y1 - y0));
        for point in [[x, y0], [x, y1], [x0, y], [x1, y]] {
            let [x, y] =
                map(point).ok_or_else(|| camera_error("the lens folds at the border of its domain".to_owned()))?;
            domain = [domain[0].min(x), domain[1].min(y), domain[2].max(x), domain[3].max(y)];
        }
    }
    Ok(domain)
}

/// Non-parametric lens that gives the distortion itself (paper, Fig. 12): a retinal point ``x`` is seen at ``x + S(x)``.
///
/// ``S`` is a tensor-product cubic B-spline on equal intervals of a rectangle of the undistorted retinal plane. Beyond it the
/// lens goes on linearly and is known no more: a camera warns there.
///
/// Parameters
/// ----------
/// domain : (x0, y0, x1, y1)
///     The rectangle, without unit: pixels from the principal point over the focal length.
/// coefficients : (ny + 3, nx + 3, 2) array_like
///     Of ``nx`` intervals along ``x`` and ``ny`` along ``y``, row after row along ``y``; displacements ``(dx, dy)``.
///
/// Raises
/// ------
/// CameraError
///     If the domain is empty, the shape is another or a number is not finite.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct SplineDistortion(fedic::SplineDistortion);

spline_methods!(SplineDistortion {
    /// Make the spline nearest to another lens.
    ///
    /// Parameters
    /// ----------
    /// lens : BrownDistortion, InverseSplineDistortion or SplineDistortion
    ///     The lens to follow.
    /// domain : (x0, y0, x1, y1), optional
    ///     Of the undistorted retinal plane; where not given, what the domain of a spline covers.
    /// tolerance : float
    ///     Largest difference on the retinal plane; times the focal length, in pixels.
    ///
    /// Returns
    /// -------
    /// SplineDistortion
    ///     With as few intervals as the tolerance allows.
    ///
    /// Raises
    /// ------
    /// CameraError
    ///     If the domain is empty or missing, or the lens folds in it or cannot be followed so closely.
    #[staticmethod]
    #[pyo3(signature = (lens, domain=None, tolerance=1e-8))]
    fn from_lens(py: Python<'_>, lens: &Bound<'_, PyAny>, domain: Option<[f64; 4]>, tolerance: f64) -> PyResult<Self> {
        let lens = any_lens(lens)?;
        let domain = wanted_domain(domain, &lens, |point| match &lens {
            Distortion::InverseSpline(lens) => Some(lens.undistort(point)),
            Distortion::Brown(_) | Distortion::Spline(_) => Some(point),
        })?;
        run(py, None, |_| Ok(fedic::SplineDistortion::approximating(&lens, domain, tolerance)?)).map(Self)
    }
});

/// Non-parametric lens that gives the correction (paper, Fig. 13): what is seen at ``x_d`` is the retinal point
/// ``x_d + C(x_d)``.
///
/// ``C`` is a tensor-product cubic B-spline on equal intervals of a rectangle of the distorted retinal plane. Beyond it the
/// lens goes on linearly and is known no more: a camera warns there. Projecting solves for ``x_d`` by Newton's method.
///
/// Parameters
/// ----------
/// domain : (x0, y0, x1, y1)
///     The rectangle, without unit: pixels from the principal point over the focal length.
/// coefficients : (ny + 3, nx + 3, 2) array_like
///     Of ``nx`` intervals along ``x`` and ``ny`` along ``y``, row after row along ``y``; corrections ``(dx, dy)``.
///
/// Raises
/// ------
/// CameraError
///     If the domain is empty, the shape is another or a number is not finite.
#[pyclass(frozen, eq, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct InverseSplineDistortion(fedic::InverseSplineDistortion);

spline_methods!(InverseSplineDistortion {
    /// Make the spline nearest to another lens.
    ///
    /// Parameters
    /// ----------
    /// lens : BrownDistortion, SplineDistortion or InverseSplineDistortion
    ///     The lens to follow.
    /// domain : (x0, y0, x1, y1), optional
    ///     Of the distorted retinal plane; where not given, what the domain of a spline covers.
    /// tolerance : float
    ///     Largest difference of the corrections on the retinal plane; times the focal length, in pixels.
    ///
    /// Returns
    /// -------
    /// InverseSplineDistortion
    ///     With as few intervals as the tolerance allows.
    ///
    /// Raises
    /// ------
    /// CameraError
    ///     If the domain is empty or missing, or the lens does not reach all of it or cannot be followed so closely.
    #[staticmethod]
    #[pyo3(signature = (lens, domain=None, tolerance=1e-8))]
    fn from_lens(py: Python<'_>, lens: &Bound<'_, PyAny>, domain: Option<[f64; 4]>, tolerance: f64) -> PyResult<Self> {
        let lens = any_lens(lens)?;
        let domain = wanted_domain(domain, &lens, |point| match &lens {
            Distortion::Spline(lens) => Some(lens.distort(point)),
            Distortion::Brown(_) | Distortion::InverseSpline(_) => Some(point),
        })?;
        run(py, None, |_| Ok(fedic::InverseSplineDistortion::approximating(&lens, domain, tolerance)?)).map(Self)
    }
});

/// What each coefficient of a spline on a rectangle counts for at points: the products of the cubic basis functions, and their
/// derivatives.
///
/// Parameters
/// ----------
/// domain : (x0, y0, x1, y1)
///     The rectangle.
/// intervals : (nx, ny)
///     Intervals along ``x`` and ``y``.
/// points : (n, 2) array_like
///     Points of the retinal plane.
///
/// Returns
/// -------
/// (3, n, (ny + 3) * (nx + 3)) float64
///     Values, derivatives by ``x`` and by ``y``; one row per point, the coefficients row after row along ``y``.
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
