//! Plane waves in the image, sampled at the nodes of a mesh.

use std::f64::consts::{PI, TAU};

use crate::PLANE;
use crate::projection::projected_points::ProjectedPoint;

/// Directions of the waves: so many that fourfold and sixfold patterns of cells average out.
const DIRECTIONS: usize = 8;
/// Number of waves: a cosine and a sine in each direction.
const NUM_WAVES: usize = 2 * DIRECTIONS;

/// Direction of the displacement in a wave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Polarization {
    /// Each component of the displacement, one after the other.
    Components,
    /// Across the direction of the wave, in the plane of `x` and `y`: a shear wave.
    Shear,
}

/// Waves of a length at the nodes.
#[derive(Debug, Clone)]
pub(crate) struct Waves {
    values: Vec<Vec<f64>>,
    /// Unit vectors at the nodes across each direction, if the waves are shear waves.
    across: Option<Vec<Vec<[f64; PLANE]>>>,
}

impl Waves {
    /// Waves of a length in pixels at projected nodes.
    pub(super) fn new(nodes: &[ProjectedPoint], length: f64, polarization: Polarization) -> Self {
        // Phases from the middle of the points: those far from the origin lose digits.
        let middle = [0, 1].map(|axis| nodes.iter().map(|node| node.pixel[axis]).sum::<f64>() / nodes.len() as f64);
        let wave = |index: usize| {
            let [cos, sin] = direction(index / 2);
            let phase = |[u, v]: [f64; 2]| TAU / length * (cos * (u - middle[0]) + sin * (v - middle[1]));
            let even = index.is_multiple_of(2);
            nodes.iter().map(|node| if even { phase(node.pixel).cos() } else { phase(node.pixel).sin() }).collect()
        };
        let across = |index: usize| nodes.iter().map(|node| across(node, direction(index))).collect();
        Self {
            values: (0..NUM_WAVES).map(wave).collect(),
            across: (polarization == Polarization::Shear).then(|| (0..DIRECTIONS).map(across).collect()),
        }
    }

    /// Values of all waves.
    pub(crate) fn values(&self) -> &[Vec<f64>] {
        &self.values
    }

    /// Displacement at the nodes in all waves.
    pub(crate) fn fields<const D: usize>(&self) -> impl Iterator<Item = Vec<[f64; D]>> {
        (0..NUM_WAVES).flat_map(|index| self.fields_of(index))
    }

    /// Displacement at the nodes in a cosine in each second direction, none of them along an axis or a diagonal of the image.
    pub(super) fn some_fields<const D: usize>(&self) -> impl Iterator<Item = Vec<[f64; D]>> {
        (2..NUM_WAVES).step_by(4).flat_map(|index| self.fields_of(index))
    }

    /// Displacement at the nodes in a wave: one field for each component, or that of a shear wave.
    fn fields_of<const D: usize>(&self, index: usize) -> impl Iterator<Item = Vec<[f64; D]>> {
        let values = &self.values[index];
        let across = self.across.as_ref().map(|across| &across[index / 2]);
        (0..if across.is_some() { 1 } else { D }).map(move |component| {
            let entry = |node: usize, c: usize| match across {
                Some(across) => across[node].get(c).map_or(0.0, |entry| entry * values[node]),
                None if c == component => values[node],
                None => 0.0,
            };
            (0..values.len()).map(|node| std::array::from_fn(|c| entry(node, c))).collect()
        })
    }
}

/// Unit vector in the image of a direction.
fn direction(index: usize) -> [f64; 2] {
    let (sin, cos) = (PI * index as f64 / DIRECTIONS as f64).sin_cos();
    [cos, sin]
}

/// Unit vector across the gradient, in the plane of `x` and `y`, of a phase that grows along a direction of the image.
fn across(node: &ProjectedPoint, [cos, sin]: [f64; 2]) -> [f64; PLANE] {
    let [of_u, of_v] = node.jacobian;
    let gradient = [0, 1].map(|c| cos * of_u[c] + sin * of_v[c]);
    let norm = gradient[0].hypot(gradient[1]);
    [-gradient[1] / norm, gradient[0] / norm]
}
