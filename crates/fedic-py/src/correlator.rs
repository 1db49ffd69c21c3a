//! The correlator and its solution.

use std::sync::Arc;

use fedic::{Information, Iteration, Start, ThreadPool};
use numpy::{PyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::arrays::{rows, to_array};
use crate::camera::any_camera;
use crate::covariance::Covariance;
use crate::errors::argument_error;
use crate::image::{GreyArray, ReferenceImage};
use crate::mesh::any_mesh;
use crate::options::correlation_options;
use crate::plane_stress::equilibrium_gap;
use crate::worker::{SHARED, run_briefly, run_on};

const DEFORMED: &str = "the deformed image";

/// A reference image prepared on a mesh; see `fedic.Correlator`.
#[pyclass(frozen, weakref, module = "fedic._core")]
pub(crate) struct Correlator {
    inner: fedic::Correlator,
}

#[pymethods]
impl Correlator {
    /// The regularization is that of the equilibrium gap with a pair of a `PlaneStress` and an (m,) array of free nodes as `gap`.
    #[new]
    #[pyo3(signature = (reference, mesh, camera, *, mask=None, gap=None, progress=None, **options))]
    #[allow(clippy::too_many_arguments)]
    fn new(
        py: Python<'_>,
        reference: &Bound<'_, PyAny>,
        mesh: &Bound<'_, PyAny>,
        camera: &Bound<'_, PyAny>,
        mask: Option<PyReadonlyArray2<'_, bool>>,
        gap: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
        options: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let mesh = any_mesh(mesh)?;
        let camera = any_camera(camera)?;
        let options = correlation_options(options)?;
        let shared = options.num_threads.is_none().then_some(&SHARED);
        let reference = Arc::new(ReferenceImage::new(reference)?);
        let mask: Option<Vec<bool>> = mask.map(|mask| mask.as_array().iter().copied().collect());
        let gap = gap.map(equilibrium_gap).transpose()?;
        let inner = run_on(py, shared, progress, move |monitor| {
            fedic::Correlator::new_with(reference, mesh, camera, options, mask.as_deref(), gap.as_ref(), monitor)
        })?;
        Ok(Self { inner })
    }

    /// Number of quadrature points.
    #[getter]
    fn num_points(&self) -> usize {
        self.inner.num_points()
    }

    /// Image points of the nodes in the reference image, (n, 2) float64, in pixels; NaN at nodes that no cell uses.
    fn node_pixels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &run_briefly(py, self.threads(), || self.inner.node_pixels())?)
    }

    /// Measures one deformed image; see `fedic.Correlator.correlate`. At most `max_iterations` iterations are made, fewer than the
    /// option of this name if given. With an initial displacement and `pyramid` the reduced images start from it.
    #[pyo3(signature = (deformed, *, initial=None, pyramid=false, max_iterations=None, progress=None))]
    fn correlate(
        &self,
        py: Python<'_>,
        deformed: &Bound<'_, PyAny>,
        initial: Option<&Bound<'_, PyAny>>,
        pyramid: bool,
        max_iterations: Option<usize>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Solution> {
        let grey = GreyArray::borrow(deformed, DEFORMED)?;
        let view = grey.view(py, self.threads(), DEFORMED)?;
        let field = initial.map(|field| rows::<2>(field, "initial", argument_error)).transpose()?;
        run_on(py, Some(self.threads()), progress, move |monitor| {
            let start = match &field {
                Some(field) if pyramid => Start::PyramidFrom(field),
                Some(field) => Start::Field(field),
                None if pyramid => Start::Pyramid,
                None => Start::Zero,
            };
            let limit = self.inner.options().max_iterations;
            let max_iterations = max_iterations.map_or(limit, |given| given.min(limit));
            self.inner.attempt(view, start, max_iterations, monitor).map(Solution)
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
        let view = grey.view(py, self.threads(), DEFORMED)?;
        let field = rows::<2>(displacement, "displacement", argument_error)?;
        let map =
            run_on(py, Some(self.threads()), None, |monitor| self.inner.residual_map_with(view, &field, monitor))?;
        let [width, height] = self.inner.size();
        PyArray::from_vec(py, map).reshape([height, width])
    }

    /// Covariance of the displacement, near a displacement; see `fedic.Result.covariance`. `information` is that of a solution.
    #[pyo3(signature = (noise, displacement=None, information=None))]
    fn covariance(
        &self,
        py: Python<'_>,
        noise: f64,
        displacement: Option<&Bound<'_, PyAny>>,
        information: Option<GivenInformation<'_>>,
    ) -> PyResult<Covariance> {
        let field = displacement.map(|field| rows::<2>(field, "displacement", argument_error)).transpose()?;
        let information = information.map(cell_information).transpose()?;
        let inner = run_on(py, Some(self.threads()), None, |monitor| {
            self.inner.covariance(noise, field.as_deref(), information.as_deref(), monitor)
        })?;
        Ok(Covariance::new(inner))
    }

    /// Share of the pixels at the full scale of an image in a rectangle of it.
    ///
    /// Parameters
    /// ----------
    /// image : (h, w) array of uint8, uint16 or float32
    /// low, high : (int, int)
    ///     First pixel ``(u, v)`` of the rectangle, and the one past the last; they are limited to the image.
    ///
    /// Returns
    /// -------
    /// float
    ///     From 0 to 1; 0 if fewer than nine pixels of the image are at its full scale.
    fn saturated_share(
        &self,
        py: Python<'_>,
        image: &Bound<'_, PyAny>,
        low: [usize; 2],
        high: [usize; 2],
    ) -> PyResult<f64> {
        let grey = GreyArray::borrow(image, "image")?;
        let view = grey.view(py, self.threads(), "image")?;
        run_briefly(py, self.threads(), || view.saturated_share(low, high))
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
        let (points, weights, cells) = run_briefly(py, self.threads(), || self.inner.quadrature_points())?;
        let cells = cells.into_iter().map(|cell| cell as i64).collect();
        Ok((to_array(py, &points)?, PyArray1::from_vec(py, weights), PyArray1::from_vec(py, cells)))
    }
}

impl Correlator {
    /// Its own threads, or the shared ones.
    fn threads(&self) -> &ThreadPool {
        self.inner.threads().unwrap_or(&SHARED)
    }
}

/// The measured field and how it was reached; see `fedic.Result`.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct Solution(fedic::Solution);

#[pymethods]
impl Solution {
    /// Displacement of each node, (n, 2) float64, in the mesh's unit; NaN at nodes that were not measured.
    #[getter]
    fn displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &self.0.displacement)
    }

    /// Displacement as the iterations left it, (n, 2) float64, in the mesh's unit; NaN at nodes that no cell uses.
    #[getter]
    fn unchecked_displacement<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &self.0.unchecked_displacement)
    }

    /// Displacement of each node in the image, (n, 2) float64, in pixels; NaN at nodes that were not measured.
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

    /// Cells of which some points left the deformed image or are saturated in it, int64.
    #[getter]
    fn outside_cells<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_iter(py, self.0.outside_cells.iter().map(|&cell| cell as i64))
    }

    /// Number of quadrature points.
    #[getter]
    fn num_points(&self) -> usize {
        self.0.num_points
    }

    /// Standard deviation of the noise of one image, in grey levels: as given, or estimated.
    #[getter]
    fn noise(&self) -> f64 {
        self.0.quality.noise
    }

    /// Evidence of the cells, float64 of shape (num_cells,): ``used_share``, ``kept_share``, ``correlation``, ``normalized_residual``, ``misfit``.
    #[getter]
    fn cell_evidence<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let quality = &self.0.quality;
        let rows = [
            ("used_share", &quality.used_share),
            ("kept_share", &quality.kept_share),
            ("correlation", &quality.correlation),
            ("normalized_residual", &quality.normalized_residual),
            ("misfit", &quality.misfit),
        ];
        named_rows(py, &rows)
    }

    /// Evidence of the nodes, float64 of shape (n,): ``deviation``, ``conditioning``.
    #[getter]
    fn node_evidence<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let quality = &self.0.quality;
        named_rows(py, &[("deviation", &quality.deviation), ("conditioning", &quality.conditioning)])
    }

    /// Factors of each cell on the Hessian and on the noise, (num_cells, 2) float64, the cells with robust weights and the weights of
    /// their quadrature points; None if all are one.
    #[getter]
    fn information<'py>(&self, py: Python<'py>) -> PyResult<Option<CellInformation<'py>>> {
        let Some(cells) = &self.0.information else { return Ok(None) };
        let factors: Vec<[f64; 2]> = cells.iter().map(|cell| [cell.hessian, cell.noise]).collect();
        let weighed = || cells.iter().enumerate().filter_map(|(index, cell)| Some((index, cell.weights.as_ref()?)));
        let weights = weighed().map(|(_, weights)| PyArray1::from_slice(py, weights)).collect();
        Ok(Some((to_array(py, &factors)?, weighed().map(|(index, _)| index).collect(), weights)))
    }

    /// Bits of `CELL_FLAGS` of each cell, uint8.
    #[getter]
    fn cell_flags<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        PyArray1::from_slice(py, &self.0.quality.cell_flags)
    }

    /// Bits of `NODE_FLAGS` of each node, uint8.
    #[getter]
    fn node_flags<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u8>> {
        PyArray1::from_slice(py, &self.0.quality.node_flags)
    }
}

