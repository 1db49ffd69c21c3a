//! An image filtered in both directions, band of rows by band of rows.
//!
//! A band is filtered down its columns first, from the source image itself, a few rows above and below the band included:
//! the influence of a sample decays geometrically and is below rounding beyond [`LineFilter::warm_up`] rows. So no band
//! depends on another, no second image is needed, and each band stays in cache.

use fedic_memory::prefetch;
use rayon::prelude::*;

use crate::filter::line::LineFilter;
use crate::filter::mirror::{mirror, mirror_ends};
use crate::filter::prefilter::LINES;
use crate::simd::transpose::Transpose;
use crate::view::ImageView;

/// Rows filtered by one task.
pub(crate) const BAND: usize = 256;

/// Filters an image along both directions into `out`, in parallel: rows of the width plus a `margin` on either side, which
/// is filled by reflection.
pub(crate) fn filter_image(view: ImageView<'_>, filter: &LineFilter<'_>, out: &mut [f32], margin: usize) {
    let stride = view.width() + 2 * margin;
    out.par_chunks_mut(BAND * stride)
        .enumerate()
        .for_each(|(index, band)| Band { view, filter, first: index * BAND, band, margin }.run_best());
}

/// The task of filtering one band.
struct Band<'a> {
    view: ImageView<'a>,
    filter: &'a LineFilter<'a>,
    /// First row of the band in the image.
    first: usize,
    band: &'a mut [f32],
    margin: usize,
}

impl Band<'_> {
    /// Runs with the best instruction set of the processor.
    fn run_best(self) {
        #[cfg(target_arch = "x86_64")]
        if let Some(v3) = pulp::x86::V3::try_new() {
            return pulp::Simd::vectorize(v3, OnV3(self, v3));
        }
        self.run(pulp::Scalar);
    }

    #[inline(always)]
    fn run<S: Transpose>(mut self, simd: S) {
        self.filter_columns::<S>();
        self.filter_rows(simd);
    }

    /// Fills the band, without its margins, with the source image filtered down the columns.
    #[inline(always)]
    fn filter_columns<S: Transpose>(&mut self) {
        let Self { view, filter, first, margin, .. } = *self;
        let stride = view.width() + 2 * margin;
        let above = filter.warm_up().min(first);
        let rows = (first - above)..(first + self.band.len() / stride + filter.warm_up()).min(view.height());
        let radius = filter.radius();
        let mut samples = vec![[0.0; LINES]; rows.len() + 2 * radius];
        let mut u = 0;
        while u < view.width() {
            let lines = LINES.min(view.width() - u);
            for (index, sample) in samples.iter_mut().enumerate() {
                // Hardware prefetchers do not follow the steps from row to row: prefetch the source of the next strip
                // and the destination of this one.
                if let Some(row) = index.checked_sub(above + radius) {
                    let start = row * stride + margin + u;
                    prefetch(self.band, start, LINES + 1);
                }
                let v = mirror((rows.start + index) as isize - radius as isize, view.height());
                view.prefetch(v, u + LINES);
                match lines {
                    LINES => view.read_segment(v, u, sample),
                    lines => view.read_segment(v, u, &mut sample[..lines]),
                }
            }
            let filtered = filter.apply::<S>(&mut samples);
            for (row, filtered) in self.band.chunks_exact_mut(stride).zip(&filtered[above..]) {
                // A full strip is copied without a call to `memcpy`.
                match <&mut [f32; LINES]>::try_from(&mut row[margin + u..margin + u + lines]) {
                    Ok(row) => *row = *filtered,
                    Err(_) => row[margin + u..margin + u + lines].copy_from_slice(&filtered[..lines]),
                }
            }
            u += LINES;
        }
    }

    /// Filters the band along its rows and fills their margins.
    #[inline(always)]
    fn filter_rows<S: Transpose>(&mut self, simd: S) {
        let Self { filter, margin, .. } = *self;
        let (width, radius) = (self.view.width(), filter.radius());
        let stride = width + 2 * margin;
        let mut samples = vec![[0.0; LINES]; width + 2 * radius];
        for rows in self.band.chunks_mut(LINES * stride) {
            let count = rows.len() / stride;
            simd.transpose([count, width], &rows[margin..], stride, samples[radius..].as_flattened_mut(), LINES);
            for distance in 1..=radius {
                samples[radius - distance] = samples[radius + mirror(-(distance as isize), width)];
                samples[radius + width - 1 + distance] =
                    samples[radius + mirror((width - 1 + distance) as isize, width)];
            }
            let lines = filter.apply::<S>(&mut samples);
            simd.transpose([width, count], lines.as_flattened(), LINES, &mut rows[margin..], stride);
            rows.chunks_exact_mut(stride).for_each(|row| mirror_ends(row, margin));
        }
    }
}

#[cfg(target_arch = "x86_64")]
struct OnV3<'a>(Band<'a>, pulp::x86::V3);

#[cfg(target_arch = "x86_64")]
impl pulp::WithSimd for OnV3<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.0.run(self.1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_agree_with_the_image_filtered_as_a_whole() {
        // A partial strip of lines, and several bands, the last one of a single row.
        let (width, height) = (LINES + 5, 2 * BAND + 1);
        let noise: Vec<f32> = (0..width * height).map(|i| (i * i * 7919 / 13 % 256) as f32).collect();
        let view = ImageView::new_unchecked(width, height, &noise);
        let (bell, cubic, quintic) = ([0.5, 0.2, 0.05], [-0.267_949], [-0.430_575, -0.043_096]);
        let filters: [(&[f32], &[f64]); 4] = [(&[1.0], &cubic), (&[1.0], &quintic), (&bell, &quintic), (&bell, &[])];
        for (weights, poles) in filters {
            for margin in [0, 3] {
                let filter = LineFilter { weights, poles };
                let size = (width + 2 * margin) * height;
                let (mut bands, mut whole) = (vec![-1.0; size], vec![-1.0; size]);
                filter_image(view, &filter, &mut bands, margin);
                Band { view, filter: &filter, first: 0, band: &mut whole, margin }.run(pulp::Scalar);
                for (found, expected) in bands.iter().zip(&whole) {
                    assert!((found - expected).abs() < 1e-3, "{found} {expected}");
                }
            }
        }
    }
}
