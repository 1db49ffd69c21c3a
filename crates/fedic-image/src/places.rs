//! Where the stencils of a block of points begin, and how far the points lie from the middle between two pixels.

use crate::coefficients::PADDING;
use crate::lanes::{BLOCK, Lane};

/// Added to a number below `2^51` in magnitude, leaves it rounded to the nearest integer, in the low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;
/// The same below `2^22`, in single precision.
const ROUNDING_F32: f32 = 12_582_912.0;

/// The stencils of up to [`BLOCK`] points in the coefficients of an image.
pub(crate) struct Places {
    /// Index of the first coefficient of the stencil.
    pub(crate) first: [u32; BLOCK],
    /// Distance, along the columns and along the rows, from the middle of the stencil.
    pub(crate) middle: [Lane; 2],
}

/// Sizes of an image and of a stencil.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Coefficients per row.
    pub(crate) stride: usize,
    /// Taps on each side of a point.
    pub(crate) half: usize,
}

impl Places {
    pub(crate) fn new() -> Self {
        Self { first: [0; BLOCK], middle: [[0.0; BLOCK]; 2] }
    }

    /// Points given by their pixel coordinates. One outside the image takes the stencil of the nearest point inside and a
    /// distance that is NaN: every weight, and so every result, becomes NaN without a branch.
    #[inline(always)]
    pub(crate) fn locate(&mut self, grid: Grid, u: &[f64], v: &[f64]) {
        let [middle_u, middle_v] = &mut self.middle;
        for k in 0..u.len().min(BLOCK) {
            let (column, s) = nearest_middle(u[k], grid.width);
            let (row, t) = nearest_middle(v[k], grid.height);
            (middle_u[k], middle_v[k]) = (s, t);
            self.first[k] = grid.first(column, row);
        }
    }

    /// Points inside the image given by their distance from the pixel `origin`.
    #[inline(always)]
    pub(crate) fn locate_near(&mut self, grid: Grid, origin: [isize; 2], u: &Lane, v: &Lane) {
        let base = grid.first(origin[0], origin[1]);
        let stride = grid.stride as u32;
        let [middle_u, middle_v] = &mut self.middle;
        for k in 0..BLOCK {
            let (x, y) = (u[k] - 0.5, v[k] - 0.5);
            let (column, row) = (x + ROUNDING_F32, y + ROUNDING_F32);
            middle_u[k] = x - (column - ROUNDING_F32);
            middle_v[k] = y - (row - ROUNDING_F32);
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
        fn the_nearest_middle_is_at_most_half_a_pixel_away(x in -0.5..499.5_f64, whole in 0..499) {
            for x in [x, f64::from(whole), f64::from(whole).next_up(), f64::from(whole) + 0.5] {
                let (column, s) = nearest_middle(x, 500);
                prop_assert!(s.abs() <= 0.5);
                prop_assert!((column as f64 + 0.5 + f64::from(s) - x).abs() < 1e-7);
            }
            prop_assert!(nearest_middle(f64::NAN, 500).1.is_nan());
            prop_assert!(nearest_middle(499.5_f64.next_up(), 500).1.is_nan());
        }

        #[test]
        fn both_ways_of_giving_a_point_agree(u in 20.0..80.0_f32, v in 20.0..60.0_f32) {
            let grid = Grid { width: 100, height: 80, stride: 106, half: 2 };
            let (mut near, mut absolute) = (Places::new(), Places::new());
            near.locate_near(grid, [50, 40], &[u - 50.0; BLOCK], &[v - 40.0; BLOCK]);
            absolute.locate(grid, &[f64::from(u - 50.0) + 50.0], &[f64::from(v - 40.0) + 40.0]);
            prop_assert_eq!(near.first[BLOCK - 1], absolute.first[0]);
            prop_assert!((near.middle[0][BLOCK - 1] - absolute.middle[0][0]).abs() < 1e-6);
            prop_assert!((near.middle[1][BLOCK - 1] - absolute.middle[1][0]).abs() < 1e-6);
        }
    }
}