/// Factors of the cells, cells with robust weights, and their weights.
type CellInformation<'py> = (Bound<'py, PyArray2<f64>>, Vec<usize>, Vec<Bound<'py, PyArray1<f32>>>);

/// The same as an argument.
type GivenInformation<'py> = (Bound<'py, PyAny>, Vec<usize>, Vec<PyReadonlyArray1<'py, f32>>);

/// What each cell contributes to the covariance, as `Solution.information` gives it.
fn cell_information((factors, cells, weights): GivenInformation<'_>) -> PyResult<Vec<Information>> {
    let factors = rows::<2>(&factors, "information", argument_error)?;
    let full = factors.into_iter().map(|[hessian, noise]| Information { hessian, noise, weights: None });
    let mut information: Vec<Information> = full.collect();
    for (cell, weights) in cells.into_iter().zip(weights) {
        if let Some(cell) = information.get_mut(cell) {
            cell.weights = Some(weights.as_array().iter().copied().collect());
        }
    }
    Ok(information)
}

fn named_rows<'py>(py: Python<'py>, rows: &[(&str, &Vec<f64>)]) -> PyResult<Bound<'py, PyDict>> {
    let named = PyDict::new(py);
    rows.iter().try_for_each(|(name, row)| named.set_item(name, PyArray1::from_slice(py, row)))?;
    Ok(named)
}

