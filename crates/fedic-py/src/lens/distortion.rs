//! The base class of the lenses.

use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{self, rows, to_array};
use crate::errors::argument_error;

/// Distortion of a lens in normalised image coordinates; the base class of all lens models.
///
/// Normalised image coordinates ``(x, y)`` are dimensionless: pixels from the principal point, divided by the focal length.
#[pyclass(frozen, eq, subclass, module = "fedic._core")]
#[derive(PartialEq)]
pub(crate) struct Distortion(pub(crate) fedic::Distortion);

#[pymethods]
impl Distortion {
    /// Name of the lens model, such as ``"brown"``.
    #[getter]
    fn model(&self) -> &'static str {
        self.0.model()
    }

    /// Coefficients of the lens by name; empty for a lens made of a field.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parameters = PyDict::new(py);
        for (name, value) in self.0.coefficient_names().zip(self.0.coefficients()) {
            parameters.set_item(name, value)?;
        }
        Ok(parameters)
    }

    /// Distort points.
    ///
    /// Parameters
    /// ----------
    /// points : (n, 2) array_like
    ///     Normalised image coordinates ``(x, y)``.
    ///
    /// Returns
    /// -------
    /// (n, 2) float64
    ///     Distorted points; NaN if they do not exist.
    fn distort<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = rows::<2>(points, "points", argument_error)?;
        let distorted: Vec<[f64; 2]> = py.detach(|| points.iter().map(|&point| self.0.distort(point)).collect());
        to_array(py, &distorted)
    }

    /// Find the points that are distorted to given points.
    ///
    /// Parameters
    /// ----------
    /// points : (n, 2) array_like
    ///     Distorted points.
    ///
    /// Returns
    /// -------
    /// (n, 2) float64
    ///     Normalised image coordinates; NaN if there is no such point, or only beyond a fold of the model.
    fn undistort<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = rows::<2>(points, "points", argument_error)?;
        let undistort = |&point: &[f64; 2]| self.0.undistort(point).unwrap_or([f64::NAN; 2]);
        let found: Vec<[f64; 2]> = py.detach(|| points.iter().map(undistort).collect());
        to_array(py, &found)
    }

    fn __getnewargs__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let groups = self.0.groups().iter().map(|group| self.group(py, group.name));
        PyTuple::new(py, groups.collect::<PyResult<Vec<_>>>()?)
    }

    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        let (py, lens) = (slf.py(), slf.get());
        let group = |name: &str| Ok(format!("{name}={}", lens.group(py, name)?.repr()?));
        let groups = lens.0.groups().iter().map(|summary| group(summary.name)).collect::<PyResult<Vec<_>>>()?;
        Ok(format!("{}({})", slf.get_type().name()?, groups.join(", ")))
    }
}

impl Distortion {
    /// Coefficients of a group.
    pub(super) fn group<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyTuple>> {
        let groups = self.0.groups();
        let start: usize =
            groups.iter().take_while(|group| group.name != name).map(|group| group.coefficients.len()).sum();
        let size = groups.iter().find(|group| group.name == name).map_or(0, |group| group.coefficients.len());
        PyTuple::new(py, self.0.coefficients().iter().skip(start).take(size))
    }
}

/// A lens of any model, from the argument of this name.
pub(crate) fn any_lens(object: &Bound<'_, PyAny>, name: &str) -> PyResult<fedic::Distortion> {
    match object.cast::<Distortion>() {
        Ok(lens) => Ok(lens.get().0.clone()),
        Err(_) => Err(argument_error(format!(
            "{name} must be a Distortion, such as BrownDistortion, got {}",
            arrays::describe(object)
        ))),
    }
}
