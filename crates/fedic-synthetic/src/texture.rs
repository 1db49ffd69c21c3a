//! Textures.

use rayon::prelude::*;

use crate::speckle::Speckle;

/// A function of the coordinates `(a, b)` of a surface, with values in `[0, 1]`.
pub trait Texture: Sync {
    /// Values at many points.
    fn values(&self, points: &[[f64; 2]]) -> Vec<f64>;
}

impl<F: Fn([f64; 2]) -> f64 + Sync> Texture for F {
    fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        points.par_iter().map(|&point| self(point)).collect()
    }
}

impl Texture for Speckle {
    fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        Self::values(self, points)
    }
}
