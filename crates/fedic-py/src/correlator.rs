//! The correlator and its solution.

use std::sync::Arc;

use fedic::{Iteration, Start};
use numpy::{PyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{rows, to_array};
use crate::camera::any_camera;
use crate::errors::argument_error;
use crate::image::{GreyArray, ReferenceImage};
use crate::mesh::any_mesh;
use crate::options::correlation_options;
use crate::worker::run;

const DEFORMED: &str = "the deformed image";

/// A reference image prepared on a mesh; see `fedic.Correlator`.
#[pyclass(frozen, weakref, module = "fedic._core")]
pub(crate) struct Correlator {
    inner: fedic::Correlator,
}

#[pymethods]
impl Correlator {
    #[new]
    #[pyo3(signature = (reference, mesh, camera, *, progress=None, **options))]
    fn new(
        py: Python<'_>,
        reference: &Bound<'_, PyAny>,
        mesh: &Bound<'_, PyAny>,
        camera: &Bound<'_, PyAny>,
        progress: Option<&Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mesh = any_mesh(mesh)?;
        let camera = any_camera(camera)?;
        let options = correlation_options(options)?;
        let reference = Arc::new(ReferenceImage::new(reference)?);
        let inner =
            run(py, progress, move |monitor| fedic::Correlator::new_with(reference, mesh, camera, options, monitor))?;
        Ok(Self { inner })
    }

    /// Number of quadrature points.
    #[getter]
    fn num_points(&self) -> usize {
        self.inner.num_points()
    }

    /// Measures one deformed image; see `fedic.Correlator.correlate`.
    #[pyo3(signature = (deformed, *, initial=None, pyramid=false, progress=None))]
    fn correlate(
        &self,
        py: Python<'_>,
        deformed: &Bound<'_, PyAny>,
        initial: Option<&Bound<'_, PyAny>>,
        pyramid: bool,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Solution> {
        let grey = GreyArray::borrow(deformed, DEFORMED)?;
        let view = grey.view(DEFORMED)?;
        let field = initial.map(|field| rows::<2>(field, "initial", argument_error)).transpose()?;
        run(py, progress, move |monitor| {
            let start = match &field {
                Some(field) => Start::Field(field),
                None if pyramid => Start::Pyramid,
                None => Start::Zero,
            };
            self.inner.correlate_with(view, start, monitor).map(Solution)
        })
    }

    /// Residual at the pixels of the reference image, (h, w) float32; see `fedic.Correlator.residual_map`.
    fn residual_map<'py>(
        &self,
        py: Python<'py>,
        deformed: &Bound<'py, PyAny>,
        displacement: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let grey = GreyArray::borrow(deformed, DEFORMED)?;
        let view = grey.view(DEFORMED)?;
        let field = rows::<2>(displacement, "displacement", argument_error)?;
        let map = run(py, None, |monitor| self.inner.residual_map_with(view, &field, monitor))?;
        let [width, height] = self.inner.size();
        PyArray::from_vec(py, map).reshape([height, width])
    }

    /// Standard deviation of the displacement of each node, (n, 2) float64; see `fedic.Correlator.standard_deviations`.
    fn standard_deviations<'py>(&self, py: Python<'py>, noise: f64) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let deviations = run(py, None, |monitor| self.inner.standard_deviations_with(noise, monitor))?;
        to_array(py, &deviations)
    }

    /// Quadrature points.
    ///
    /// Returns
    /// -------
    /// points : (n, 3) float64
    ///     World points.
    /// weights : (n,) float64
    ///     Area each stands for, in the mesh's unit squared; one pixel each for the pixel rule.
    /// cells : (n,) int64
    ///     Cell each lies in.
    #[allow(clippy::type_complexity)]
    fn quadrature_points<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>)> {
        let (points, weights, cells) = py.detach(|| self.inner.quadrature_points());
        let cells = cells.into_iter().map(|cell| cell as i64).collect();
        Ok((to_array(py, &points)?, PyArray1::from_vec(py, weights), PyArray1::from_vec(py, cells)))
    }
}

/// The measured field and how it was reached; see `fedic.Result`.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct Solution(fedic::Solution);

#[pymethods]
impl Solution {
    /// Displacement of each node, (n, 2) float64, in the mesh's unit; NaN at nodes that no cell uses.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &self.0.displacement)
    }

    /// Displacement of each node in the image, (n, 2) float64, in pixels.
    #[getter]
    fn pixel_displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &self.0.pixel_displacement)
    }

    /// Whether the error left by the iterations is within the tolerance.
    #[getter]
    fn converged(&self) -> bool {
        self.0.converged
    }

    /// Estimate of the largest error of a node that the iterations leave, in pixels.
    #[getter]
    fn error_left(&self) -> f64 {
        self.0.error_left
    }

    /// Iterations on the images at full resolution.
    #[getter]
    fn iterations(&self) -> usize {
        self.0.iterations
    }

    /// ``(level, iteration, correction in pixels, residual_rms)`` of every iteration, coarsest level first.
    #[getter]
    fn history(&self) -> Vec<(usize, usize, f64, f64)> {
        let row = |i: &Iteration| (i.level, i.iteration, i.correction, i.residual_rms);
        self.0.history.iter().map(row).collect()
    }

    /// Standard deviation of the residual over the mesh, in grey levels.
    #[getter]
    fn residual_rms(&self) -> f64 {
        self.0.residual_rms
    }

    /// Root mean square of the residual over each cell, (num_cells,) float64, in grey levels.
    #[getter]
    fn cell_residuals<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.0.cell_residuals)
    }

    /// Cells of which some points left the deformed image, int64.
    #[getter]
    fn outside_cells<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.0.outside_cells.iter().map(|&cell| cell as i64))
    }

    /// Number of quadrature points.
    #[getter]
    fn num_points(&self) -> usize {
        self.0.num_points
    }
}
