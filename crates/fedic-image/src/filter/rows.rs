//! Smoothing of an image, row by row, by one symmetric set of weights in both directions.
//!
//! For results that are images. The preparation of an interpolation smooths line by line instead (see `line`) and stores no
//! smoothed image; it sums in another order, with results that differ by rounding.

use crate::filter::mirror::{mirror, mirror_ends};
use crate::view::ImageView;

/// A symmetric finite filter, applied down the columns and along the rows with mirrored borders.
pub(crate) struct RowFilter<'a> {
    view: ImageView<'a>,
    /// Weights of the samples at distance 0, 1, ... on either side.
    weights: &'a [f32],
    source: Vec<f32>,
    /// A row smoothed down the columns, with mirrored ends.
    padded: Vec<f32>,
}

impl<'a> RowFilter<'a> {
    /// The filter of an image with at least one weight, and the row buffers of one task.
    pub(crate) fn new(view: ImageView<'a>, weights: &'a [f32]) -> Self {
        let radius = weights.len() - 1;
        let (source, padded) = (vec![0.0; view.width()], vec![0.0; view.width() + 2 * radius]);
        Self { view, weights, source, padded }
    }

    /// Computes row `v` of the smoothed image.
    pub(crate) fn filter_row(&mut self, v: usize, out: &mut [f32]) {
        let (radius, width) = (self.weights.len() - 1, self.view.width());
        let columns = &mut self.padded[radius..radius + width];
        columns.fill(0.0);
        for start in 0..=2 * radius {
            let row = mirror((v + start) as isize - radius as isize, self.view.height());
            self.view.read_row(row, &mut self.source);
            add_scaled(columns, self.weights[start.abs_diff(radius)], &self.source);
        }
        mirror_ends(&mut self.padded, radius);
        out.fill(0.0);
        for start in 0..=2 * radius {
            add_scaled(out, self.weights[start.abs_diff(radius)], &self.padded[start..start + width]);
        }
    }
}

fn add_scaled(out: &mut [f32], factor: f32, source: &[f32]) {
    for (out, &value) in out.iter_mut().zip(source) {
        *out += factor * value;
    }
}
