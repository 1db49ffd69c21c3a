//! The interface of all cameras.

use std::fmt::Debug;

use crate::batch::{project_each, project_each_with_jacobian};

/// A projection from physical space to an image.
///
/// A camera implements the methods for a single point. The batch methods follow from them and are compiled once per
/// camera type, so that a call through `dyn Camera` costs one dispatch per batch.
pub trait Camera: Debug + Send + Sync {
    /// Image point `[u, v]` of a world point; NaN if the camera cannot see the point.
    fn project(&self, point: [f64; 3]) -> [f64; 2];

    /// Image point and its Jacobian: row 0 is `(du/dX, du/dY, du/dZ)`, row 1 is `(dv/dX, dv/dY, dv/dZ)`.
    fn project_with_jacobian(&self, point: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]);

    /// The Jacobian if it is the same everywhere (paper, eq. 19).
    fn constant_jacobian(&self) -> Option<[[f64; 3]; 2]> {
        None
    }

    /// Returns `true` if the lens model folds between the optical axis and this point, where a real lens would not
    /// show the point at its projection.
    fn is_beyond_fold(&self, _point: [f64; 3]) -> bool {
        false
    }

    /// Returns `true` if the lens is calibrated at this point; elsewhere the projection is extrapolated.
    fn covers(&self, _point: [f64; 3]) -> bool {
        true
    }

    /// Returns `true` if the lens is a piecewise polynomial, whose third derivatives jump between the pieces.
    fn is_piecewise(&self) -> bool {
        false
    }

    /// World point of the plane `Z = z` at `pixel` if the lens distortion is ignored: exact for a camera without
    /// distortion, and the start of the Newton iteration of [`unproject`](crate::unproject) for others.
    fn unproject_linear(&self, pixel: [f64; 2], z: f64) -> [f64; 3];

    /// [`project`](Self::project) for many points, given by components; all slices have the same length.
    fn project_batch(&self, x: &[f64], y: &[f64], z: &[f64], u: &mut [f64], v: &mut [f64]) {
        project_each(|point| self.project(point), [x, y, z], [u, v]);
    }

    /// [`project_with_jacobian`](Self::project_with_jacobian) for many points; the slices `jacobian[r][c]` have the same
    /// length as the others.
    fn project_with_jacobian_batch(
        &self,
        x: &[f64],
        y: &[f64],
        z: &[f64],
        u: &mut [f64],
        v: &mut [f64],
        jacobian: &mut [[&mut [f64]; 3]; 2],
    ) {
        project_each_with_jacobian(|point| self.project_with_jacobian(point), [x, y, z], [u, v], jacobian);
    }
}
