//! What an interpolator reads: one coefficient per pixel, with a mirrored margin around them.
//!
//! The margin lets every stencil of the interpolation be read without asking whether it crosses the border. Coefficients are
//! filtered band of rows by band of rows, down the columns first. A band reads the picture itself, a little
//! above and below its own rows, and so depends on no other band: the influence of a sample dies out geometrically, and
//! beyond [`LineFilter::warm_up`] rows it is below rounding. No second image is needed, and each band stays in cache.

use std::ops::Range;

use fedic_memory::{Row, copy, prefetch};
use rayon::prelude::*;

use crate::lanes::Fusing;
use crate::line_filter::LineFilter;
use crate::mirror::{mirror, mirror_ends};
use crate::prefilter::LANES;
use crate::transposition::Transposition;
use crate::view::ImageView;

/// Rows and columns added on each side: enough for six taps half a pixel outside the outermost centres.
pub(crate) const PADDING: usize = 3;

/// Numbers after the last row, so that eight can be read where six are needed.
const SLACK: usize = 2;

/// Most coefficients asked for at once: half of the cache next to the processor.
const MOST_ASKED: usize = 4096;

/// Rows filtered by one task.
const BAND: usize = 256;

/// Coefficients of an image, row after row; that of pixel `(u, v)` is at row `v + PADDING`, column `u + PADDING`.
#[derive(Clone)]
pub(crate) struct Coefficients {
    stride: usize,
    data: Row<f32>,
}

impl Coefficients {
    /// The grey levels themselves, in `memory` where it is large enough.
    pub(crate) fn samples(view: ImageView<'_>, memory: Row<f32>) -> Self {
        Self::by_bands(view, memory, 1, |v, row| {
            view.read_row(v, &mut row[PADDING..PADDING + view.width()]);
            mirror_ends(row, PADDING);
        })
    }

    /// Those of the interpolant through the grey levels, filtered along each direction, in `memory` where it is large enough.
    pub(crate) fn filtered(view: ImageView<'_>, filter: &LineFilter<'_>, memory: Row<f32>) -> Self {
        let stride = view.width() + 2 * PADDING;
        Self::by_bands(view, memory, BAND, |v, band| FilterBand { view, filter, first: v, band, stride }.run_best())
    }

    /// Columns including the margin.
    #[inline]
    pub(crate) fn stride(&self) -> usize {
        self.stride
    }

    /// Asks the memory for the coefficients of these pixels, unless they are so many that the first would be gone when read.
    pub(crate) fn prefetch(&self, columns: Range<isize>, rows: Range<isize>) {
        let last = self.data.len() / self.stride;
        let within = |range: Range<isize>, end: usize| {
            let [start, stop] = [range.start, range.end].map(|x| (x.max(0) as usize).saturating_add(PADDING).min(end));
            start..stop
        };
        let (columns, rows) = (within(columns, self.stride), within(rows, last));
        if columns.is_empty() || columns.len() * rows.len() > MOST_ASKED {
            return;
        }
        for row in rows {
            let start = row * self.stride;
            prefetch(&self.data, start + columns.start, columns.len());
            prefetch(&self.data, start + columns.end - 1, 1);
        }
    }

    #[inline]
    pub(crate) fn as_slice(&self) -> &[f32] {
        &self.data
    }

    /// The memory that they take.
    pub(crate) fn into_memory(self) -> Row<f32> {
        self.data
    }

    /// Calls `fill(v, rows)` in parallel for bands of `band` rows that begin at row `v` of the image, then mirrors the rows
    /// above and below. All of `data` is written anew.
    fn by_bands(view: ImageView<'_>, mut data: Row<f32>, band: usize, fill: impl Fn(usize, &mut [f32]) + Sync) -> Self {
        let (stride, height) = (view.width() + 2 * PADDING, view.height());
        let count = stride * (height + 2 * PADDING) + SLACK;
        data.make_room(count);
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

/// Filters one band: down its columns, then along its rows.
struct FilterBand<'a> {
    view: ImageView<'a>,
    filter: &'a LineFilter<'a>,
    /// Row of the image that the band begins with.
    first: usize,
    band: &'a mut [f32],
    stride: usize,
}

impl FilterBand<'_> {
    /// Runs with the best instructions that the processor has.
    fn run_best(self) {
        #[cfg(target_arch = "x86_64")]
        if let Some(v3) = pulp::x86::V3::try_new() {
            return pulp::Simd::vectorize(v3, OnV3(self, v3));
        }
        self.run(pulp::Scalar);
    }

