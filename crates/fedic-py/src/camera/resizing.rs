//! The size of the images of a camera, cameras of regions and of binned images.

use fedic::Resizable;
use pyo3::prelude::*;

use crate::arrays::representation;
use crate::errors::{IntoPyErr, option_error};

/// A number of pixels.
fn pixels(object: &Bound<'_, PyAny>, name: &str) -> PyResult<u32> {
    object.extract().map_err(|_| {
        let given = representation(object);
        option_error(format!("{name} must be a whole number of pixels, 0 or more, got {given}"), name)
    })
}

/// The camera with the size of its images that a Python object gives.
pub(super) fn with_image_size<C: Resizable>(camera: C, size: Option<&Bound<'_, PyAny>>) -> PyResult<C> {
    let Some(size) = size else { return Ok(camera) };
    let size: [u32; 2] = size.extract().map_err(|_| {
        let message =
            format!("image_size must be (width, height), two whole numbers of pixels, got {}", representation(size));
        option_error(message, "image_size")
    })?;
    camera.with_image_size(Some(size)).map_err(IntoPyErr::into_py_err)
}

/// The camera of a region `[left, top, width, height]` of the image.
pub(super) fn cropped<C: Resizable>(camera: &C, region: [&Bound<'_, PyAny>; 4]) -> PyResult<C> {
    let [left, top, width, height] = region;
    let origin = [pixels(left, "left")?, pixels(top, "top")?];
    let size = [pixels(width, "width")?, pixels(height, "height")?];
    camera.cropped(origin, size).map_err(IntoPyErr::into_py_err)
}

/// The camera of binned images.
pub(super) fn binned<C: Resizable>(camera: &C, n: &Bound<'_, PyAny>) -> PyResult<C> {
    camera.binned(pixels(n, "n")?).map_err(IntoPyErr::into_py_err)
}

/// The last argument of a constructor as Python writes it, after a comma; empty if the size of the images is not known.
pub(super) fn size_argument(camera: &impl Resizable) -> String {
    camera.image_size().map_or_else(String::new, |[width, height]| format!(", image_size=({width}, {height})"))
}
