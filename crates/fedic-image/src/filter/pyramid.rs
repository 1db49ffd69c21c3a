//! One level of an image pyramid from the next finer one.

use rayon::prelude::*;

use crate::error::ImageError;
use crate::filter::mirror::{mirror, mirror_ends};
use crate::image::Image;
use crate::view::{ImageView, MIN_SIZE};

/// Binomial weights at the distances -2 to 2.
const WEIGHTS: [f32; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];
const RADIUS: usize = WEIGHTS.len() / 2;

/// The image at half its resolution: the REDUCE step of Burt and Adelson (1983).
///
/// The image is smoothed by `[1 4 6 4 1] / 16` in both directions, mirrored at the border, and sampled at every other
/// pixel: pixel `(u, v)` of the result is centred on pixel `(2 u, 2 v)` of the source. A size `n` becomes `ceil(n / 2)`.
///
/// # Errors
///
/// [`ImageError::TooSmall`], with the sizes of the result, if they are below [`MIN_SIZE`].
///
/// # Examples
///
/// ```
/// use fedic_image::{Image, downsample};
///
/// let image = Image::new(9, 8, vec![3.0; 72])?;
/// let half = downsample(image.view())?;
/// assert_eq!((half.width(), half.height()), (5, 4));
/// assert!(downsample(half.view()).is_err());
/// # Ok::<(), fedic_image::ImageError>(())
/// ```
pub fn downsample(view: ImageView<'_>) -> Result<Image, ImageError> {
    let (width, height) = (view.width().div_ceil(2), view.height().div_ceil(2));
    if width < MIN_SIZE || height < MIN_SIZE {
        return Err(ImageError::TooSmall { width, height, minimum: MIN_SIZE });
    }
    let mut data = vec![0.0; width * height];
    data.par_chunks_mut(width).enumerate().for_each_init(
        || Scratch::new(view.width()),
        |scratch, (v, row)| {
            let smoothed = scratch.smooth_row(view, 2 * v);
            for (out, &value) in row.iter_mut().zip(smoothed.iter().step_by(2)) {
                *out = value;
            }
        },
    );
    Ok(Image::new_unchecked(width, height, data))
}

/// Row buffers of one task. Only the rows that remain are smoothed.
struct Scratch {
    source: Vec<f32>,
    /// A row smoothed down the columns, with mirrored ends.
    padded: Vec<f32>,
    smoothed: Vec<f32>,
}

impl Scratch {
    fn new(width: usize) -> Self {
        Self { source: vec![0.0; width], padded: vec![0.0; width + 2 * RADIUS], smoothed: vec![0.0; width] }
    }

    /// Row `v` of the smoothed image.
    fn smooth_row(&mut self, view: ImageView<'_>, v: usize) -> &[f32] {
        let width = view.width();
        let columns = &mut self.padded[RADIUS..RADIUS + width];
        columns.fill(0.0);
        for (index, weight) in WEIGHTS.into_iter().enumerate() {
            let row = mirror((v + index) as isize - RADIUS as isize, view.height());
            view.read_row(row, &mut self.source);
            add_scaled(columns, weight, &self.source);
        }
        mirror_ends(&mut self.padded, RADIUS);
        self.smoothed.fill(0.0);
        for (start, weight) in WEIGHTS.into_iter().enumerate() {
            add_scaled(&mut self.smoothed, weight, &self.padded[start..start + width]);
        }
        &self.smoothed
    }
}

fn add_scaled(out: &mut [f32], factor: f32, source: &[f32]) {
    for (out, &value) in out.iter_mut().zip(source) {
        *out += factor * value;
    }
}
