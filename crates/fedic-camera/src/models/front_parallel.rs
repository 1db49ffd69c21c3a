//! The fronto-parallel view of the paper's Sect. 4.

use super::check_scale;
use crate::{Camera, CameraError, Resizable};

/// Fronto-parallel view without distortion: `u = u0 + k X`, `v = v0 - k Y` (paper, eq. 18).
///
/// With an angle `a` between the world axes and the image axes, it is `u = u0 + k (cos a X - sin a Y)`,
/// `v = v0 - k (sin a X + cos a Y)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrontParallel {
    scale: f64,
    origin: [f64; 2],
    angle: f64,
    /// `k cos a` and `k sin a`.
    scaled_rotation: [f64; 2],
    image_size: Option<[u32; 2]>,
}

impl FrontParallel {
    /// Creates a view of `scale` pixels per world unit that shows the world origin at `origin = [u0, v0]`.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the scale is not positive or a parameter is not finite.
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
        check_scale(scale, origin, "scale (pixels per unit)")?;
        Ok(Self { scale, origin, angle: 0.0, scaled_rotation: [scale, 0.0], image_size: None })
    }

    /// Sets the angle by which the world is rotated counter-clockwise in the image about its origin, in radians.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the angle is not finite.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{Camera, FrontParallel};
    /// let camera = FrontParallel::new(10.0, [100.0, 200.0])?.with_angle(std::f64::consts::FRAC_PI_2)?;
    /// let [u, v] = camera.project([1.0, 2.0, 0.0]);
    /// assert!((u - 80.0).abs() < 1e-12 && (v - 190.0).abs() < 1e-12);
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    pub fn with_angle(self, angle: f64) -> Result<Self, CameraError> {
        if !angle.is_finite() {
            return Err(CameraError::NonFinite { parameter: "angle" });
        }
        let (sin, cos) = angle.sin_cos();
        Ok(Self { angle, scaled_rotation: [self.scale * cos, self.scale * sin], ..self })
    }

    /// Pixels per world unit.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Image point of the world origin.
    pub fn origin(&self) -> [f64; 2] {
        self.origin
    }

    /// Angle by which the world is rotated counter-clockwise in the image, in radians.
    pub fn angle(&self) -> f64 {
        self.angle
    }
}

impl Resizable for FrontParallel {
    fn image_size(&self) -> Option<[u32; 2]> {
        self.image_size
    }

    fn resized(self, image_size: Option<[u32; 2]>) -> Self {
        Self { image_size, ..self }
    }

    fn resampled(&self, scale: f64, shift: [f64; 2]) -> Result<Self, CameraError> {
        let origin = std::array::from_fn(|i| scale * self.origin[i] + shift[i]);
        Ok(Self::new(scale * self.scale, origin)?.with_angle(self.angle)?.resized(self.image_size))
    }
}

impl Camera for FrontParallel {
    #[inline]
    fn project(&self, [x, y, _]: [f64; 3]) -> [f64; 2] {
        let [cos, sin] = self.scaled_rotation;
        [self.origin[0] + (cos * x - sin * y), self.origin[1] - (sin * x + cos * y)]
    }

    #[inline]
    fn project_with_jacobian(&self, point: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]) {
        let [cos, sin] = self.scaled_rotation;
        (self.project(point), [[cos, -sin, 0.0], [-sin, -cos, 0.0]])
    }

    fn constant_jacobian(&self) -> Option<[[f64; 3]; 2]> {
        Some(self.project_with_jacobian([0.0; 3]).1)
    }

    fn unproject_linear(&self, [u, v]: [f64; 2], z: f64) -> [f64; 3] {
        let [right, up] = [u - self.origin[0], self.origin[1] - v];
        let [cos, sin] = self.scaled_rotation.map(|entry| entry / self.scale);
        [(cos * right + sin * up) / self.scale, (cos * up - sin * right) / self.scale, z]
    }
}
