//! What an interpolator reads: one coefficient per pixel, with a mirrored margin around them.
//!
//! The margin lets every stencil of the interpolation be read without asking whether it crosses the border. B-spline
//! coefficients are computed band of rows by band of rows, down the columns first. A band reads the picture itself, a little
//! above and below its own rows, and so depends on no other band: the influence of a sample dies out geometrically, and
//! beyond [`Prefilter::warm_up`] rows it is below rounding. No second image is needed, and each band stays in cache.

use rayon::prelude::*;

use crate::mirror::{mirror, mirror_ends};
use crate::prefilter::{LANES, Prefilter};
use crate::view::ImageView;

/// Rows and columns added on each side: enough for six taps half a pixel outside the outermost centres.
pub(crate) const PADDING: usize = 3;

/// Rows filtered by one task.
const BAND: usize = 128;

/// Coefficients of an image, row after row; that of pixel `(u, v)` is at row `v + PADDING`, column `u + PADDING`.
#[derive(Clone)]
pub(crate) struct Coefficients {
    stride: usize,
    data: Vec<f32>,
}

impl Coefficients {
    /// The grey levels themselves.
    pub(crate) fn samples(view: ImageView<'_>) -> Self {
        Self::by_bands(view, 1, |v, row| {
            view.read_row(v, &mut row[PADDING..PADDING + view.width()]);
            mirror_ends(row, PADDING);
        })
    }

    /// Those of the B-spline through the grey levels.
    pub(crate) fn bspline(view: ImageView<'_>, prefilter: &Prefilter) -> Self {
        let stride = view.width() + 2 * PADDING;
        Self::by_bands(view, BAND, |v, band| {
            filter_columns(view, prefilter, v, band, stride);
            filter_rows(prefilter, band, stride);
        })
    }

    /// Columns including the margin.
    #[inline]
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    #[inline]
    pub(crate) fn as_slice(&self) -> &[f32] {
        &self.data
    }

    /// Calls `fill(v, rows)` in parallel for bands of `band` rows that begin at row `v` of the image, then mirrors the rows
    /// above and below.
    fn by_bands(view: ImageView<'_>, band: usize, fill: impl Fn(usize, &mut [f32]) + Sync) -> Self {
        let (stride, height) = (view.width() + 2 * PADDING, view.height());
        let mut data = vec![0.0; stride * (height + 2 * PADDING) + 4];
        data[PADDING * stride..(PADDING + height) * stride]
            .par_chunks_mut(band * stride)
            .enumerate()
            .for_each(|(index, rows)| fill(index * band, rows));
        let margins = (0..PADDING).chain(PADDING + height..2 * PADDING + height);
        for row in margins {
            let source = PADDING + mirror(row as isize - PADDING as isize, height);
            data.copy_within(source * stride..(source + 1) * stride, row * stride);
        }
        Self { stride, data }
    }
}

/// Fills the interior columns of `band`, whose first row is row `first` of the image, with the picture filtered down its
/// columns.
fn filter_columns(view: ImageView<'_>, prefilter: &Prefilter, first: usize, band: &mut [f32], stride: usize) {
    let above = prefilter.warm_up().min(first);
    let rows = (first - above)..(first + band.len() / stride + prefilter.warm_up()).min(view.height());
    let mut lines = vec![[0.0; LANES]; rows.len()];
    for u in (0..view.width()).step_by(LANES) {
        let lanes = LANES.min(view.width() - u);
        for (v, line) in rows.clone().zip(&mut lines) {
            view.read_segment(v, u, &mut line[..lanes]);
        }
        prefilter.apply(&mut lines);
        for (row, line) in band.chunks_exact_mut(stride).zip(&lines[above..]) {
            row[PADDING + u..PADDING + u + lanes].copy_from_slice(&line[..lanes]);
        }
    }
}

/// Filters `band` along its rows and mirrors their ends.
fn filter_rows(prefilter: &Prefilter, band: &mut [f32], stride: usize) {
    let interior = PADDING..stride - PADDING;
    let mut lines = vec![[0.0; LANES]; interior.len()];
    for rows in band.chunks_mut(LANES * stride) {
        for (lane, row) in rows.chunks_exact(stride).enumerate() {
            for (line, &value) in lines.iter_mut().zip(&row[interior.clone()]) {
                line[lane] = value;
            }
        }
        prefilter.apply(&mut lines);
        for (lane, row) in rows.chunks_exact_mut(stride).enumerate() {
            for (line, value) in lines.iter().zip(&mut row[interior.clone()]) {
                *value = line[lane];
            }
            mirror_ends(row, PADDING);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::prefilter::{CUBIC, QUINTIC};

    /// A width that leaves a partial strip of lanes, a height of several bands, the last one of a single row.
    const SIZE: (usize, usize) = (LANES + 5, 2 * BAND + 1);

    #[test]
    fn bands_leave_no_trace() {
        let (width, height) = SIZE;
        let noise: Vec<f32> = (0..width * height).map(|i| (i * i * 7919 / 13 % 256) as f32).collect();
        let view = ImageView::of_checked(width, height, &noise);
        for prefilter in [&CUBIC, &QUINTIC] {
            let found = Coefficients::bspline(view, prefilter);
            let mut whole = vec![0.0; found.stride * height];
            filter_columns(view, prefilter, 0, &mut whole, found.stride);
            filter_rows(prefilter, &mut whole, found.stride);
            for (found, expected) in found.data[PADDING * found.stride..].iter().zip(&whole) {
                assert!((found - expected).abs() < 1e-3, "{found} {expected}");
            }
        }
    }

    #[test]
    fn margin_mirrors_the_interior() {
        let data: Vec<f32> = (0..20).map(|i| i as f32).collect();
        let found = Coefficients::samples(ImageView::of_checked(5, 4, &data));
        for row in 0..4 + 2 * PADDING {
            for column in 0..5 + 2 * PADDING {
                let u = mirror(column as isize - PADDING as isize, 5);
                let v = mirror(row as isize - PADDING as isize, 4);
                assert_eq!(found.data[row * found.stride + column], data[v * 5 + u]);
            }
        }
    }
}