/// Flags of cells and nodes, `{name: reason}` in the order of their bits, and the thresholds of the verdict.
pub(crate) fn add_quality_constants(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let (cells, nodes) = (PyDict::new(module.py()), PyDict::new(module.py()));
    fedic::CellFlag::ALL.iter().try_for_each(|flag| cells.set_item(flag.name(), flag.reason()))?;
    fedic::NodeFlag::ALL.iter().try_for_each(|flag| nodes.set_item(flag.name(), flag.reason()))?;
    module.add("CELL_FLAGS", cells)?;
    let invalid = fedic::CellFlag::INVALID.iter().map(|flag| flag.name());
    module.add("INVALID_CELL_FLAGS", PyTuple::new(module.py(), invalid.collect::<Vec<_>>())?)?;
    module.add("NODE_FLAGS", nodes)?;
    let thresholds = PyDict::new(module.py());
    thresholds.set_item("correlation", fedic::MIN_CORRELATION)?;
    thresholds.set_item("node_error", fedic::NODE_ERROR)?;
    thresholds.set_item("significance", fedic::SIGNIFICANCE)?;
    thresholds.set_item("deviation", fedic::MAX_DEVIATION)?;
    thresholds.set_item("light", fedic::MAX_LIGHT)?;
    thresholds.set_item("gradient_to_noise", fedic::GRADIENT_TO_NOISE)?;
    module.add("QUALITY_THRESHOLDS", thresholds)
}
