//! The size of the images of a camera, and the cameras of regions and of binned images.

use crate::{Camera, CameraError};

/// A camera that may know the size of its images, and has a camera of the same model for a part or a reduction of them.
pub trait Resizable: Camera + Clone + Sized {
    /// Width and height of the images the camera was calibrated on, in pixels, if known.
    fn image_size(&self) -> Option<[u32; 2]>;

    /// The camera with another size of its images, or none; the size is not checked.
    #[must_use]
    fn resized(self, image_size: Option<[u32; 2]>) -> Self;

    /// The camera with the image points `scale * [u, v] + shift`, and with the same size of its images.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if a parameter overflows.
    fn resampled(&self, scale: f64, shift: [f64; 2]) -> Result<Self, CameraError>;

    /// The camera with images of `image_size`, or of unknown size.
    ///
    /// # Errors
    ///
    /// [`CameraError::EmptyImage`] if the width or the height is zero.
    fn with_image_size(self, image_size: Option<[u32; 2]>) -> Result<Self, CameraError> {
        match image_size {
            Some(size) if size.contains(&0) => Err(CameraError::EmptyImage { size }),
            _ => Ok(self.resized(image_size)),
        }
    }

    /// The camera of a region of the image: its first pixel is `origin = [left, top]`, its size is `[width, height]`.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the region has no pixel, or is not inside the image where the camera knows its size.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{Camera, FrontParallel, Resizable};
    /// let camera = FrontParallel::new(10.0, [100.0, 200.0])?.with_image_size(Some([640, 480]))?;
    /// let region = camera.cropped([80, 160], [320, 240])?;
    /// assert_eq!(region.project([1.0, 2.0, 0.0]), [30.0, 20.0]);
    /// assert_eq!(region.image_size(), Some([320, 240]));
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    fn cropped(&self, origin: [u32; 2], size: [u32; 2]) -> Result<Self, CameraError> {
        let fits = |image: [u32; 2]| (0..2).all(|i| u64::from(origin[i]) + u64::from(size[i]) <= u64::from(image[i]));
        match self.image_size() {
            Some(image) if !fits(image) => Err(CameraError::OutsideImage { origin, size, image }),
            _ => self.resampled(1.0, origin.map(|c| -f64::from(c)))?.with_image_size(Some(size)),
        }
    }

    /// The camera of images of which `n` by `n` pixels become one; pixels that fill no square are left out at the right
    /// and at the bottom.
    ///
    /// Pixel centres are at integers: `u` becomes `(u + 0.5) / n - 0.5`.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if `n` is zero, or larger than the image.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{Camera, FrontParallel, Resizable};
    /// let camera = FrontParallel::new(10.0, [100.0, 200.0])?.with_image_size(Some([641, 480]))?;
    /// let binned = camera.binned(2)?;
    /// assert_eq!(binned.project([1.0, 2.0, 0.0]), [54.75, 89.75]);
    /// assert_eq!(binned.image_size(), Some([320, 240]));
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    fn binned(&self, n: u32) -> Result<Self, CameraError> {
        if n == 0 {
            return Err(CameraError::NotPositive { parameter: "binning", value: 0.0 });
        }
        let scale = 1.0 / f64::from(n);
        let size = self.image_size().map(|size| size.map(|pixels| pixels / n));
        self.resampled(scale, [0.5 * scale - 0.5; 2])?.with_image_size(size)
    }
}
