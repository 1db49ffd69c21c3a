//! Moments of grey levels and weighted residuals.

use pulp::{Simd, WithSimd};

use crate::kernels::dispatch::{FLUSH, run};

/// Weighted sum of grey levels, counted from `origin`, and of their squares. Both vanish for an image flat at `origin`.
pub(crate) fn moments(grey: &[f32], weights: &[f32], origin: f32) -> [f64; 2] {
    run(Moments { grey, weights, origin })
}

struct Moments<'a> {
    grey: &'a [f32],
    weights: &'a [f32],
    origin: f32,
}

impl WithSimd for Moments<'_> {
    type Output = [f64; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f64; 2] {
        let (grey, weights) = (S::as_simd_f32s(self.grey).0, S::as_simd_f32s(self.weights).0);
        let origin = simd.splat_f32s(self.origin);
        let mut totals = [0.0; 2];
        for (grey, weights) in grey.chunks(FLUSH).zip(weights.chunks(FLUSH)) {
            let (mut sum, mut squares) = (simd.splat_f32s(0.0), simd.splat_f32s(0.0));
            for (&grey, &weight) in grey.iter().zip(weights) {
                let counted = simd.sub_f32s(grey, origin);
                let weighted = simd.mul_f32s(weight, counted);
                sum = simd.add_f32s(weighted, sum);
                squares = simd.mul_add_e_f32s(weighted, counted, squares);
            }
            totals[0] += f64::from(simd.reduce_sum_f32s(sum));
            totals[1] += f64::from(simd.reduce_sum_f32s(squares));
        }
        totals
    }
}

/// Grey levels of both images at the points of a chunk.
#[derive(Clone, Copy)]
pub(crate) struct GreyLevels<'a> {
    pub(crate) reference: &'a [f32],
    pub(crate) deformed: &'a [f32],
    pub(crate) weights: &'a [f32],
    /// Gain and offset applied to the deformed image.
    pub(crate) gain_offset: [f32; 2],
}

/// Writes the weighted residuals `w r`, `r = f - (gain g + offset)`, to `weighted` and returns the sum of `w r^2`.
pub(crate) fn weighted_residuals(grey_levels: GreyLevels<'_>, weighted: &mut [f32]) -> f64 {
    run(WeightedResiduals { grey_levels, weighted })
}

struct WeightedResiduals<'a> {
    grey_levels: GreyLevels<'a>,
    weighted: &'a mut [f32],
}

impl WithSimd for WeightedResiduals<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let Self { grey_levels, weighted } = self;
        let (weighted, _) = S::as_mut_simd_f32s(weighted);
        let [reference, deformed, weights] = [grey_levels.reference, grey_levels.deformed, grey_levels.weights]
            .map(|row| &S::as_simd_f32s(row).0[..weighted.len()]);
        let gain = simd.splat_f32s(-grey_levels.gain_offset[0]);
        let offset = simd.splat_f32s(grey_levels.gain_offset[1]);
        let mut squares = 0.0;
        for start in (0..weighted.len()).step_by(FLUSH) {
            let mut square = simd.splat_f32s(0.0);
            for k in start..weighted.len().min(start + FLUSH) {
                let residual = simd.mul_add_e_f32s(gain, deformed[k], simd.sub_f32s(reference[k], offset));
                weighted[k] = simd.mul_f32s(weights[k], residual);
                square = simd.mul_add_e_f32s(weighted[k], residual, square);
            }
            squares += f64::from(simd.reduce_sum_f32s(square));
        }
        squares
    }
}
