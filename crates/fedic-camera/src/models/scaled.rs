//! A camera whose image is resized.

use std::sync::Arc;

use crate::Camera;

/// A camera with its image points multiplied by a factor, for a level of an image pyramid.
#[derive(Debug, Clone)]
pub struct Scaled {
    camera: Arc<dyn Camera>,
    factor: f64,
}

impl Scaled {
    /// Multiplies the image points of `camera` by `factor`.
    pub fn new(camera: Arc<dyn Camera>, factor: f64) -> Self {
        Self { camera, factor }
    }
}

impl Camera for Scaled {
    fn project(&self, point: [f64; 3]) -> [f64; 2] {
        self.camera.project(point).map(|c| c * self.factor)
    }

    fn project_with_jacobian(&self, point: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]) {
        let (pixel, jacobian) = self.camera.project_with_jacobian(point);
        (pixel.map(|c| c * self.factor), jacobian.map(|row| row.map(|c| c * self.factor)))
    }

    fn constant_jacobian(&self) -> Option<[[f64; 3]; 2]> {
        self.camera.constant_jacobian().map(|j| j.map(|row| row.map(|c| c * self.factor)))
    }

    fn is_beyond_fold(&self, point: [f64; 3]) -> bool {
        self.camera.is_beyond_fold(point)
    }

    fn covers(&self, point: [f64; 3]) -> bool {
        self.camera.covers(point)
    }

    fn is_piecewise(&self) -> bool {
        self.camera.is_piecewise()
    }

    fn unproject_linear(&self, pixel: [f64; 2], z: f64) -> [f64; 3] {
        self.camera.unproject_linear(pixel.map(|c| c / self.factor), z)
    }
}
