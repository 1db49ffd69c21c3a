//! Gradients along a surface in space.

use crate::isoparametric::{cross, tangents};
use crate::{CellType, MAX_NODES, shape_gradients};

/// Below this sine of the angle between the normal and the `x` axis, the first axis is taken from the `y` axis.
const ALONG_X: f64 = 1e-6;

/// Local axes at a point of a cell, and the gradients of its shape functions along them.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceGradients {
    /// Orthonormal axes: two in the tangent plane, and the normal.
    ///
    /// The first is the projection of the `x` axis onto the tangent plane, the third the normal that sees the cell
    /// counter-clockwise, and the second their cross product, normal times first axis. If the normal is parallel to the `x`
    /// axis (to 1e-6 radians), the first axis is the projection of the `y` axis. On a plane parallel to `(x, y)` the axes are
    /// `x`, `y`, `z`.
    pub axes: [[f64; 3]; 3],
    /// Derivatives of the shape functions along the first two axes; entries beyond the cell's number of nodes are zero.
    pub shape: [[f64; 2]; MAX_NODES],
}

/// Local axes and gradients of the shape functions at the reference point `at` of a cell in space.
pub fn surface_gradients(cell_type: CellType, nodes: &[[f64; 3]], at: [f64; 2]) -> SurfaceGradients {
    let tangents = tangents(cell_type, nodes, at);
    let axes = local_axes(cross(tangents));
    // Jacobian of the map from the reference domain to the tangent plane.
    let [xx, xy] = tangents.map(|tangent| dot(axes[0], tangent));
    let [yx, yy] = tangents.map(|tangent| dot(axes[1], tangent));
    let det = xx * yy - xy * yx;
    let shape = shape_gradients(cell_type, at)
        .map(|[along_xi, along_eta]| [(yy * along_xi - yx * along_eta) / det, (xx * along_eta - xy * along_xi) / det]);
    SurfaceGradients { axes, shape }
}

impl SurfaceGradients {
    /// Gradient of a nodal vector field: row `a`, column `b` is the derivative of its component along axis `a` with respect
    /// to the position along axis `b`.
    ///
    /// `nodal` yields the vectors of the cell's nodes in order. Vectors of two components lie in the `(x, y)` plane.
    pub fn of_vectors<const D: usize>(&self, nodal: impl IntoIterator<Item = [f64; D]>) -> [[f64; 2]; 3] {
        const { assert!(D == 2 || D == 3, "vectors have two or three components") }
        let mut gradient = [[0.0; 2]; 3];
        for (vector, slope) in nodal.into_iter().zip(self.shape) {
            for (row, axis) in gradient.iter_mut().zip(self.axes) {
                let component: f64 = (0..D).map(|d| vector[d] * axis[d]).sum();
                row[0] += component * slope[0];
                row[1] += component * slope[1];
            }
        }
        gradient
    }
}

pub(super) fn local_axes(normal: [f64; 3]) -> [[f64; 3]; 3] {
    let normal = normalized(normal);
    let projected = |axis: usize| {
        let mut projection = normal.map(|c| -normal[axis] * c);
        projection[axis] += 1.0;
        projection
    };
    let along_x = projected(0);
    let first = normalized(if dot(along_x, along_x).sqrt() > ALONG_X { along_x } else { projected(1) });
    [first, cross([normal, first]), normal]
}

fn normalized(vector: [f64; 3]) -> [f64; 3] {
    let length = dot(vector, vector).sqrt();
    vector.map(|c| c / length)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
