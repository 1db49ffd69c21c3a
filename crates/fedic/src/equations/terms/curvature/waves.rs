//! Plane waves in the image, sampled at the nodes of a mesh.

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, DVector};

use crate::equations::patches::Patch;

/// Directions of the waves: so many that fourfold and sixfold patterns of cells average out.
const DIRECTIONS: usize = 8;
/// Number of waves: a cosine and a sine in each direction.
pub(super) const NUM_WAVES: usize = 2 * DIRECTIONS;

/// Values of the waves of a length at the nodes.
#[derive(Debug, Clone)]
pub(super) struct Waves {
    values: Vec<Vec<f64>>,
}

impl Waves {
    /// Waves of a length in pixels at image points.
    pub(super) fn new(pixels: &[[f64; 2]], length: f64) -> Self {
        // Phases from the middle of the points: those far from the origin lose digits.
        let middle = [0, 1].map(|axis| pixels.iter().map(|pixel| pixel[axis]).sum::<f64>() / pixels.len() as f64);
        let wave = |index: usize| {
            let (sin, cos) = (PI * (index / 2) as f64 / DIRECTIONS as f64).sin_cos();
            let phase = |pixel: &[f64; 2]| TAU / length * (cos * (pixel[0] - middle[0]) + sin * (pixel[1] - middle[1]));
            let value = |pixel| if index.is_multiple_of(2) { phase(pixel).cos() } else { phase(pixel).sin() };
            pixels.iter().map(value).collect()
        };
        Self { values: (0..NUM_WAVES).map(wave).collect() }
    }

    /// All waves.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.values.iter()
    }

    /// A cosine in each second direction, none of them along an axis or a diagonal of the image.
    pub(super) fn some(&self) -> impl Iterator<Item = &Vec<f64>> {
        self.values.iter().skip(2).step_by(4)
    }

    /// Mean over the waves of a quadratic form of the values at the nodes of a patch.
    pub(super) fn mean(&self, patch: &Patch, form: &DMatrix<f64>) -> f64 {
        let energy = |wave: &Vec<f64>| {
            let v = DVector::from_iterator(patch.nodes.len(), patch.nodes.iter().map(|&node| wave[node as usize]));
            v.dot(&(form * &v))
        };
        self.iter().map(energy).sum::<f64>() / NUM_WAVES as f64
    }
}

/// The field with these values in a component and zero in the others.
pub(super) fn in_component<const D: usize>(values: &[f64], component: usize) -> Vec<[f64; D]> {
    values.iter().map(|&value| std::array::from_fn(|c| if c == component { value } else { 0.0 })).collect()
}
