//! The list of interpolations. A new one is one entry of this list, with the tests' reference values.

use std::fmt;
use std::str::FromStr;

use crate::error::ImageError;
use crate::interpolation::kernel::{AnyKernel, Kernel};

/// Data of an interpolation.
pub(crate) struct Method {
    name: &'static str,
    pub(crate) kernel: AnyKernel,
    /// Poles, inside the unit circle, of the prefilter that turns samples into coefficients; none if these are equal.
    pub(crate) poles: &'static [f64],
    exact_degree: u32,
}

/// Declares [`Interpolation`] and the data of each of its variants.
macro_rules! interpolations {
    ($($(#[$attribute:meta])* $variant:ident $method:expr;)*) => {
        /// An interpolation of grey levels between pixels.
        ///
        /// # Examples
        ///
        /// ```
        /// use fedic_image::Interpolation;
        ///
        /// assert_eq!("bspline5".parse(), Ok(Interpolation::Bspline5));
        /// assert_eq!(Interpolation::default().to_string(), "bspline5");
        /// ```
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
        #[non_exhaustive]
        pub enum Interpolation {
            $($(#[$attribute])* $variant,)*
        }

        const COUNT: usize = [$(stringify!($variant)),*].len();

        static METHODS: [Method; COUNT] = [$($method),*];

        impl Interpolation {
            /// Every interpolation, from the cheapest to the most precise.
            pub const ALL: [Self; COUNT] = [$(Self::$variant),*];
        }
    };
}

interpolations! {
    /// Bilinear, 2 x 2 pixels: continuous, with a gradient that jumps at the pixel centres.
    Bilinear Method {
        name: "bilinear",
        kernel: AnyKernel::Two(Kernel { even: [[0.5]], odd: [[-1.0]] }),
        poles: &[],
        exact_degree: 1,
    };
    /// Keys' cubic convolution with `a = -1/2` (R. Keys, 1981), 4 x 4 pixels: continuous gradient.
    Bicubic Method {
        name: "bicubic",
        kernel: AnyKernel::Four(Kernel {
            even: [[-1.0 / 16.0, 1.0 / 4.0], [9.0 / 16.0, -1.0 / 4.0]],
            odd: [[1.0 / 8.0, -1.0 / 2.0], [-11.0 / 8.0, 1.5]],
        }),
        poles: &[],
        exact_degree: 2,
    };
    /// Cubic B-spline through the pixels, 4 x 4 coefficients: continuous second derivatives.
    Bspline3 Method {
        name: "bspline3",
        kernel: AnyKernel::Four(Kernel {
            even: [[1.0 / 48.0, 1.0 / 4.0], [23.0 / 48.0, -1.0 / 4.0]],
            odd: [[-1.0 / 8.0, -1.0 / 6.0], [-5.0 / 8.0, 1.0 / 2.0]],
        }),
        // sqrt(3) - 2
        poles: &[-0.267_949_192_431_122_7],
        exact_degree: 3,
    };
    /// Quintic B-spline through the pixels, 6 x 6 coefficients: continuous fourth derivatives, least bias.
    #[default]
    Bspline5 Method {
        name: "bspline5",
        kernel: AnyKernel::Six(Kernel {
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
        }),
        // sqrt(135/2 -+ sqrt(17745/4)) +- sqrt(105/4) - 13/2
        poles: &[-0.430_575_347_099_973_8, -0.043_096_288_203_264_65],
        exact_degree: 5,
    };
}

impl Interpolation {
    /// Names of [`ALL`](Self::ALL) interpolations, in the same order.
    pub const NAMES: &'static [&'static str] = &{
        let mut names = [""; COUNT];
        let mut index = 0;
        while index < COUNT {
            names[index] = METHODS[index].name;
            index += 1;
        }
        names
    };

    /// The name that is parsed and displayed.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.method().name
    }

    /// Largest degree of the polynomials that are reproduced exactly.
    #[must_use]
    pub fn exact_degree(self) -> u32 {
        self.method().exact_degree
    }

    pub(crate) fn method(self) -> &'static Method {
        &METHODS[self as usize]
    }
}

impl fmt::Display for Interpolation {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.name())
    }
}

