//! Displacement fields and their inversion along the rays of a camera.

use std::error::Error;

use rayon::prelude::*;

use crate::error::SyntheticError;
use crate::plane::Plane;

/// Largest number of fixed-point iterations.
const MAX_ITERATIONS: usize = 60;

/// Accepted change of a point in the last iteration, relative to the extent of the points.
const TOLERANCE: f64 = 1e-10;

/// A displacement as a function of material points: the point `X` moves to `X + U(X)`.
///
/// A function of one point is a displacement field; implement the trait to evaluate many points together.
pub trait DisplacementField {
    /// Displacement of each of the material points, in their unit.
    ///
    /// # Errors
    ///
    /// Any failure ends the rendering as [`SyntheticError::Displacement`].
    fn displacements(&self, points: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, Box<dyn Error + Send + Sync>>;
}

impl<F: Fn([f64; 3]) -> [f64; 3] + Sync> DisplacementField for F {
    fn displacements(&self, points: &[[f64; 3]]) -> Result<Vec<[f64; 3]>, Box<dyn Error + Send + Sync>> {
        Ok(points.par_iter().map(|&point| self(point)).collect())
    }
}

/// The ray through a point of an image, near a plane.
#[derive(Clone, Copy, Default)]
pub(crate) struct Ray {
    /// Coordinates of the intersection with the plane.
    pub(crate) foot: [f64; 2],
    /// Change of the coordinates per unit of distance along the normal.
    pub(crate) slope: [f64; 2],
}

/// Coordinates, at rest, of the material points of a plane that rays meet after the displacement.
///
/// The point at `p` moves to `p + u(p)` in the plane and by `w(p)` along the normal; the ray meets it where
/// `p + u(p) = foot + w(p) slope`. The fixed-point iteration converges if the displacement's gradient is well below 1.
pub(crate) fn material_points(
    plane: &Plane,
    rays: &[Ray],
    field: &dyn DisplacementField,
) -> Result<Vec<[f64; 2]>, SyntheticError> {
    let tolerance = TOLERANCE * extent(rays).max(f64::MIN_POSITIVE);
    let mut points: Vec<[f64; 2]> = rays.iter().map(|ray| ray.foot).collect();
    let mut step = f64::NAN;
    for _ in 0..MAX_ITERATIONS {
        let material: Vec<[f64; 3]> = points.par_iter().map(|&point| plane.point(point)).collect();
        let displacements = field.displacements(&material).map_err(SyntheticError::Displacement)?;
        if displacements.len() != points.len() {
            let message = format!("{} displacements were given for {} points", displacements.len(), points.len());
            return Err(SyntheticError::Displacement(message.into()));
        }
        step = points
            .par_iter_mut()
            .zip(rays)
            .zip(displacements)
            .map(|((point, ray), displacement)| {
                let [along_a, along_b, along_normal] = plane.components(displacement);
                let next = [
                    ray.foot[0] + along_normal * ray.slope[0] - along_a,
                    ray.foot[1] + along_normal * ray.slope[1] - along_b,
                ];
                let step = largest((next[0] - point[0]).abs(), (next[1] - point[1]).abs());
                *point = next;
                step
            })
            .reduce(|| 0.0, largest);
        if step <= tolerance {
            return Ok(points);
        }
    }
    Err(SyntheticError::NotInvertible { iterations: MAX_ITERATIONS, step, tolerance })
}

/// The larger of two numbers; NaN if one of them is.
fn largest(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// The larger side of the bounding box of the feet.
fn extent(rays: &[Ray]) -> f64 {
    [0, 1]
        .map(|c| {
            let bounds = rays.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], ray| {
                [low.min(ray.foot[c]), high.max(ray.foot[c])]
            });
            bounds[1] - bounds[0]
        })
        .into_iter()
        .fold(0.0, f64::max)
}
