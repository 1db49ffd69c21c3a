//! The filter applied along every row and every column of an image: smoothing, then the B-spline prefilter.
//!
//! Both are linear, symmetric about the borders and the same in each direction, so one follows the other line by line and
//! no smoothed image is stored.

use crate::filter::prefilter::{self, LINES};
use crate::simd::lanes::{Fusing, fused};

/// A symmetric finite filter, followed by the recursive prefilter of a B-spline.
#[derive(Clone, Copy)]
pub(crate) struct LineFilter<'a> {
    /// Weights of the samples at distance 0, 1, ... on either side; together they sum to one.
    pub(crate) weights: &'a [f32],
    /// Poles of the B-spline prefilter; none leaves the samples as they are.
    pub(crate) poles: &'a [f64],
}

impl LineFilter<'_> {
    /// True if the filter leaves every image unchanged.
    pub(crate) fn is_identity(&self) -> bool {
        self.radius() == 0 && self.poles.is_empty()
    }

    /// Number of samples needed beyond each end of a line.
    pub(crate) fn radius(&self) -> usize {
        self.weights.len() - 1
    }

    /// Distance in samples beyond which a sample has no influence in `f32`.
    pub(crate) fn warm_up(&self) -> usize {
        prefilter::warm_up(self.poles)
    }

    /// Filters [`LINES`] lines in place. `samples` extends [`radius`](Self::radius) samples beyond both ends of the lines;
    /// the filtered lines are stored at its beginning and returned.
    #[inline(always)]
    pub(crate) fn apply<'a, S: Fusing>(&self, samples: &'a mut [[f32; LINES]]) -> &'a [[f32; LINES]] {
        let radius = self.radius();
        let count = samples.len() - 2 * radius;
        // A single weight equals one.
        let smoothed = if radius > 0 { count } else { 0 };
        for index in 0..smoothed {
            let window = &samples[index..=index + 2 * radius];
            let mut sum = window[radius].map(|sample| self.weights[0] * sample);
            let pairs = window[..radius].iter().rev().zip(&window[radius + 1..]);
            for (&weight, (before, after)) in self.weights[1..].iter().zip(pairs) {
                for line in 0..LINES {
                    sum[line] = fused::<S>(weight, before[line] + after[line], sum[line]);
                }
            }
            samples[index] = sum;
        }
        let lines = &mut samples[..count];
        prefilter::apply::<S>(self.poles, lines);
        lines
    }
}