impl FromStr for Interpolation {
    type Err = ImageError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|interpolation| interpolation.name() == name)
            .ok_or_else(|| ImageError::UnknownInterpolation { name: name.to_owned(), known: Self::NAMES })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::simd::lanes::BLOCK;

    /// Compares the weights of a kernel, and their derivatives, with its textbook definition `reference(x)`.
    fn check_kernel<const HALF: usize, const TAPS: usize>(kernel: &Kernel<HALF>, reference: fn(f64) -> f64, t: f32) {
        let (mut weights, mut derivatives) = ([[0.0; BLOCK]; TAPS], [[0.0; BLOCK]; TAPS]);
        kernel.weights::<pulp::Scalar, TAPS>(&[t - 0.5; BLOCK], &mut weights);
        kernel.derivatives::<pulp::Scalar, TAPS>(&[t - 0.5; BLOCK], &mut derivatives);
        let (weights, derivatives) = (weights.map(|lane| lane[BLOCK - 1]), derivatives.map(|lane| lane[BLOCK - 1]));
        assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{weights:?} do not sum to one");
        assert!(derivatives.iter().sum::<f32>().abs() < 1e-5, "{derivatives:?} do not sum to zero");
        let step = 1e-5;
        for tap in 0..TAPS {
            let distance = f64::from(t) - (tap as f64 + 1.0 - HALF as f64);
            let derivative = (reference(distance + step) - reference(distance - step)) / (2.0 * step);
            assert!((f64::from(weights[tap]) - reference(distance)).abs() < 1e-6, "weight of tap {tap} at {t}");
            assert!((f64::from(derivatives[tap]) - derivative).abs() < 1e-4, "derivative of tap {tap} at {t}");
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

    fn definition(interpolation: Interpolation) -> fn(f64) -> f64 {
        match interpolation {
            Interpolation::Bilinear => hat,
            Interpolation::Bicubic => keys,
            Interpolation::Bspline3 => |x| bspline(3, x),
            Interpolation::Bspline5 => |x| bspline(5, x),
        }
    }

    proptest! {
        // The fraction stays away from the ends, where finite differences of the hat straddle its corner.
        #[test]
        fn kernels_agree_with_their_definitions(t in 1e-3_f32..0.999) {
            for interpolation in Interpolation::ALL {
                let definition = definition(interpolation);
                match &interpolation.method().kernel {
                    AnyKernel::Two(kernel) => check_kernel::<1, 2>(kernel, definition, t),
                    AnyKernel::Four(kernel) => check_kernel::<2, 4>(kernel, definition, t),
                    AnyKernel::Six(kernel) => check_kernel::<3, 6>(kernel, definition, t),
                }
            }
        }
    }

    /// The poles are the zeros, inside the unit circle, of the polynomial of the kernel's values at the integers.
    #[test]
    fn poles_are_those_of_the_kernels() {
        for interpolation in Interpolation::ALL {
            let definition = definition(interpolation);
            let values: Vec<f64> = (-3..=3).map(|k| definition(f64::from(k))).collect();
            let order = values.iter().filter(|value| value.abs() > 1e-12).count() - 1;
            let poles = interpolation.method().poles;
            assert_eq!(2 * poles.len(), order, "{interpolation}");
            for &pole in poles {
                let sum: f64 = values.iter().rev().fold(0.0, |sum, value| sum * pole + value);
                assert!(pole.abs() < 1.0 && sum.abs() < 1e-12, "{interpolation}: {pole} {sum}");
            }
        }
    }

    #[test]
    fn names_are_unique_and_parse_back() {
        for (index, interpolation) in Interpolation::ALL.into_iter().enumerate() {
            assert_eq!(Interpolation::NAMES[index], interpolation.name());
            assert_eq!(interpolation.to_string().parse(), Ok(interpolation));
        }
        assert_eq!(Interpolation::default(), Interpolation::Bspline5);
    }
}
