//! Smoothing by one symmetric set of weights along the columns, then along the rows.

use crate::mirror::{mirror, mirror_ends};
use crate::view::ImageView;

/// A symmetric finite filter, applied in both directions with mirrored borders.
pub(crate) struct SymmetricFilter {
    /// Weight of the samples at distance 0, 1, ... on either side.
    weights: Vec<f32>,
}

/// Working memory of one task.
pub(crate) struct Scratch {
    source: Vec<f32>,
    padded: Vec<f32>,
}

impl SymmetricFilter {
    /// The filter with these weights at distance 0, 1, ...; there must be at least one.
    pub(crate) fn new(weights: Vec<f32>) -> Self {
        Self { weights }
    }

    /// Working memory for the rows of `view`.
    pub(crate) fn scratch(&self, view: ImageView<'_>) -> Scratch {
        Scratch { source: vec![0.0; view.width()], padded: vec![0.0; view.width() + 2 * self.radius()] }
    }

    /// Row `v` of the filtered image.
    pub(crate) fn filter_row(&self, view: ImageView<'_>, v: usize, scratch: &mut Scratch, out: &mut [f32]) {
        let (radius, width) = (self.radius(), view.width());
        let smoothed = &mut scratch.padded[radius..radius + width];
        smoothed.fill(0.0);
        for offset in -(radius as isize)..=radius as isize {
            view.read_row(mirror(v as isize + offset, view.height()), &mut scratch.source);
            add_scaled(smoothed, self.weights[offset.unsigned_abs()], &scratch.source);
        }
        mirror_ends(&mut scratch.padded, radius);
        out.fill(0.0);
        for start in 0..=2 * radius {
            add_scaled(out, self.weights[start.abs_diff(radius)], &scratch.padded[start..start + width]);
        }
    }

    fn radius(&self) -> usize {
        self.weights.len() - 1
    }
}

fn add_scaled(out: &mut [f32], factor: f32, source: &[f32]) {
    for (out, &value) in out.iter_mut().zip(source) {
        *out += factor * value;
    }
}
