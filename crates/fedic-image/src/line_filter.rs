//! What is done along every row and every column of an image before it is interpolated: smoothing, then the prefilter of the
//! spline.
//!
//! Both are linear, symmetric about the borders and the same in each direction, so that they can follow each other line by line:
//! no smoothed image is ever held.

use crate::lanes::{Fusing, fused};
use crate::prefilter::{LANES, Prefilter};

/// A symmetric finite filter followed by the recursive one of a spline.
pub(crate) struct LineFilter<'a> {
    /// Weight of the samples at distance 0, 1, ... on either side; they add up to one.
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

    /// Filters as many lines as there are lanes, in place: of samples that begin and end [`radius`](Self::radius) further out than
    /// the lines, the first become these, which are returned.
    #[inline(always)]
    pub(crate) fn apply<'a, S: Fusing>(&self, samples: &'a mut [[f32; LANES]]) -> &'a [[f32; LANES]] {
        let radius = self.radius();
        let count = samples.len() - 2 * radius;
        // A weight alone is one.
        let smoothed = if radius > 0 { count } else { 0 };
        for index in 0..smoothed {
            let window = &samples[index..=index + 2 * radius];
            let mut sum = window[radius].map(|sample| self.weights[0] * sample);
            let pairs = window[..radius].iter().rev().zip(&window[radius + 1..]);
            for (&weight, (before, after)) in self.weights[1..].iter().zip(pairs) {
                for lane in 0..LANES {
                    sum[lane] = fused::<S>(weight, before[lane] + after[lane], sum[lane]);
                }
            }
            samples[index] = sum;
        }
        let lines = &mut samples[..count];
        if let Some(prefilter) = self.prefilter {
            prefilter.apply::<S>(lines);
        }
        lines
    }
}
