//! Calibration of the camera on the specimen itself.

use std::str::FromStr;

use fedic::{Iteration, Parameter, SpecimenImages, ThreadPool};
use numpy::{PyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{describe, rows, to_array};
use crate::camera::Pinhole;
use crate::errors::{argument_error, option_error};
use crate::image::GreyArray;
use crate::mesh::any_mesh;
use crate::options::specimen_options;
use crate::worker::{SHARED, run_on};

/// Estimates camera parameters from rigid motions of a specimen; see `fedic.calibrate_on_specimen`.
///
/// ``images`` begins with the reference image; ``translations``, (n - 1, 2), are the approximate translations.
#[pyfunction]
#[pyo3(signature = (images, mesh, camera, parameters, translations, *, progress=None, **options))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn calibrate_on_specimen(
    py: Python<'_>,
    images: Vec<Bound<'_, PyAny>>,
    mesh: &Bound<'_, PyAny>,
    camera: &Bound<'_, PyAny>,
    parameters: Vec<String>,
    translations: &Bound<'_, PyAny>,
    progress: Option<&Bound<'_, PyAny>>,
    options: Option<&Bound<'_, PyDict>>,
) -> PyResult<SelfCalibration> {
    let mesh = any_mesh(mesh)?;
    let camera = camera
        .cast::<Pinhole>()
        .map_err(|_| argument_error(format!("camera must be a fedic.Pinhole, got {}", describe(camera))))?
        .get()
        .0
        .clone();
    let parameters = parameters
        .iter()
        .map(|name| Parameter::from_str(name).map_err(|error| option_error(error.to_string(), "parameters")));
    let parameters = parameters.collect::<PyResult<Vec<_>>>()?;
    let options = specimen_options(options)?;
    let translations = rows::<2>(translations, "translations", argument_error)?;
    let name = |index: usize| if index == 0 { "the reference image".to_owned() } else { format!("image {index}") };
    let borrowed = images.iter().enumerate().map(|(index, image)| GreyArray::borrow(image, &name(index)));
    let borrowed = borrowed.collect::<PyResult<Vec<_>>>()?;
    let views = {
        let own = options.num_threads.map(|number| ThreadPool::new(Some(number)));
        let threads = own.as_ref().unwrap_or(&SHARED);
        let views = borrowed.iter().enumerate().map(|(index, image)| image.view(py, threads, &name(index)));
        views.collect::<PyResult<Vec<_>>>()?
    };
    let count = parameters.len();
    let shared = options.num_threads.is_none().then_some(&SHARED);
    let found = run_on(py, shared, progress, move |monitor| {
        let (camera, parameters, translations) = (&camera, &parameters, &translations);
        let input = SpecimenImages { images: &views, mesh, camera, parameters, translations };
        fedic::calibrate_on_specimen_with(&input, &options, monitor)
    })?;
    Ok(SelfCalibration { inner: found, count })
}

/// A camera calibrated on the specimen; see `fedic.SpecimenCalibration`.
#[pyclass(frozen, module = "fedic._core")]
pub(crate) struct SelfCalibration {
    inner: fedic::SelfCalibration,
    count: usize,
}

#[pymethods]
impl SelfCalibration {
    /// The camera.
    #[getter]
    fn camera(&self) -> Pinhole {
        Pinhole(self.inner.camera.clone())
    }

    /// Covariance of the parameters, (p, p) float64.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray::from_slice(py, &self.inner.covariance).reshape([self.count, self.count])
    }

    /// Largest displacement of a node in any image per unit of each parameter, in pixels, (p,) float64.
    #[getter]
    fn sensitivities<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.sensitivities)
    }

    /// Translation and rotation vector of each moved image, (n, 6) float64.
    #[getter]
    fn motions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &self.inner.motions)
    }

    /// Standard deviations of ``motions``, (n, 6) float64; 0 for fixed components.
    #[getter]
    fn motion_standard_deviations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        to_array(py, &self.inner.motion_standard_deviations)
    }

    /// ``(level, iteration, correction in pixels, residual_rms)`` of every iteration, coarsest level first.
    #[getter]
    fn history(&self) -> Vec<(usize, usize, f64, f64)> {
        let row = |i: &Iteration| (i.level, i.iteration, i.correction, i.residual_rms);
        self.inner.history.iter().map(row).collect()
    }

    /// Whether the last correction was within the tolerance.
    #[getter]
    fn converged(&self) -> bool {
        self.inner.converged
    }

    /// RMS of the difference between the grey levels of one image, as smoothed, and the common texture.
    #[getter]
    fn residual_rms(&self) -> f64 {
        self.inner.residual_rms
    }

    /// Standard deviation of the noise of one image that the covariance assumes, in grey levels.
    #[getter]
    fn noise(&self) -> f64 {
        self.inner.noise
    }

    /// Number of quadrature points.
    #[getter]
    fn num_points(&self) -> usize {
        self.inner.num_points
    }
}
