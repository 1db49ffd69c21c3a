//! Projection and unprojection of NumPy arrays, for any camera.

use fedic::{Camera, Error, Monitor};
use numpy::{PyArray, PyArray1, PyArray2, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{self, to_array};
use crate::errors::{argument_error, camera_error, warn};
use crate::worker::run;

/// Smallest number of points per parallel task.
const GRAIN: usize = 1024;

/// The value of each item, unless the caller asks to stop.
fn map_each<I: Sync, T: Send>(
    monitor: &dyn Monitor,
    items: &[I],
    value: impl Fn(&I) -> T + Sync,
    none: impl Fn() -> T + Sync,
) -> Result<Vec<T>, Error> {
    let value = |item: &I| if monitor.cancelled() { none() } else { value(item) };
    let values = items.par_iter().with_min_len(GRAIN).map(value).collect();
    if monitor.cancelled() { Err(Error::Cancelled) } else { Ok(values) }
}

pub(super) fn project<'py>(
    py: Python<'py>,
    camera: &dyn Camera,
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (points, _) = arrays::points(points, "points", argument_error)?;
    let project = |&point: &[f64; 3]| camera.project(point);
    let pixels = run(py, None, |monitor| map_each(monitor, &points, project, <[f64; 2]>::default))?;
    warn_of_extrapolation(py, camera, &points)?;
    to_array(py, &pixels)
}

pub(super) fn jacobian<'py>(
    py: Python<'py>,
    camera: &dyn Camera,
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray3<f64>>> {
    let (points, _) = arrays::points(points, "points", argument_error)?;
    let jacobian = |&point: &[f64; 3]| camera.project_with_jacobian(point).1;
    let jacobians = run(py, None, |monitor| map_each(monitor, &points, jacobian, <[[f64; 3]; 2]>::default))?;
    warn_of_extrapolation(py, camera, &points)?;
    PyArray::from_slice(py, jacobians.as_flattened().as_flattened()).reshape([points.len(), 2, 3])
}

pub(super) fn unproject<'py>(
    py: Python<'py>,
    camera: &dyn Camera,
    pixels: &Bound<'py, PyAny>,
    z: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let pixels = arrays::rows::<2>(pixels, "pixels", argument_error)?;
    let unproject = |&pixel: &[f64; 2]| fedic::unproject(camera, pixel, z);
    let points = run(py, None, |monitor| map_each(monitor, &pixels, unproject, || None))?;
    let failed = points.iter().filter(|point| point.is_none()).count();
    if let Some(first) = points.iter().position(Option::is_none) {
        let [u, v] = pixels[first];
        return Err(camera_error(format!(
            "{failed} of {} pixels see no point of the plane Z = {z}, the first of them number {first} at ({u}, {v}): the \
             plane is behind the camera or edge-on there, or the pixel is beyond the reach of the lens model",
            pixels.len()
        )));
    }
    let points: Vec<[f64; 3]> = points.into_iter().flatten().collect();
    warn_of_extrapolation(py, camera, &points)?;
    to_array(py, &points)
}

pub(super) fn covers<'py>(
    py: Python<'py>,
    camera: &dyn Camera,
    points: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArray1<bool>>> {
    let (points, _) = arrays::points(points, "points", argument_error)?;
    Ok(PyArray1::from_iter(py, points.iter().map(|&point| camera.covers(point))))
}

/// Warns if the camera sees points outside the domain of its lens. The message contains no numbers, so that Python shows it
/// once.
fn warn_of_extrapolation(py: Python<'_>, camera: &dyn Camera, points: &[[f64; 3]]) -> PyResult<()> {
    let extrapolated = |&point: &[f64; 3]| !camera.covers(point) && camera.project(point)[0].is_finite();
    if !camera.is_piecewise() || !run(py, None, |_| Ok(points.par_iter().with_min_len(GRAIN).any(extrapolated)))? {
        return Ok(());
    }
    warn(
        py,
        "some points lie outside the domain in which the lens is calibrated, where it is extrapolated: camera.covers(points) \
         is False for them",
    )
}
