//! The covariance of the displacement.

use numpy::{PyArray, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{rows, to_array};
use crate::errors::argument_error;
use crate::mesh::any_mesh;
use crate::strains;
use crate::worker::{SHARED, run_briefly, run_on};

/// Covariance of the displacement due to the noise of the images; see `fedic.Covariance`.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct Covariance {
    inner: fedic::Covariance,
}

impl Covariance {
    pub(crate) fn new(inner: fedic::Covariance) -> Self {
        Self { inner }
    }
}

#[pymethods]
impl Covariance {
    /// Covariance of the displacement of each node, (n, 2, 2) float64; NaN at nodes that no point determines.
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        blocks(py, &run_briefly(py, &SHARED, || self.inner.blocks())?)
    }

    /// The same covariance of the nodes for the strains of a total displacement, (n, 2), of the same cells on other points.
    fn of_total(
        &self,
        py: Python<'_>,
        mesh: &Bound<'_, PyAny>,
        displacement: &Bound<'_, PyAny>,
    ) -> PyResult<Covariance> {
        let (mesh, field) = (any_mesh(mesh)?, rows::<2>(displacement, "displacement", argument_error)?);
        Ok(Self::new(run_on(py, Some(&SHARED), None, |_| self.inner.of_total(mesh, &field))?))
    }

    /// Covariance of the strain at the centre of each cell, (num_cells, 3, 3) float64: of ``exx``, ``eyy``, ``exy``.
    fn cell_strains<'py>(&self, py: Python<'py>, measure: &str) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let measure = strains::measure(measure)?;
        blocks(py, &run_briefly(py, &SHARED, || self.inner.cell_strains(measure))?)
    }

    /// Covariance of the displacement at points, (m, 2, 2) float64; NaN outside the mesh.
    fn at_points<'py>(&self, py: Python<'py>, points: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let points = rows::<2>(points, "points", argument_error)?;
        blocks(py, &run_on(py, Some(&SHARED), None, |monitor| self.inner.at_points(&points, monitor))?)
    }

    /// Covariance of the mean strain over points, (3, 3) float64; NaN if one lies outside the mesh.
    fn mean_strain<'py>(
        &self,
        py: Python<'py>,
        points: &Bound<'py, PyAny>,
        measure: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (points, measure) = (rows::<2>(points, "points", argument_error)?, strains::measure(measure)?);
        let covariance = run_on(py, Some(&SHARED), None, |monitor| self.inner.mean_strain(&points, measure, monitor))?;
        to_array(py, &covariance)
    }

    /// Covariance of k linear functions, (k, k) float64, from their weights, (k * n, 2), function after function.
    fn of_functions<'py>(
        &self,
        py: Python<'py>,
        weights: &Bound<'py, PyAny>,
        count: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let weights = rows::<2>(weights, "weights", argument_error)?;
        let functions: Vec<&[[f64; 2]]> = weights.chunks((weights.len() / count.max(1)).max(1)).collect();
        let covariance = run_on(py, Some(&SHARED), None, |monitor| self.inner.of_functions(&functions, monitor))?;
        PyArray::from_vec(py, covariance).reshape([count, count])
    }
}

/// Square blocks as an array.
fn blocks<'py, const N: usize>(py: Python<'py>, blocks: &[[[f64; N]; N]]) -> PyResult<Bound<'py, PyArray3<f64>>> {
    PyArray::from_slice(py, blocks.as_flattened().as_flattened()).reshape([blocks.len(), N, N])
}
