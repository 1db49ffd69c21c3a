//! A camera of any model, from a Python object.

use std::sync::Arc;

use fedic::Camera;
use pyo3::prelude::*;

use super::front_parallel::FrontParallel;
use super::image_frame::ImageFrame;
use super::pinhole::Pinhole;
use crate::arrays;
use crate::errors::argument_error;

/// A camera of any model.
pub(crate) fn any_camera(object: &Bound<'_, PyAny>) -> PyResult<Arc<dyn Camera>> {
    if let Ok(camera) = object.cast::<ImageFrame>() {
        Ok(Arc::new(camera.get().0))
    } else if let Ok(camera) = object.cast::<FrontParallel>() {
        Ok(Arc::new(camera.get().0))
    } else if let Ok(camera) = object.cast::<Pinhole>() {
        Ok(Arc::new(camera.get().0.clone()))
    } else {
        Err(argument_error(format!(
            "camera must be an ImageFrame, a FrontParallel or a Pinhole, got {}",
            arrays::describe(object)
        )))
    }
}
