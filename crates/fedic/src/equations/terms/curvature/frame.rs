//! Coordinates of the points of a patch in its tangent plane.

use fedic_mesh::Mesh;
use nalgebra::Vector3;

use crate::PLANE;
use crate::equations::patches::{Patch, position};

/// Smallest component of the normal along `z` with which points are projected along `z`.
const STEEP: f64 = 0.05;

/// Coordinates of the points of a patch in its tangent plane.
///
/// For displacements in the plane (`D` = 2) the points are projected along `z`: the coordinates are then affine functions of `x` and
/// `y`, on curved surfaces too, and displacements that are affine in `x` and `y` are affine in the coordinates. Otherwise, and where
/// the surface is nearly parallel to `z`, they are projected along the normal.
pub(super) fn in_tangent_plane<const D: usize>(mesh: &Mesh, patch: &Patch) -> Vec<[f64; 2]> {
    let normal = Vector3::from(patch.normal);
    let along = if D == PLANE && normal.z.abs() > STEEP { Vector3::z() } else { normal };
    // Of the axes x and y the one that is nearer to the plane.
    let axis = if normal.x.abs() <= normal.y.abs() { Vector3::x() } else { Vector3::y() };
    let s = (axis - normal * normal.dot(&axis)).normalize();
    let t = normal.cross(&s);
    let points: Vec<Vector3<f64>> = patch.points.iter().map(|&point| position(mesh, point).into()).collect();
    let coordinates = |point: &Vector3<f64>| {
        let offset = point - points[0];
        let in_plane = offset - along * (normal.dot(&offset) / normal.dot(&along));
        [s.dot(&in_plane), t.dot(&in_plane)]
    };
    points.iter().map(coordinates).collect()
}
