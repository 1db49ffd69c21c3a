//! The mean of a texture over each pixel of an image.

use fedic_camera::{Camera, unproject_aperture, unproject_with_jacobian};
use rayon::prelude::*;

use crate::displacement::{DisplacementField, Ray, material_points};
use crate::error::SyntheticError;
use crate::plane::{Plane, PlaneCamera};
use crate::rendering::Rendering;
use crate::texture::Texture;

/// Sample points rendered together, unless one row of pixels has more.
const POINTS_PER_CHUNK: usize = 500_000;

/// Pixels per parallel task, at the least.
const MIN_PIXELS_PER_TASK: usize = 1024;

/// Renders surfaces as a camera sees them.
///
/// A pixel is the mean of the texture over its square aperture, sampled at `samples` by `samples` points. The centre of the
/// pixel is unprojected to the surface through the camera, lens included (Newton's method), and the samples around it
/// follow through the derivatives there: their error is of the second order in the size of the pixel.
#[derive(Clone, Copy)]
pub struct Render<'a> {
    camera: &'a dyn Camera,
    size: [usize; 2],
    samples: u32,
    progress: &'a dyn Fn(f64) -> bool,
}

impl<'a> Render<'a> {
    /// Images of `size`, columns and rows, with 3 by 3 samples per pixel.
    #[must_use]
    pub fn new(camera: &'a dyn Camera, size: [usize; 2]) -> Self {
        Self { camera, size, samples: 3, progress: &|_| true }
    }

    /// Uses `samples` by `samples` points per pixel.
    #[must_use]
    pub fn with_samples(mut self, samples: u32) -> Self {
        self.samples = samples;
        self
    }

    /// Calls `progress` now and then with the fraction done, on the calling thread; the rendering stops if it returns false.
    #[must_use]
    pub fn with_progress(mut self, progress: &'a dyn Fn(f64) -> bool) -> Self {
        self.progress = progress;
        self
    }

    /// A textured plane at rest. For a plane after a rigid motion, see [`Plane::moved`].
    ///
    /// # Errors
    ///
    /// [`SyntheticError::InvalidOption`] if a size or the number of samples is zero, [`SyntheticError::NotVisible`] if a pixel
    /// sees no point of the plane, [`SyntheticError::TooLarge`], [`SyntheticError::Cancelled`].
    pub fn plane(&self, plane: &Plane, texture: &dyn Texture) -> Result<Rendering, SyntheticError> {
        self.run(plane, texture, None)
    }

    /// A textured plane whose material points, given in space, have been displaced, within the plane or out of it.
    ///
    /// # Errors
    ///
    /// Those of [`plane`](Self::plane), [`SyntheticError::NotInvertible`] if the gradient of the displacement is not well
    /// below 1, [`SyntheticError::Displacement`] if `field` fails.
    pub fn displaced_plane(
        &self,
        plane: &Plane,
        texture: &dyn Texture,
        field: &dyn DisplacementField,
    ) -> Result<Rendering, SyntheticError> {
        self.run(plane, texture, Some(field))
    }

    fn run(
        &self,
        plane: &Plane,
        texture: &dyn Texture,
        field: Option<&dyn DisplacementField>,
    ) -> Result<Rendering, SyntheticError> {
        let [width, height] = self.size;
        for (option, value) in [("width", width), ("height", height), ("samples", self.samples as usize)] {
            if value == 0 {
                let (expected, value) = ("at least 1", value.to_string());
                return Err(SyntheticError::InvalidOption { option, expected, value });
            }
        }
        let samples_per_pixel = (self.samples as usize).saturating_pow(2);
        let samples_per_row = width.saturating_mul(samples_per_pixel);
        let rows_per_chunk = (POINTS_PER_CHUNK / samples_per_row).max(1);
        let camera = PlaneCamera { camera: self.camera, plane: *plane };
        let mut values = with_capacity(width.saturating_mul(height))?;
        for first in (0..height).step_by(rows_per_chunk) {
            let rows = [first, height.min(first + rows_per_chunk)];
            let points = match field {
                None => self.aperture(&camera, rows)?,
                Some(field) => material_points(plane, &self.rays(&camera, rows)?, field)?,
            };
            let samples = texture.values(&points);
            values.par_extend(samples.par_chunks_exact(samples_per_pixel).map(mean));
            if !(self.progress)(rows[1] as f64 / height as f64) {
                return Err(SyntheticError::Cancelled);
            }
        }
        Ok(Rendering::new(width, values))
    }

