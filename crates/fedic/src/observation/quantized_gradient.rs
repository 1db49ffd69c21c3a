//! Image gradients quantised to 20 bits: the upper 16 bits of each component in an `i16`, the lower four of both in one byte.

use pulp::{Simd, WithSimd};

use crate::kernels::dispatch::run;
use crate::kernels::gradient::GradientVectors;

/// Largest magnitude of a quantised gradient.
pub(crate) const MAX_LEVEL: f32 = 500_000.0;
/// Bits of a component in the shared byte.
const LOW_BITS: u32 = 4;
/// Entries of the widest vector.
const MAX_LANES: usize = 16;

/// Quantised gradients of some points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct QuantizedGradient<'a> {
    pub(crate) high: [&'a [i16]; 2],
    pub(crate) low: &'a [u8],
}

/// Quantised gradients to be written.
pub(crate) struct QuantizedGradientMut<'a> {
    pub(crate) high: [&'a mut [i16]; 2],
    pub(crate) low: &'a mut [u8],
}

impl QuantizedGradient<'_> {
    /// Gradient at point `k`, in units of the quantisation step.
    #[inline(always)]
    pub(crate) fn at(self, k: usize) -> [f32; 2] {
        [0, 1].map(|c| {
            let low = i32::from(self.low[k]) >> (LOW_BITS * c as u32) & ((1 << LOW_BITS) - 1);
            ((i32::from(self.high[c][k]) << LOW_BITS) + low) as f32
        })
    }

    /// The points of a range.
    pub(crate) fn part(self, range: std::ops::Range<usize>) -> Self {
        Self { high: self.high.map(|high| &high[range.clone()]), low: &self.low[range] }
    }
}

impl GradientVectors for QuantizedGradient<'_> {
    #[inline(always)]
    fn vectors<S: Simd>(self, k: usize) -> [S::f32s; 2] {
        let points = self.part(k * S::F32_LANES..(k + 1) * S::F32_LANES);
        let mut vectors = [[0.0; MAX_LANES]; 2];
        for lane in 0..S::F32_LANES {
            let at = points.at(lane);
            (vectors[0][lane], vectors[1][lane]) = (at[0], at[1]);
        }
        vectors.each_ref().map(|vector| S::as_simd_f32s(&vector[..S::F32_LANES]).0[0])
    }
}

impl QuantizedGradientMut<'_> {
    /// Rounds gradients to multiples of `step`, none of which exceeds [`MAX_LEVEL`] in magnitude.
    pub(crate) fn fill(&mut self, gradient: [&[f32]; 2], step: f32) {
        let per_step = if step > 0.0 { 1.0 / step } else { 0.0 };
        run(Rounding { gradient, per_step, steps: self });
    }
}

struct Rounding<'a, 'b> {
    gradient: [&'a [f32]; 2],
    per_step: f32,
    steps: &'a mut QuantizedGradientMut<'b>,
}

impl WithSimd for Rounding<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        /// Added to a number below `2^22`, it leaves the nearest integer in the low bits.
        const ROUNDING: f32 = 12_582_912.0;
        let whole = |number: f32| (number * self.per_step + ROUNDING).to_bits().wrapping_sub(ROUNDING.to_bits()) as i32;
        // One loop per row, which the compiler vectorises.
        for (high, along) in self.steps.high.iter_mut().zip(self.gradient) {
            high.iter_mut().zip(along).for_each(|(high, &number)| *high = (whole(number) >> LOW_BITS) as i16);
        }
        let low_bits = |number: f32| (whole(number) & ((1 << LOW_BITS) - 1)) as u8;
        let [u, v] = self.gradient;
        for (low, (&u, &v)) in self.steps.low.iter_mut().zip(u.iter().zip(v)) {
            *low = low_bits(u) | low_bits(v) << LOW_BITS;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gradients_are_rounded_to_the_nearest_step() {
        let step = 2.0 / MAX_LEVEL;
        let [u, v] =
            [0.37, 0.61].map(|phase| -> Vec<f32> { (0..112).map(|k| 2.0 * (phase * k as f32).sin()).collect() });
        let (mut along_u, mut along_v, mut low) = (vec![0; 112], vec![0; 112], vec![0; 112]);
        let mut steps = QuantizedGradientMut { high: [&mut along_u, &mut along_v], low: &mut low };
        steps.fill([&u, &v], step);
        let steps = QuantizedGradient { high: [&along_u, &along_v], low: &low };
        for k in 0..112 {
            for (found, expected) in steps.at(k).into_iter().zip([u[k], v[k]]) {
                assert!((step * found - expected).abs() <= 0.6 * step, "{found} {expected}");
            }
        }
        for k in 0..112 / pulp::Scalar::F32_LANES {
            assert_eq!(steps.vectors::<pulp::Scalar>(k), steps.at(k));
        }
        QuantizedGradientMut { high: [&mut along_u, &mut along_v], low: &mut low }.fill([&[0.0; 112]; 2], 0.0);
        assert!(along_u.iter().chain(&along_v).all(|&high| high == 0) && low.iter().all(|&low| low == 0));
    }
}
