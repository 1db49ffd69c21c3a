//! Interpolation kernels as piecewise polynomials.
//!
//! Every kernel is even and polynomial on unit intervals. With `s` the distance from the middle between two pixels, in
//! `[-1/2, 1/2]`, the weights of a tap and of its mirror image are `e(s^2) + s o(s^2)` and `e(s^2) - s o(s^2)`: half as many
//! polynomials, of half the degree. Kernels are data, and those of equal size share their code.

use crate::simd::lanes::{BLOCK, Fusing, Lane, fused};

/// A kernel of `2 HALF` taps. Tap `i` weighs the sample at `floor(x) + i + 1 - HALF`.
#[derive(Clone, Copy)]
pub(crate) struct Kernel<const HALF: usize> {
    /// `even[i][p]` multiplies `s^(2 p)` in the weight of tap `i < HALF`, and in that of tap `2 HALF - 1 - i`.
    pub(crate) even: [[f32; HALF]; HALF],
    /// `odd[i][p]` multiplies `s^(2 p + 1)` in the weight of tap `i < HALF`, and its opposite in that of its mirror image.
    pub(crate) odd: [[f32; HALF]; HALF],
}

/// A kernel of any of the supported sizes.
#[derive(Clone, Copy)]
pub(crate) enum AnyKernel {
    Two(Kernel<1>),
    Four(Kernel<2>),
    Six(Kernel<3>),
}

impl<const HALF: usize> Kernel<HALF> {
    /// Weights of the taps at each distance `s` from the middle.
    #[inline(always)]
    pub(crate) fn weights<S: Fusing, const TAPS: usize>(&self, s: &Lane, out: &mut [Lane; TAPS]) {
        for k in 0..BLOCK {
            let square = s[k] * s[k];
            for i in 0..HALF {
                let (even, odd) = (&self.even[i], &self.odd[i]);
                let (mut e, mut o) = (even[HALF - 1], odd[HALF - 1]);
                for p in (0..HALF - 1).rev() {
                    e = fused::<S>(e, square, even[p]);
                    o = fused::<S>(o, square, odd[p]);
                }
                out[i][k] = fused::<S>(o, s[k], e);
                out[2 * HALF - 1 - i][k] = fused::<S>(-o, s[k], e);
            }
        }
    }

    /// Derivatives of the weights, per pixel, at each distance from the middle.
    #[inline(always)]
    pub(crate) fn derivatives<S: Fusing, const TAPS: usize>(&self, s: &Lane, out: &mut [Lane; TAPS]) {
        for k in 0..BLOCK {
            let square = s[k] * s[k];
            for i in 0..HALF {
                let (even, odd) = (&self.even[i], &self.odd[i]);
                let (mut e, mut o) = (0.0, 0.0);
                for p in (0..HALF).rev() {
                    e = fused::<S>(e, square, 2.0 * (p + 1) as f32 * even.get(p + 1).copied().unwrap_or(0.0));
                    o = fused::<S>(o, square, (2 * p + 1) as f32 * odd[p]);
                }
                out[i][k] = fused::<S>(e, s[k], o);
                out[2 * HALF - 1 - i][k] = fused::<S>(e, s[k], -o);
            }
        }
    }
}
