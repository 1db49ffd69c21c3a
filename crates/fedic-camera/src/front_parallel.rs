//! The perfect projector of the paper's Sect. 4.

use crate::{Camera, CameraError};

/// Front-parallel view without distortion: `u = u0 + k X`, `v = v0 - k Y` (paper, eq. 18).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrontParallel {
    scale: f64,
    origin: [f64; 2],
}

impl FrontParallel {
    /// A view of `scale` pixels per world unit that shows the world's origin at `origin = [u0, v0]`.
    ///
    /// # Errors
    ///
    /// [`CameraError`] where the scale is not positive or a parameter not finite.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{Camera, FrontParallel};
    /// let camera = FrontParallel::new(10.0, [100.0, 200.0])?;
    /// assert_eq!(camera.project([1.0, 2.0, 0.0]), [110.0, 180.0]);
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    pub fn new(scale: f64, origin: [f64; 2]) -> Result<Self, CameraError> {
        if !origin.iter().all(|c| c.is_finite()) {
            return Err(CameraError::NonFinite { parameter: "origin" });
        }
        if !scale.is_finite() {
            return Err(CameraError::NonFinite { parameter: "scale" });
        }
        if scale <= 0.0 {
            return Err(CameraError::NotPositive { parameter: "scale (pixels per unit)", value: scale });
        }
        Ok(Self { scale, origin })
    }

    /// Pixels per world unit.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Image point of the world's origin.
    pub fn origin(&self) -> [f64; 2] {
        self.origin
    }
}

impl Camera for FrontParallel {
    #[inline]
    fn project(&self, [x, y, _]: [f64; 3]) -> [f64; 2] {
        [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y]
    }

    #[inline]
    fn project_with_jacobian(&self, point: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]) {
        (self.project(point), [[self.scale, 0.0, 0.0], [0.0, -self.scale, 0.0]])
    }

    fn constant_jacobian(&self) -> Option<[[f64; 3]; 2]> {
        Some(self.project_with_jacobian([0.0; 3]).1)
    }

    fn unproject_linear(&self, [u, v]: [f64; 2], z: f64) -> [f64; 3] {
        [(u - self.origin[0]) / self.scale, (self.origin[1] - v) / self.scale, z]
    }
}
