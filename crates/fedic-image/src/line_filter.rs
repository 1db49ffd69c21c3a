//! What is done along every row and every column of an image before it is interpolated: smoothing, then the prefilter of the
//! spline.
//!
//! Both are linear, symmetric about the borders and the same in each direction, so that they can follow each other line by line:
//! no smoothed image is ever held.

use crate::prefilter::{LANES, Prefilter};

/// A symmetric finite filter followed by the recursive one of a spline.
pub(crate) struct LineFilter<'a> {
    /// Weight of the samples at distance 0, 1, ... on either side.
    pub(crate) weights: &'a [f32],
    pub(crate) prefilter: Option<&'a Prefilter>,
}

impl LineFilter<'_> {
    /// Number of samples needed beyond each end of a line.
    pub(crate) fn radius(&self) -> usize {
        self.weights.len() - 1
    }

    /// Number of samples after which those further away no longer matter.
    pub(crate) fn warm_up(&self) -> usize {
        self.prefilter.map_or(0, Prefilter::warm_up)
    }

    /// Filters as many lines as there are lanes; `samples` begin and end [`radius`](Self::radius) further out than `lines`.
    #[inline(always)]
    pub(crate) fn apply(&self, samples: &[[f32; LANES]], lines: &mut [[f32; LANES]]) {
        let radius = self.weights.len() - 1;
        for (index, line) in lines.iter_mut().enumerate() {
            let window = &samples[index..=index + 2 * radius];
            let mut sum = [0.0; LANES];
            for lane in 0..LANES {
                sum[lane] = self.weights[0] * window[radius][lane];
            }
            for (weight, (before, after)) in
                self.weights[1..].iter().zip(window[..radius].iter().rev().zip(&window[radius + 1..]))
            {
                for lane in 0..LANES {
                    sum[lane] += weight * (before[lane] + after[lane]);
                }
            }
            *line = sum;
        }
        if let Some(prefilter) = self.prefilter {
            prefilter.apply(lines);
        }
    }
}
