//! Smooth modes: polynomials of the image coordinates of the nodes.

use crate::projection::projected_points::{ProjectedPoint, pixel_bounds};
use crate::solve::basis::modes::Modes;

/// Highest degree of the polynomials.
const DEGREE: i32 = 3;

/// Monomials of the image coordinates, scaled to lie between -1 and 1, for each component of the displacement.
pub(crate) struct PolynomialModes {
    terms: usize,
    values: Vec<f64>,
}

impl PolynomialModes {
    /// The monomials at some projected nodes.
    pub(crate) fn new(nodes: &[ProjectedPoint]) -> Self {
        let bounds = pixel_bounds(nodes.iter());
        let powers: Vec<[i32; 2]> = (0..=DEGREE).flat_map(|sum| (0..=sum).map(move |j| [sum - j, j])).collect();
        let values = nodes.iter().flat_map(|node| {
            let [x, y] = [0, 1].map(|c| {
                let [low, high] = bounds[c];
                (2.0 * node.pixel[c] - low - high) / (high - low)
            });
            powers.iter().map(move |&[i, j]| x.powi(i) * y.powi(j))
        });
        Self { terms: powers.len(), values: values.collect() }
    }
}

impl<const D: usize> Modes<D> for PolynomialModes {
    fn len(&self) -> usize {
        self.terms * D
    }

    fn value(&self, node: usize, component: usize, parameter: usize) -> f64 {
        if component == parameter % D { self.values[node * self.terms + parameter / D] } else { 0.0 }
    }
}
