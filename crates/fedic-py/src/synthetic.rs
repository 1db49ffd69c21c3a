//! Textures and rendering.

use std::error::Error;
use std::process;
use std::sync::{Mutex, OnceLock};

use fedic_synthetic::{DisplacementField, Plane, Render, SyntheticError, Texture};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{self, rows, to_array};
use crate::camera::any_camera;
use crate::errors::{IntoPyErr, argument_error, internal_error, option_error};
use crate::worker::run;

/// The process that has started the threads of the rendering. Functions of the caller run on its own thread, and so the rendering
/// cannot move to the shared threads as a whole.
static RENDERING_PROCESS: OnceLock<u32> = OnceLock::new();

/// A continuous speckle pattern of the plane, defined at any point.
///
/// Dark spots of random position, size and darkness on a white ground, one per square of a regular grid; twice continuously
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

    /// Seed of the random positions.
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

    fn __getnewargs_ex__<'py>(&self, py: Python<'py>) -> PyResult<((f64,), Bound<'py, PyDict>)> {
        let named = PyDict::new(py);
        named.set_item("coverage", self.0.coverage())?;
        named.set_item("seed", self.0.seed())?;
        Ok(((self.0.size(),), named))
    }

    fn __repr__(&self) -> String {
        format!("Speckle(size={}, coverage={}, seed={})", self.0.size(), self.0.coverage(), self.0.seed())
    }
}

/// A Python function of material points (n, 2) that returns their displacement (n, 2).
struct PlaneDisplacement(Py<PyAny>);

impl DisplacementField for PlaneDisplacement {
    fn displacements(&self, points: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, Box<dyn Error + Send + Sync>> {
        let displacements = Python::attach(|py| {
            let points: Vec<[f64; 2]> = points.iter().map(|&[x, y, _]| [x, y]).collect();
            let returned = self.0.call1(py, (to_array(py, &points)?,))?;
            let displacements = rows::<2>(returned.bind(py), "displacement", argument_error)?;
            if displacements.len() == points.len() {
                Ok(displacements)
            } else {
                let [given, found] = [points.len(), displacements.len()];
                let message = format!("displacement of points ({given}, 2) must have that shape, got ({found}, 2)");
                Err(option_error(message, "displacement"))
            }
        })?;
        Ok(displacements.into_iter().map(|[x, y]| [x, y, 0.0]).collect())
    }
}

/// A Python object with a method ``values`` of points (n, 2). Its first exception is kept; the values are NaN from then on.
struct PythonTexture<'a> {
    texture: &'a Py<PyAny>,
    error: &'a Mutex<Option<PyErr>>,
}

impl Texture for PythonTexture<'_> {
    fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        let values = Python::attach(|py| {
            let returned = self.texture.call_method1(py, "values", (to_array(py, points)?,))?;
            let values: Vec<f64> = returned.bind(py).extract()?;
            if values.len() == points.len() {
                return Ok(values);
            }
            let message = format!("texture.values of {} points returned {} values", points.len(), values.len());
            Err(option_error(message, "texture"))
        });
        values.unwrap_or_else(|error| {
            if let Ok(mut slot) = self.error.lock() {
                slot.get_or_insert(error);
            }
            vec![f64::NAN; points.len()]
        })
    }
}

/// Mean of a texture of the plane ``Z = z`` over each pixel of an image.
///
/// Parameters
/// ----------
/// texture : Speckle, or an object with a method ``values`` of points (n, 2)
/// camera : ImageFrame, FrontParallel or Pinhole
/// shape : (int, int)
///     Height and width of the image in pixels.
/// displacement : callable, optional
///     Function of material points (n, 2) that returns their displacement (n, 2).
/// z : float
/// supersampling : int
///     Samples per pixel in each direction.
/// progress : callable, optional
///     Called with the fraction done.
///
/// Returns
/// -------
/// (height, width) float64
///     From 0 to 1.
///
/// Raises
/// ------
/// OptionError
///     If an argument is out of its range, or the displacement cannot be inverted.
/// CameraError
///     If a pixel sees no point of the plane.
/// FedicError
///     In a process forked from one that has rendered.
#[pyfunction]
#[pyo3(signature = (texture, camera, shape, displacement=None, z=0.0, supersampling=3, progress=None))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn render_plane<'py>(
    py: Python<'py>,
    texture: &Bound<'py, PyAny>,
    camera: &Bound<'py, PyAny>,
    shape: [usize; 2],
    displacement: Option<Py<PyAny>>,
    z: f64,
    supersampling: u32,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    if *RENDERING_PROCESS.get_or_init(process::id) != process::id() {
        return Err(internal_error(
            "images cannot be rendered in a process forked from one that has rendered, whose threads it lacks; use \
             multiprocessing.get_context(\"spawn\")"
                .to_owned(),
        ));
    }
    let camera = any_camera(camera)?;
    let [height, width] = shape;
    let displacement = displacement.map(PlaneDisplacement);
    let speckle = texture.cast::<Speckle>().ok().map(|speckle| speckle.get().0);
    let (other, failed) = (texture.clone().unbind(), Mutex::new(None));
    let interrupted = Mutex::new(None);
    // Functions of the caller run on its own thread; only the loops over points use others.
    let report = |fraction: f64| {
        let outcome = Python::attach(|py| {
            py.check_signals()?;
            progress.as_ref().map_or(Ok(()), |progress| progress.call1(py, (fraction,)).map(|_| ()))
        });
        outcome.map_err(|error| interrupted.lock().map(|mut slot| *slot = Some(error))).is_ok()
    };
    let rendered = py.detach(|| {
        let render = Render::new(&*camera, [width, height]).with_samples(supersampling).with_progress(&report);
        let plane = Plane::horizontal(z)?;
        let other = PythonTexture { texture: &other, error: &failed };
        let texture: &dyn Texture = speckle.as_ref().map_or(&other, |speckle| speckle);
        match &displacement {
            None => render.plane(&plane, texture),
            Some(displacement) => render.displaced_plane(&plane, texture, displacement),
        }
    });
    if let Ok(Some(error)) = failed.into_inner() {
        return Err(error);
    }
    match (rendered, interrupted.into_inner()) {
        (Err(SyntheticError::Cancelled), Ok(Some(error))) => Err(error),
        (rendered, _) => {
            let values = rendered.map_err(IntoPyErr::into_py_err)?.into_values();
            PyArray1::from_vec(py, values).reshape([height, width])
        }
    }
}
