//! Where the stencils of a block of points lie along one axis, and what they weigh.
//!
//! Points are treated in blocks, one step at a time over the whole block, because each step is then a loop that compiles to
//! vector instructions. A point outside the image takes the stencil of the nearest point inside and a fraction that is NaN:
//! every weight, and so every result, becomes NaN without a branch.

use crate::coefficients::PADDING;
use crate::kernel::Kernel;

/// Points per block: enough to amortise the steps, few enough for the level 1 cache.
pub(crate) const BLOCK: usize = 32;

/// Added to a number below `2^51` in magnitude, leaves it rounded to the nearest integer, in the low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// The stencils of up to [`BLOCK`] points along the columns or along the rows.
pub(crate) struct Axis<const TAPS: usize> {
    /// First coefficient of the stencil, counted from the beginning of the margin.
    pub(crate) first: [u32; BLOCK],
    /// Weights of the coefficients.
    pub(crate) weights: [[f32; TAPS]; BLOCK],
    /// Derivatives of the weights, where asked for.
    pub(crate) slopes: [[f32; TAPS]; BLOCK],
    fractions: [f32; BLOCK],
}

impl<const TAPS: usize> Axis<TAPS> {
    pub(crate) fn new() -> Self {
        Self { first: [0; BLOCK], weights: [[0.0; TAPS]; BLOCK], slopes: [[0.0; TAPS]; BLOCK], fractions: [0.0; BLOCK] }
    }

    /// Finds the stencils of the points at the pixel coordinates `x`, along an axis of `size` pixels, and their weights.
    #[inline]
    pub(crate) fn locate<const TERMS: usize>(&mut self, kernel: &Kernel<TAPS, TERMS>, x: &[f64], size: usize) {
        const START: f64 = -0.5;
        let end = size as f64 - 0.5;
        let first_from_floor = PADDING as f64 + 1.0 - TAPS as f64 / 2.0;
        for ((&x, first), fraction) in x.iter().zip(&mut self.first).zip(&mut self.fractions) {
            // Not `clamp`, which keeps a NaN.
            let inside = if x > START { x } else { START };
            let inside = if inside < end { inside } else { end };
            let floor = floor(inside);
            *first = (floor + first_from_floor + ROUNDING).to_bits() as u32;
            *fraction = if inside == x { (inside - floor) as f32 } else { f32::NAN };
        }
        let count = x.len();
        kernel.weights(&self.fractions[..count], &mut self.weights[..count]);
    }

    /// Computes the derivatives of the weights for the first `count` points located.
    #[inline]
    pub(crate) fn differentiate<const TERMS: usize>(&mut self, kernel: &Kernel<TAPS, TERMS>, count: usize) {
        kernel.derivative_weights(&self.fractions[..count], &mut self.slopes[..count]);
    }
}

/// The floor of a number below `2^51` in magnitude; unlike `f64::floor`, not a function call on a plain x86-64.
#[inline]
fn floor(x: f64) -> f64 {
    let nearest = (x + ROUNDING) - ROUNDING;
    if nearest > x { nearest - 1.0 } else { nearest }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn floor_is_the_floor(x in -1e6..1e6_f64, whole in -1_000_000..1_000_000) {
            prop_assert_eq!(floor(x), x.floor());
            for x in [f64::from(whole), f64::from(whole).next_up(), f64::from(whole).next_down(), f64::from(whole) + 0.5] {
                prop_assert_eq!(floor(x), x.floor());
            }
        }
    }
}
