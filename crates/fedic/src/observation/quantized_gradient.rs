//! Gradients in whole steps of 20 bits: 16 of each component in a number of its own, the last four of both in one byte.

use pulp::{Simd, WithSimd};

use crate::kernels::simd::{Slopes, run};

/// Most steps of a number.
pub(crate) const MOST_STEPS: f32 = 500_000.0;
/// Bits of a component that are in the byte.
const FINE: u32 = 4;
/// Numbers in the widest vector.
const MOST_LANES: usize = 16;

/// Gradients of some points.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Steps<'a> {
    pub(crate) coarse: [&'a [i16]; 2],
    pub(crate) fine: &'a [u8],
}

/// The same, to be filled.
pub(crate) struct StepsMut<'a> {
    pub(crate) coarse: [&'a mut [i16]; 2],
    pub(crate) fine: &'a mut [u8],
}

impl Steps<'_> {
    /// Gradient at point `k`, in steps.
    #[inline(always)]
    pub(crate) fn at(self, k: usize) -> [f32; 2] {
        [0, 1].map(|c| {
            let fine = i32::from(self.fine[k]) >> (FINE * c as u32) & ((1 << FINE) - 1);
            ((i32::from(self.coarse[c][k]) << FINE) + fine) as f32
        })
    }

    /// The points of a range.
    pub(crate) fn part(self, range: std::ops::Range<usize>) -> Self {
        Self { coarse: self.coarse.map(|coarse| &coarse[range.clone()]), fine: &self.fine[range] }
    }
}

impl Slopes for Steps<'_> {
    #[inline(always)]
    fn vectors<S: Simd>(self, k: usize) -> [S::f32s; 2] {
        let points = self.part(k * S::F32_LANES..(k + 1) * S::F32_LANES);
        let mut vectors = [[0.0; MOST_LANES]; 2];
        for lane in 0..S::F32_LANES {
            let at = points.at(lane);
            (vectors[0][lane], vectors[1][lane]) = (at[0], at[1]);
        }
        vectors.each_ref().map(|vector| S::as_simd_f32s(&vector[..S::F32_LANES]).0[0])
    }
}

impl StepsMut<'_> {
    /// Rounds gradients to whole steps, of which none is more than [`MOST_STEPS`].
    pub(crate) fn fill(&mut self, gradient: [&[f32]; 2], step: f32) {
        let per_step = if step > 0.0 { 1.0 / step } else { 0.0 };
        run(Rounding { gradient, per_step, steps: self });
    }
}

struct Rounding<'a, 'b> {
    gradient: [&'a [f32]; 2],
    per_step: f32,
    steps: &'a mut StepsMut<'b>,
}

impl WithSimd for Rounding<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        /// Added to a number below `2^22`, leaves it rounded to the nearest integer, in the low bits.
        const ROUNDING: f32 = 12_582_912.0;
        let whole = |number: f32| (number * self.per_step + ROUNDING).to_bits().wrapping_sub(ROUNDING.to_bits()) as i32;
        // One loop for each row that is filled: the compiler makes vectors of them.
        for (coarse, along) in self.steps.coarse.iter_mut().zip(self.gradient) {
            coarse.iter_mut().zip(along).for_each(|(coarse, &number)| *coarse = (whole(number) >> FINE) as i16);
        }
        let low = |number: f32| (whole(number) & ((1 << FINE) - 1)) as u8;
        let [u, v] = self.gradient;
        for (fine, (&u, &v)) in self.steps.fine.iter_mut().zip(u.iter().zip(v)) {
            *fine = low(u) | low(v) << FINE;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_to_the_nearest_step() {
        let step = 2.0 / MOST_STEPS;
        let [u, v] =
            [0.37, 0.61].map(|phase| -> Vec<f32> { (0..112).map(|k| 2.0 * (phase * k as f32).sin()).collect() });
        let (mut along_u, mut along_v, mut fine) = (vec![0; 112], vec![0; 112], vec![0; 112]);
        let mut steps = StepsMut { coarse: [&mut along_u, &mut along_v], fine: &mut fine };
        steps.fill([&u, &v], step);
        let steps = Steps { coarse: [&along_u, &along_v], fine: &fine };
        for k in 0..112 {
            for (found, expected) in steps.at(k).into_iter().zip([u[k], v[k]]) {
                assert!((step * found - expected).abs() <= 0.6 * step, "{found} {expected}");
            }
        }
        for k in 0..112 / pulp::Scalar::F32_LANES {
            assert_eq!(steps.vectors::<pulp::Scalar>(k), steps.at(k));
        }
        StepsMut { coarse: [&mut along_u, &mut along_v], fine: &mut fine }.fill([&[0.0; 112]; 2], 0.0);
        assert!(along_u.iter().chain(&along_v).all(|&coarse| coarse == 0) && fine.iter().all(|&fine| fine == 0));
    }
}
