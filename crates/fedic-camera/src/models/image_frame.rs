//! The camera of a mesh drawn in pixels.

use crate::Camera;

/// World unit = pixel: `u = X`, `v = Y` for every `Z`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ImageFrame;

impl Camera for ImageFrame {
    #[inline]
    fn project(&self, [x, y, _]: [f64; 3]) -> [f64; 2] {
        [x, y]
    }

    #[inline]
    fn project_with_jacobian(&self, [x, y, _]: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]) {
        ([x, y], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    }

    fn constant_jacobian(&self) -> Option<[[f64; 3]; 2]> {
        Some([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    }

    fn unproject_linear(&self, [u, v]: [f64; 2], z: f64) -> [f64; 3] {
        [u, v, z]
    }
}
