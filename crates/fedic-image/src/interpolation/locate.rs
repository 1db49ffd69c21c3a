//! Positions of the stencils of a block of points, and of the points in their stencils.

use crate::interpolation::coefficients::PADDING;
use crate::simd::lanes::{BLOCK, Lane};

/// Adding it rounds a number below `2^51` in magnitude to the nearest integer, held in the low bits of the sum.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// [`ROUNDING`] in single precision, for numbers below `2^22`.
const ROUNDING_F32: f32 = 12_582_912.0;

/// The positions of up to [`BLOCK`] points in the coefficients of an image.
pub(crate) struct Locations {
    /// Index of the first coefficient of the stencil.
    pub(crate) first: [u32; BLOCK],
    /// Distance from the middle of the stencil, along the columns and along the rows.
    pub(crate) offset: [Lane; 2],
}

/// Size of an image and of a stencil.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Coefficients per row.
    pub(crate) stride: usize,
    /// Taps on each side of a point.
    pub(crate) half: usize,
}

impl Locations {
    pub(crate) fn new() -> Self {
        Self { first: [0; BLOCK], offset: [[0.0; BLOCK]; 2] }
    }

    /// Locates points given by their pixel coordinates. A point outside the image gets the stencil of the nearest point
    /// inside and the offset NaN: every weight, and so every result, becomes NaN without a branch.
    #[inline(always)]
    pub(crate) fn locate(&mut self, grid: Grid, u: &[f64], v: &[f64]) {
        let [offset_u, offset_v] = &mut self.offset;
        for k in 0..u.len().min(BLOCK) {
            let (column, s) = nearest_middle(u[k], grid.width);
            let (row, t) = nearest_middle(v[k], grid.height);
            (offset_u[k], offset_v[k]) = (s, t);
            self.first[k] = grid.first(column, row);
        }
    }

    /// Locates points inside the image given by their distance from the pixel `origin`.
    #[inline(always)]
    pub(crate) fn locate_near(&mut self, grid: Grid, origin: [isize; 2], u: &Lane, v: &Lane) {
        let base = grid.first(origin[0], origin[1]);
        let stride = grid.stride as u32;
        let [offset_u, offset_v] = &mut self.offset;
        for k in 0..BLOCK {
            let (x, y) = (u[k] - 0.5, v[k] - 0.5);
            let (column, row) = (x + ROUNDING_F32, y + ROUNDING_F32);
            offset_u[k] = x - (column - ROUNDING_F32);
            offset_v[k] = y - (row - ROUNDING_F32);
            let whole = |rounded: f32| rounded.to_bits().wrapping_sub(ROUNDING_F32.to_bits());
            self.first[k] = base.wrapping_add(whole(row).wrapping_mul(stride)).wrapping_add(whole(column));
        }
    }
}

impl Grid {
    /// Index of the first coefficient of the stencil between the pixel `(column, row)` and the next ones.
    #[inline(always)]
    pub(crate) fn first(self, column: isize, row: isize) -> u32 {
        let margin = (PADDING + 1 - self.half) as isize;
        ((row + margin) * self.stride as isize + column + margin) as u32
    }
}

/// The pixel before the nearest middle between two pixels, and the distance from that middle.
#[inline(always)]
fn nearest_middle(x: f64, size: usize) -> (isize, f32) {
    const START: f64 = -0.5;
    let end = size as f64 - 0.5;
    // Not `clamp`, which keeps a NaN.
    let inside = if x > START { x } else { START };
    let inside = if inside < end { inside } else { end };
    let rounded = (inside - 0.5) + ROUNDING;
    let column = rounded.to_bits().wrapping_sub(ROUNDING.to_bits()) as isize;
    let distance = if inside == x { (inside - 0.5 - (rounded - ROUNDING)) as f32 } else { f32::NAN };
    (column, distance)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_offset_is_at_most_half_a_pixel(x in -0.5..499.5_f64, whole in 0..499) {
            for x in [x, f64::from(whole), f64::from(whole).next_up(), f64::from(whole) + 0.5] {
                let (column, s) = nearest_middle(x, 500);
                prop_assert!(s.abs() <= 0.5);
                prop_assert!((column as f64 + 0.5 + f64::from(s) - x).abs() < 1e-7);
            }
            prop_assert!(nearest_middle(f64::NAN, 500).1.is_nan());
            prop_assert!(nearest_middle(499.5_f64.next_up(), 500).1.is_nan());
        }

        #[test]
        fn absolute_and_relative_coordinates_agree(u in 20.0..80.0_f32, v in 20.0..60.0_f32) {
            let grid = Grid { width: 100, height: 80, stride: 106, half: 2 };
            let (mut near, mut absolute) = (Locations::new(), Locations::new());
            near.locate_near(grid, [50, 40], &[u - 50.0; BLOCK], &[v - 40.0; BLOCK]);
            absolute.locate(grid, &[f64::from(u - 50.0) + 50.0], &[f64::from(v - 40.0) + 40.0]);
            prop_assert_eq!(near.first[BLOCK - 1], absolute.first[0]);
            prop_assert!((near.offset[0][BLOCK - 1] - absolute.offset[0][0]).abs() < 1e-6);
            prop_assert!((near.offset[1][BLOCK - 1] - absolute.offset[1][0]).abs() < 1e-6);
        }
    }
}
