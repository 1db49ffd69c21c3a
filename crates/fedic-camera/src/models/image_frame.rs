//! The camera of a mesh drawn in pixels.

use super::check_scale;
use crate::{Camera, CameraError, Resizable};

/// The camera of a mesh drawn in the pixels of an image: `u = X`, `v = Y` for every `Z`.
///
/// Of a region or a reduction of that image it is `u = u0 + k X`, `v = v0 + k Y`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageFrame {
    scale: f64,
    origin: [f64; 2],
    image_size: Option<[u32; 2]>,
}

/// The camera of a mesh drawn in the pixels of the image itself, of any size.
#[allow(non_upper_case_globals)] // the name of the type, as that of a struct without fields
pub const ImageFrame: ImageFrame = ImageFrame { scale: 1.0, origin: [0.0; 2], image_size: None };

impl Default for ImageFrame {
    fn default() -> Self {
        ImageFrame
    }
}

impl ImageFrame {
    /// Creates the camera of `scale` pixels per pixel of the drawing, which shows the origin of the drawing at
    /// `origin = [u0, v0]`.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the scale is not positive or a parameter is not finite.
    pub fn new(scale: f64, origin: [f64; 2]) -> Result<Self, CameraError> {
        check_scale(scale, origin, "scale")?;
        Ok(Self { scale, origin, image_size: None })
    }

    /// Pixels per pixel of the drawing.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Image point of the origin of the drawing.
    pub fn origin(&self) -> [f64; 2] {
        self.origin
    }
}

impl Resizable for ImageFrame {
    fn image_size(&self) -> Option<[u32; 2]> {
        self.image_size
    }

    fn resized(self, image_size: Option<[u32; 2]>) -> Self {
        Self { image_size, ..self }
    }

    fn resampled(&self, scale: f64, shift: [f64; 2]) -> Result<Self, CameraError> {
        let origin = std::array::from_fn(|i| scale * self.origin[i] + shift[i]);
        Ok(Self::new(scale * self.scale, origin)?.resized(self.image_size))
    }
}

impl Camera for ImageFrame {
    #[inline]
    fn project(&self, [x, y, _]: [f64; 3]) -> [f64; 2] {
        [self.origin[0] + self.scale * x, self.origin[1] + self.scale * y]
    }

    #[inline]
    fn project_with_jacobian(&self, point: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]) {
        (self.project(point), [[self.scale, 0.0, 0.0], [0.0, self.scale, 0.0]])
    }

    fn constant_jacobian(&self) -> Option<[[f64; 3]; 2]> {
        Some(self.project_with_jacobian([0.0; 3]).1)
    }

    fn unproject_linear(&self, [u, v]: [f64; 2], z: f64) -> [f64; 3] {
        [(u - self.origin[0]) / self.scale, (v - self.origin[1]) / self.scale, z]
    }
}
