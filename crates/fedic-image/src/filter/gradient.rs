//! Central differences.

use rayon::prelude::*;

use crate::filter::mirror::mirror;
use crate::image::Image;
use crate::view::ImageView;

/// Central differences along the columns `u` and along the rows `v`, in grey levels per pixel: `(f[i + 1] - f[i - 1]) / 2`.
///
/// The border is mirrored, so that the derivative across it is zero there.
///
/// # Examples
///
/// ```
/// use fedic_image::{Image, central_differences};
///
/// let ramp: Vec<f32> = (0..20).map(|index| (index % 5) as f32).collect();
/// let (du, dv) = central_differences(Image::new(5, 4, ramp)?.view());
/// assert_eq!(du.pixels()[..5], [0.0, 1.0, 1.0, 1.0, 0.0]);
/// assert!(dv.pixels().iter().all(|&derivative| derivative == 0.0));
/// # Ok::<(), fedic_image::ImageError>(())
/// ```
#[must_use]
pub fn central_differences(view: ImageView<'_>) -> (Image, Image) {
    let (width, height) = (view.width(), view.height());
    let (mut du, mut dv) = (vec![0.0; width * height], vec![0.0; width * height]);
    du.par_chunks_mut(width).zip(dv.par_chunks_mut(width)).enumerate().for_each_init(
        || vec![0.0; width],
        |source, (v, (du, dv))| {
            view.read_row(v, source);
            for (derivative, neighbours) in du[1..].iter_mut().zip(source.windows(3)) {
                *derivative = 0.5 * (neighbours[2] - neighbours[0]);
            }
            view.read_row(mirror(v as isize - 1, height), source);
            view.read_row(mirror(v as isize + 1, height), dv);
            for (derivative, &above) in dv.iter_mut().zip(&*source) {
                *derivative = 0.5 * (*derivative - above);
            }
        },
    );
    (Image::new_unchecked(width, height, du), Image::new_unchecked(width, height, dv))
}
