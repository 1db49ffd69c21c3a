//! Plane waves in the image, sampled at the nodes of a mesh.

use std::f64::consts::{PI, TAU};

/// Directions of the waves: so many that fourfold and sixfold patterns of cells average out.
const DIRECTIONS: usize = 8;
/// Number of waves: a sine and a cosine in each direction.
pub(super) const NUM_WAVES: usize = 2 * DIRECTIONS;

/// Waves of a given length in pixels at image points.
pub(super) fn waves(pixels: &[[f64; 2]], length: f64) -> [Vec<f64>; NUM_WAVES] {
    // Phases from the middle of the points: those far from the origin lose digits.
    let middle = [0, 1].map(|axis| pixels.iter().map(|pixel| pixel[axis]).sum::<f64>() / pixels.len() as f64);
    std::array::from_fn(|wave| {
        let (sin, cos) = (PI * (wave / 2) as f64 / DIRECTIONS as f64).sin_cos();
        let phase = |pixel: &[f64; 2]| TAU / length * (cos * (pixel[0] - middle[0]) + sin * (pixel[1] - middle[1]));
        let value = |pixel| if wave % 2 == 0 { phase(pixel).cos() } else { phase(pixel).sin() };
        pixels.iter().map(value).collect()
    })
}
