//! The interpolation kernels, as the polynomials their weights are between two pixels.
//!
//! Every kernel here is a piecewise polynomial on unit intervals. Between two pixels, at fraction `t`, the weight of each of
//! its taps is a polynomial in `t`; storing them by power of `t` lets one Horner scheme compute all the taps at once, which
//! is what vector registers like. The polynomials are data carried by the interpolator, not constants of the code: known
//! zeros and ones would tempt the compiler to compute the taps one by one, and kernels of equal size share their code.

/// A kernel of `TAPS` weights, polynomials of `TERMS` terms in the fraction `t` in `[0, 1)`.
///
/// Tap `i` weighs the sample at `floor(x) + i + 1 - TAPS / 2`. `terms[p][i]` multiplies `t^p` in the weight of tap `i`.
#[derive(Clone)]
pub(crate) struct Kernel<const TAPS: usize, const TERMS: usize> {
    terms: [[f32; TAPS]; TERMS],
}

/// A kernel whose number of taps is known when the image is prepared.
#[derive(Clone)]
pub(crate) enum AnyKernel {
    Two(Kernel<2, 2>),
    Four(Kernel<4, 4>),
    Six(Kernel<6, 6>),
}

/// Straight lines between neighbours.
pub(crate) const BILINEAR: Kernel<2, 2> = Kernel { terms: [[1.0, 0.0], [-1.0, 1.0]] };

/// Keys' cubic convolution, `a = -1/2` (R. Keys, 1981): third order, exact on quadratics.
pub(crate) const BICUBIC: Kernel<4, 4> =
    Kernel { terms: [[0.0, 1.0, 0.0, 0.0], [-0.5, 0.0, 0.5, 0.0], [1.0, -2.5, 2.0, -0.5], [-0.5, 1.5, -1.5, 0.5]] };

/// Cubic B-spline.
pub(crate) const BSPLINE3: Kernel<4, 4> = Kernel {
    terms: divided([[1.0, 4.0, 1.0, 0.0], [-3.0, 0.0, 3.0, 0.0], [3.0, -6.0, 3.0, 0.0], [-1.0, 3.0, -3.0, 1.0]], 6.0),
};

/// Quintic B-spline.
pub(crate) const BSPLINE5: Kernel<6, 6> = Kernel {
    terms: divided(
        [
            [1.0, 26.0, 66.0, 26.0, 1.0, 0.0],
            [-5.0, -50.0, 0.0, 50.0, 5.0, 0.0],
            [10.0, 20.0, -60.0, 20.0, 10.0, 0.0],
            [-10.0, 20.0, 0.0, -20.0, 10.0, 0.0],
            [5.0, -20.0, 30.0, -20.0, 5.0, 0.0],
            [-1.0, 5.0, -10.0, 10.0, -5.0, 1.0],
        ],
        120.0,
    ),
};

impl<const TAPS: usize, const TERMS: usize> Kernel<TAPS, TERMS> {
    /// Weights of the taps at each fraction `t`.
    #[inline]
    pub(crate) fn weights(&self, t: &[f32], out: &mut [[f32; TAPS]]) {
        for (&t, out) in t.iter().zip(out) {
            let mut weights = self.terms[TERMS - 1];
            for power in (0..TERMS - 1).rev() {
                for tap in 0..TAPS {
                    weights[tap] = weights[tap] * t + self.terms[power][tap];
                }
            }
            *out = weights;
        }
    }

    /// Derivatives of the weights with respect to `t`, at each fraction.
    #[inline]
    pub(crate) fn derivative_weights(&self, t: &[f32], out: &mut [[f32; TAPS]]) {
        for (&t, out) in t.iter().zip(out) {
            let mut weights = [0.0; TAPS];
            for power in (1..TERMS).rev() {
                for tap in 0..TAPS {
                    weights[tap] = weights[tap] * t + power as f32 * self.terms[power][tap];
                }
            }
            *out = weights;
        }
    }
}

const fn divided<const N: usize>(mut terms: [[f32; N]; N], divisor: f32) -> [[f32; N]; N] {
    let mut power = 0;
    while power < N {
        let mut tap = 0;
        while tap < N {
            terms[power][tap] /= divisor;
            tap += 1;
        }
        power += 1;
    }
    terms
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Checks one kernel at one fraction; `reference(x)` is the kernel's textbook definition.
    fn check<const TAPS: usize, const TERMS: usize>(kernel: &Kernel<TAPS, TERMS>, reference: fn(f64) -> f64, t: f32) {
        let (mut weights, mut slopes) = ([[0.0; TAPS]], [[0.0; TAPS]]);
        kernel.weights(&[t], &mut weights);
        kernel.derivative_weights(&[t], &mut slopes);
        let ([weights], [slopes]) = (weights, slopes);
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{weights:?} do not sum to one");
        assert!(slopes.iter().sum::<f32>().abs() < 1e-5, "{slopes:?} do not sum to zero");
        let step = 1e-5;
        for tap in 0..TAPS {
            let distance = f64::from(t) - (tap as f64 + 1.0 - TAPS as f64 / 2.0);
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
            check(&BILINEAR, hat, t);
            check(&BICUBIC, keys, t);
            check(&BSPLINE3, |x| bspline(3, x), t);
            check(&BSPLINE5, |x| bspline(5, x), t);
        }
    }
}
