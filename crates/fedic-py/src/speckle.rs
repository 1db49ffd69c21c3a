//! The synthetic texture.

use numpy::PyArray1;
use pyo3::prelude::*;

use crate::arrays;
use crate::errors::{IntoPyErr, argument_error};
use crate::worker::run;

/// A continuous speckle of the physical plane, known at any point.
///
/// Dark spots of random place, size and darkness on a white ground, one per square of a regular grid; twice continuously
/// differentiable.
///
/// Parameters
/// ----------
/// size : float
///     Mean diameter of the spots, in the unit of the plane.
/// coverage : float
///     Fraction of the ground that is dark, 0.1 to 0.7.
/// seed : int
///     The same seed gives the same speckle.
///
/// Raises
/// ------
/// OptionError
///     If a parameter is out of its range.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct Speckle(fedic_synthetic::Speckle);

#[pymethods]
impl Speckle {
    #[new]
    #[pyo3(signature = (size, *, coverage=0.5, seed=0))]
    fn new(size: f64, coverage: f64, seed: u64) -> PyResult<Self> {
        fedic_synthetic::Speckle::new(size, coverage, seed).map(Self).map_err(IntoPyErr::into_py_err)
    }

    /// Mean diameter of the spots.
    #[getter]
    fn size(&self) -> f64 {
        self.0.size()
    }

    /// Fraction of the ground that is dark.
    #[getter]
    fn coverage(&self) -> f64 {
        self.0.coverage()
    }

    /// Seed of the random places.
    #[getter]
    fn seed(&self) -> u64 {
        self.0.seed()
    }

    /// Grey levels at points of the plane.
    ///
    /// Parameters
    /// ----------
    /// points : (n, 2) or (n, 3) array_like
    ///     The third coordinate is ignored.
    ///
    /// Returns
    /// -------
    /// (n,) float64
    ///     From 0, black, to 1, the white of the ground.
    fn values<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let points = arrays::plane_points(points, "points", argument_error)?;
        let values = run(py, None, |_| Ok(self.0.values(&points)))?;
        Ok(PyArray1::from_vec(py, values))
    }

    fn __repr__(&self) -> String {
        format!("Speckle(size={}, coverage={}, seed={})", self.0.size(), self.0.coverage(), self.0.seed())
    }
}