    #[inline(always)]
    fn run<S: Transposition>(self, simd: S) {
        filter_columns::<S>(self.view, self.filter, self.first, self.band, self.stride);
        filter_rows(simd, self.filter, self.band, self.stride);
    }
}

#[cfg(target_arch = "x86_64")]
struct OnV3<'a>(FilterBand<'a>, pulp::x86::V3);

#[cfg(target_arch = "x86_64")]
impl pulp::WithSimd for OnV3<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.0.run(self.1);
    }
}

/// Fills the interior columns of `band`, whose first row is row `first` of the image, with the picture filtered down its
/// columns.
#[inline(always)]
fn filter_columns<S: Fusing>(
    view: ImageView<'_>,
    filter: &LineFilter<'_>,
    first: usize,
    band: &mut [f32],
    stride: usize,
) {
    let above = filter.warm_up().min(first);
    let rows = (first - above)..(first + band.len() / stride + filter.warm_up()).min(view.height());
    let radius = filter.radius();
    let mut samples = vec![[0.0; LANES]; rows.len() + 2 * radius];
    let mut u = 0;
    while u < view.width() {
        let lanes = LANES.min(view.width() - u);
        for (index, sample) in samples.iter_mut().enumerate() {
            // Steps down an image are steps in memory that the processor does not foresee: what the next strip reads is asked for,
            // and where this one will be written.
            if let Some(row) = index.checked_sub(above + radius) {
                let start = row * stride + PADDING + u;
                prefetch(band, start, LANES + 1);
            }
            let v = mirror((rows.start + index) as isize - radius as isize, view.height());
            view.prefetch(v, u + LANES);
            match lanes {
                LANES => view.read_segment(v, u, sample),
                lanes => view.read_segment(v, u, &mut sample[..lanes]),
            }
        }
        let lines = filter.apply::<S>(&mut samples);
        for (row, line) in band.chunks_exact_mut(stride).zip(&lines[above..]) {
            copy::<LANES, _>(&mut row[PADDING + u..PADDING + u + lanes], line);
        }
        u += LANES;
    }
}

/// Filters `band` along its rows and mirrors their ends.
#[inline(always)]
fn filter_rows<S: Transposition>(simd: S, filter: &LineFilter<'_>, band: &mut [f32], stride: usize) {
    let (width, radius) = (stride - 2 * PADDING, filter.radius());
    let mut samples = vec![[0.0; LANES]; width + 2 * radius];
    for rows in band.chunks_mut(LANES * stride) {
        let count = rows.len() / stride;
        simd.transpose([count, width], &rows[PADDING..], stride, samples[radius..].as_flattened_mut(), LANES);
        for distance in 1..=radius {
            samples[radius - distance] = samples[radius + mirror(-(distance as isize), width)];
            samples[radius + width - 1 + distance] = samples[radius + mirror((width - 1 + distance) as isize, width)];
        }
        let lines = filter.apply::<S>(&mut samples);
        simd.transpose([width, count], lines.as_flattened(), LANES, &mut rows[PADDING..], stride);
        rows.chunks_exact_mut(stride).for_each(|row| mirror_ends(row, PADDING));
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
        let bell = [0.5, 0.2, 0.05];
        let filters = [(&[1.0][..], Some(&CUBIC)), (&[1.0], Some(&QUINTIC)), (&bell, Some(&QUINTIC)), (&bell, None)];
        for (weights, prefilter) in filters {
            let filter = LineFilter { weights, prefilter };
            let found = Coefficients::filtered(view, &filter, Row::default());
            let mut whole = vec![0.0; found.stride * height];
            filter_columns::<pulp::Scalar>(view, &filter, 0, &mut whole, found.stride);
            filter_rows(pulp::Scalar, &filter, &mut whole, found.stride);
            for (found, expected) in found.data[PADDING * found.stride..].iter().zip(&whole) {
                assert!((found - expected).abs() < 1e-3, "{found} {expected}");
            }
        }
    }

    #[test]
    fn margin_mirrors_the_interior() {
        let data: Vec<f32> = (0..20).map(|i| i as f32).collect();
        let found = Coefficients::samples(ImageView::of_checked(5, 4, &data), Row::default());
        for row in 0..4 + 2 * PADDING {
            for column in 0..5 + 2 * PADDING {
                let u = mirror(column as isize - PADDING as isize, 5);
                let v = mirror(row as isize - PADDING as isize, 4);
                assert_eq!(found.data[row * found.stride + column], data[v * 5 + u]);
            }
        }
    }
}