    /// Coordinates, in the plane, of the samples of the pixels in some rows.
    fn aperture(&self, camera: &PlaneCamera<'_>, rows: [usize; 2]) -> Result<Vec<[f64; 2]>, SyntheticError> {
        let samples = self.samples;
        self.for_each_pixel(rows, |pixel, points| {
            let found = unproject_aperture(camera, pixel, 0.0, samples)?;
            points.iter_mut().zip(found).for_each(|(point, found)| *point = found);
            Some(())
        })
    }

    /// Rays through the samples of the pixels in some rows. All those of a pixel have the slope of its centre's.
    fn rays(&self, camera: &PlaneCamera<'_>, rows: [usize; 2]) -> Result<Vec<Ray>, SyntheticError> {
        let samples = self.samples;
        self.for_each_pixel(rows, |pixel, rays| {
            let (centre, inverse) = unproject_with_jacobian(camera, pixel, 0.0)?;
            let (_, [[.., du], [.., dv]]) = camera.project_with_jacobian(centre);
            let slope = inverse.map(|row| -(row[0] * du + row[1] * dv));
            let found = unproject_aperture(camera, pixel, 0.0, samples)?;
            rays.iter_mut().zip(found).for_each(|(ray, foot)| *ray = Ray { foot, slope });
            Some(())
        })
    }

    /// Fills the samples of each pixel in some rows, in parallel.
    fn for_each_pixel<T: Default + Copy + Send>(
        &self,
        rows: [usize; 2],
        fill: impl Fn([f64; 2], &mut [T]) -> Option<()> + Sync,
    ) -> Result<Vec<T>, SyntheticError> {
        let width = self.size[0];
        let (total, per_pixel) = ((rows[1] - rows[0]) * width, (self.samples as usize).saturating_pow(2));
        let count = total.saturating_mul(per_pixel);
        let mut samples = with_capacity(count)?;
        samples.resize(count, T::default());
        let pixel = |index: usize| [index % width, rows[0] + index / width];
        let pixels = samples.par_chunks_exact_mut(per_pixel).with_min_len(MIN_PIXELS_PER_TASK).enumerate();
        let failed: Vec<usize> = pixels
            .filter_map(|(index, samples)| fill(pixel(index).map(|c| c as f64), samples).is_none().then_some(index))
            .collect();
        match failed.first() {
            None => Ok(samples),
            Some(&first) => Err(SyntheticError::NotVisible { pixel: pixel(first), count: failed.len(), total, rows }),
        }
    }
}

fn with_capacity<T>(count: usize) -> Result<Vec<T>, SyntheticError> {
    let mut vector = Vec::new();
    vector.try_reserve_exact(count).map_err(|_| SyntheticError::TooLarge { count })?;
    Ok(vector)
}

fn mean(samples: &[f64]) -> f64 {
    pairwise_sum(samples) / samples.len() as f64
}

/// The sum in the order of `numpy.sum`: eight partial sums per block of at most 128 numbers.
fn pairwise_sum(numbers: &[f64]) -> f64 {
    let count = numbers.len();
    if count < 8 {
        return numbers.iter().sum();
    }
    if count > 128 {
        let half = count / 2 / 8 * 8;
        return pairwise_sum(&numbers[..half]) + pairwise_sum(&numbers[half..]);
    }
    let (blocks, rest) = numbers.as_chunks::<8>();
    let mut sums = [0.0; 8];
    for block in blocks {
        for (sum, number) in sums.iter_mut().zip(block) {
            *sum += number;
        }
    }
    let [a, b, c, d, e, f, g, h] = sums;
    rest.iter().fold(((a + b) + (c + d)) + ((e + f) + (g + h)), |sum, number| sum + number)
}
