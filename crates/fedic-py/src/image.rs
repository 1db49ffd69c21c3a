//! Grey levels borrowed from NumPy, and their interpolation.

use std::str::FromStr;

use fedic::{Gradient, ImageSampler, ImageSource, ImageView, Interpolation, Pixels, ThreadPool};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{describe, rows, to_array};
use crate::errors::{IntoPyErr, argument_error, image_error};
use crate::worker::{SHARED, run, run_briefly};

/// Points per parallel task.
const CHUNK: usize = 4096;

/// A borrowed 2-dimensional array of grey levels.
pub(crate) enum GreyArray<'py> {
    U8(PyReadonlyArray2<'py, u8>),
    U16(PyReadonlyArray2<'py, u16>),
    F32(PyReadonlyArray2<'py, f32>),
}

impl<'py> GreyArray<'py> {
    /// Borrows `object`; errors call it `name`.
    pub(crate) fn borrow(object: &Bound<'py, PyAny>, name: &str) -> PyResult<Self> {
        let contiguous = |is: bool| {
            let message =
                || format!("{name} must be contiguous in memory, row after row; pass numpy.ascontiguousarray(...)");
            if is { Ok(()) } else { Err(image_error(message())) }
        };
        if let Ok(array) = object.cast::<PyArray2<u8>>() {
            contiguous(array.is_c_contiguous())?;
            Ok(Self::U8(array.try_readonly()?))
        } else if let Ok(array) = object.cast::<PyArray2<u16>>() {
            contiguous(array.is_c_contiguous())?;
            Ok(Self::U16(array.try_readonly()?))
        } else if let Ok(array) = object.cast::<PyArray2<f32>>() {
            contiguous(array.is_c_contiguous())?;
            Ok(Self::F32(array.try_readonly()?))
        } else {
            Err(image_error(format!(
                "{name} must be a 2-dimensional array of dtype uint8, uint16 or float32, indexed [v, u], got {}",
                describe(object)
            )))
        }
    }

    /// The array as an image of the core; errors call it `name`. Floating-point numbers are checked on the threads of `pool`.
    pub(crate) fn view(&self, py: Python<'_>, pool: &ThreadPool, name: &str) -> PyResult<ImageView<'_>> {
        let (width, height, pixels) = self.pixels(name)?;
        let view = match pixels {
            Pixels::F32(_) => run_briefly(py, pool, || ImageView::new(width, height, pixels))?,
            _ => ImageView::new(width, height, pixels),
        };
        view.map_err(|error| image_error(format!("{name}: {error}")))
    }

    /// Columns, rows and grey levels.
    fn pixels(&self, name: &str) -> PyResult<(usize, usize, Pixels<'_>)> {
        let (shape, pixels) = match self {
            Self::U8(array) => (array.shape(), array.as_slice().map(Pixels::U8)),
            Self::U16(array) => (array.shape(), array.as_slice().map(Pixels::U16)),
            Self::F32(array) => (array.shape(), array.as_slice().map(Pixels::F32)),
        };
        let pixels = pixels.map_err(|error| image_error(format!("{name}: {error}")))?;
        Ok((shape[1], shape[0], pixels))
    }
}

const REFERENCE: &str = "the reference image";

/// A NumPy image kept by a correlator.
pub(crate) struct ReferenceImage(Py<PyAny>);

impl ReferenceImage {
    /// Keeps `object`, after checking its type; its numbers are checked when it is viewed.
    pub(crate) fn new(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        GreyArray::borrow(object, REFERENCE)?;
        Ok(Self(object.clone().unbind()))
    }
}

impl ImageSource for ReferenceImage {
    fn with_view(&self, use_view: &mut (dyn FnMut(ImageView<'_>) + Send)) -> Result<(), String> {
        let view = |py: Python<'_>| {
            let grey = GreyArray::borrow(self.0.bind(py), REFERENCE)?;
            let (width, height, pixels) = grey.pixels(REFERENCE)?;
            // The caller is on the threads meant for the check.
            let view = py.detach(|| ImageView::new(width, height, pixels).map(&mut *use_view));
            view.map_err(|error| image_error(error.to_string()))
        };
        Python::attach(view).map_err(|error: PyErr| error.to_string())
    }
}

/// Full scale of the grey levels of an image, a float, if so many pixels reach it that they may be saturated; None otherwise.
///
/// Parameters
/// ----------
/// image : (h, w) array of uint8, uint16 or float32
#[pyfunction]
pub(crate) fn full_scale(py: Python<'_>, image: &Bound<'_, PyAny>) -> PyResult<Option<f32>> {
    let grey = GreyArray::borrow(image, "image")?;
    let view = grey.view(py, &SHARED, "image")?;
    run_briefly(py, &SHARED, || view.full_scale())
}

/// Grey levels and gradients of an image between its pixels.
///
/// Parameters
/// ----------
/// image : (h, w) array of uint8, uint16 or float32
/// pixels : (n, 2) array_like
///     Image points ``(u, v)``.
/// interpolation : str
///     One of `INTERPOLATIONS`.
/// smoothing : float
///     Standard deviation in pixels of a Gaussian filter applied first; 0 applies none.
/// gradient : {"analytic", "finite-difference"}
///     Derivatives of the interpolant, or central differences at the pixels, interpolated.
///
/// Returns
/// -------
/// values : (n,) float32
///     Grey levels; NaN outside the image.
/// gradients : (n, 2) float32
///     Derivatives along ``u`` and ``v``, in grey levels per pixel.
///
/// Raises
/// ------
/// ImageError
///     If the image cannot be used.
/// OptionError
///     If another argument cannot be used.
#[pyfunction]
#[allow(clippy::type_complexity)]
#[pyo3(signature = (image, pixels, interpolation, *, smoothing=0.0, gradient="analytic"))]
pub(crate) fn interpolate_image<'py>(
    py: Python<'py>,
    image: &Bound<'py, PyAny>,
    pixels: &Bound<'py, PyAny>,
    interpolation: &str,
    smoothing: f64,
    gradient: &str,
) -> PyResult<(Bound<'py, PyArray1<f32>>, Bound<'py, PyArray2<f32>>)> {
    let grey = GreyArray::borrow(image, "image")?;
    let view = grey.view(py, &SHARED, "image")?;
    let pixels = rows::<2>(pixels, "pixels", argument_error)?;
    let interpolation = Interpolation::from_str(interpolation).map_err(IntoPyErr::into_py_err)?;
    let gradient = Gradient::from_str(gradient).map_err(IntoPyErr::into_py_err)?;
    let (values, gradients) = run(py, None, move |_| {
        let sampler = ImageSampler::new(view, interpolation, gradient, smoothing)?;
        let (u, v): (Vec<f64>, Vec<f64>) = pixels.iter().map(|p| (p[0], p[1])).unzip();
        let mut values = vec![0.0; u.len()];
        let mut along = [vec![0.0; u.len()], vec![0.0; u.len()]];
        let [along_u, along_v] = &mut along;
        (
            u.par_chunks(CHUNK),
            v.par_chunks(CHUNK),
            values.par_chunks_mut(CHUNK),
            along_u.par_chunks_mut(CHUNK),
            along_v.par_chunks_mut(CHUNK),
        )
            .into_par_iter()
            .for_each(|(u, v, value, du, dv)| sampler.values_and_gradients(u, v, value, [du, dv]));
        let [along_u, along_v] = along;
        Ok((values, along_u.into_iter().zip(along_v).map(|(du, dv)| [du, dv]).collect::<Vec<_>>()))
    })?;
    Ok((PyArray1::from_vec(py, values), to_array(py, &gradients)?))
}
