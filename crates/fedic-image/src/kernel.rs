//! The interpolation kernels, as the polynomials their weights are between two pixels.
//!
//! Every kernel here is even and a polynomial on unit intervals. With `s` the distance from the middle between two pixels, in
//! `[-1/2, 1/2]`, the weights of a tap and of its mirror image are `e(s^2) + s o(s^2)` and `e(s^2) - s o(s^2)`: half the
//! polynomials, of half the degree. They are data, not code, and kernels of equal size share theirs.

use crate::lanes::{BLOCK, Fusing, Lane, fused};

/// A kernel of `2 HALF` taps. Tap `i` weighs the sample at `floor(x) + i + 1 - HALF`.
#[derive(Clone)]
pub(crate) struct Kernel<const HALF: usize> {
    /// `even[i][p]` multiplies `s^(2 p)` in the weight of tap `i < HALF`, and in that of tap `2 HALF - 1 - i`.
    even: [[f32; HALF]; HALF],
    /// `odd[i][p]` multiplies `s^(2 p + 1)` in the weight of tap `i < HALF`, and its opposite in that of its mirror image.
    odd: [[f32; HALF]; HALF],
}

/// A kernel whose number of taps is known when the image is prepared.
#[derive(Clone)]
pub(crate) enum AnyKernel {
    Two(Kernel<1>),
    Four(Kernel<2>),
    Six(Kernel<3>),
}

/// Straight lines between neighbours.
pub(crate) const BILINEAR: Kernel<1> = Kernel { even: [[0.5]], odd: [[-1.0]] };

/// Keys' cubic convolution, `a = -1/2` (R. Keys, 1981): third order, exact on quadratics.
pub(crate) const BICUBIC: Kernel<2> = Kernel {
    even: [[-1.0 / 16.0, 1.0 / 4.0], [9.0 / 16.0, -1.0 / 4.0]],
    odd: [[1.0 / 8.0, -1.0 / 2.0], [-11.0 / 8.0, 1.5]],
};

/// Cubic B-spline.
pub(crate) const BSPLINE3: Kernel<2> = Kernel {
    even: [[1.0 / 48.0, 1.0 / 4.0], [23.0 / 48.0, -1.0 / 4.0]],
    odd: [[-1.0 / 8.0, -1.0 / 6.0], [-5.0 / 8.0, 1.0 / 2.0]],
};

/// Quintic B-spline.
pub(crate) const BSPLINE5: Kernel<3> = Kernel {
    even: [
        [1.0 / 3840.0, 1.0 / 96.0, 1.0 / 48.0],
        [79.0 / 1280.0, 7.0 / 32.0, -1.0 / 16.0],
        [841.0 / 1920.0, -11.0 / 48.0, 1.0 / 24.0],
    ],
    odd: [
        [-1.0 / 384.0, -1.0 / 48.0, -1.0 / 120.0],
        [-25.0 / 128.0, -1.0 / 16.0, 1.0 / 24.0],
        [-77.0 / 192.0, 7.0 / 24.0, -1.0 / 12.0],
    ],
};

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
    pub(crate) fn slopes<S: Fusing, const TAPS: usize>(&self, s: &Lane, out: &mut [Lane; TAPS]) {
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Checks one kernel at one fraction; `reference(x)` is the kernel's textbook definition.
    fn check<const HALF: usize, const TAPS: usize>(kernel: &Kernel<HALF>, reference: fn(f64) -> f64, t: f32) {
        let (mut weights, mut slopes) = ([[0.0; BLOCK]; TAPS], [[0.0; BLOCK]; TAPS]);
        kernel.weights::<pulp::Scalar, TAPS>(&[t - 0.5; BLOCK], &mut weights);
        kernel.slopes::<pulp::Scalar, TAPS>(&[t - 0.5; BLOCK], &mut slopes);
        let (weights, slopes) = (weights.map(|lane| lane[BLOCK - 1]), slopes.map(|lane| lane[BLOCK - 1]));
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{weights:?} do not sum to one");
        assert!(slopes.iter().sum::<f32>().abs() < 1e-5, "{slopes:?} do not sum to zero");
        let step = 1e-5;
        for tap in 0..TAPS {
            let distance = f64::from(t) - (tap as f64 + 1.0 - HALF as f64);
            let slope = (reference(distance + step) - reference(distance - step)) / (2.0 * step);
            assert!((f64::from(weights[tap]) - reference(distance)).abs() < 1e-6, "weight of tap {tap} at {t}");
            assert!((f64::from(slopes[tap]) - slope).abs() < 1e-4, "slope of tap {tap} at {t}");
        }
    }

    fn hat(x: f64) -> f64 {
        (1.0 - x.abs()).max(0.0)
    }

    fn keys(x: f64) -> f64 {
        match x.abs() {
            x if x < 1.0 => (1.5 * x - 2.5) * x * x + 1.0,
            x if x < 2.0 => ((-0.5 * x + 2.5) * x - 4.0) * x + 2.0,
            _ => 0.0,
        }
    }

    /// Truncated powers: `sum over k of (-1)^k C(n+1, k) (x + (n+1)/2 - k)_+^n / n!`.
    fn bspline(degree: i32, x: f64) -> f64 {
        let (mut sum, mut binomial, mut factorial) = (0.0, 1.0, 1.0);
        for k in 0..=degree + 1 {
            let base = (x + f64::from(degree + 1) / 2.0 - f64::from(k)).max(0.0);
            sum += binomial * base.powi(degree);
            binomial *= -f64::from(degree + 1 - k) / f64::from(k + 1);
        }
        for k in 2..=degree {
            factorial *= f64::from(k);
        }
        sum / factorial
    }

    proptest! {
        // The fraction keeps off the ends, where finite differences of the hat straddle its corner.
        #[test]
        fn weights_are_those_of_the_definitions(t in 1e-3_f32..0.999) {
            check::<1, 2>(&BILINEAR, hat, t);
            check::<2, 4>(&BICUBIC, keys, t);
            check::<2, 4>(&BSPLINE3, |x| bspline(3, x), t);
            check::<3, 6>(&BSPLINE5, |x| bspline(5, x), t);
        }
    }
}
