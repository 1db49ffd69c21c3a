//! The isoparametric map from the reference domain to a cell, its Jacobian, and its inverse by Newton's method.

use crate::{CellType, shape_gradients, shape_values};

const MAX_ITERATIONS: usize = 30;
/// Step, in reference coordinates, at which Newton's method stops.
const STEP_TOLERANCE: f64 = 1e-13;
/// Residual, relative to the largest coordinate, below which an iteration that has not settled counts as converged.
const RESIDUAL_TOLERANCE: f64 = 1e-12;

/// Image of `(xi, eta)` under `x = sum_i N_i(xi, eta) s_i` (paper, eq. 9), in the dimension of the nodes.
pub fn map<const D: usize>(cell: CellType, nodes: &[[f64; D]], at: [f64; 2]) -> [f64; D] {
    let n = shape_values(cell, at);
    let mut x = [0.0; D];
    for (s, n) in nodes.iter().zip(n) {
        for d in 0..D {
            x[d] += n * s[d];
        }
    }
    x
}

/// Jacobian of [`map`]: row `d` holds `(dx_d/dxi, dx_d/deta)`.
pub fn jacobian<const D: usize>(cell: CellType, nodes: &[[f64; D]], at: [f64; 2]) -> [[f64; 2]; D] {
    let g = shape_gradients(cell, at);
    let mut j = [[0.0; 2]; D];
    for (s, g) in nodes.iter().zip(g) {
        for d in 0..D {
            j[d][0] += g[0] * s[d];
            j[d][1] += g[1] * s[d];
        }
    }
    j
}

/// Tangent vectors `dx/dxi` and `dx/deta` of a cell in space.
///
/// Heights are taken relative to the first node, so that tangents of a cell parallel to the `(x, y)` plane are exactly so.
pub(crate) fn tangents(cell_type: CellType, nodes: &[[f64; 3]], at: [f64; 2]) -> [[f64; 3]; 2] {
    let g = shape_gradients(cell_type, at);
    let mut tangents = [[0.0; 3]; 2];
    for (&[x, y, z], g) in nodes.iter().zip(g) {
        let s = [x, y, z - nodes[0][2]];
        for (tangent, g) in tangents.iter_mut().zip(g) {
            for d in 0..3 {
                tangent[d] += g * s[d];
            }
        }
    }
    tangents
}

/// Cross product of two vectors.
pub(crate) fn cross([a, b]: [[f64; 3]; 2]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Solution of `j s = r` by Cramer's rule; not finite if `j` is singular.
fn solve(j: &[[f64; 2]; 2], r: [f64; 2]) -> [f64; 2] {
    let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    [(j[1][1] * r[0] - j[0][1] * r[1]) / det, (j[0][0] * r[1] - j[1][0] * r[0]) / det]
}

/// Reference coordinates of a point `x` of the plane, the inverse of [`map`] by Newton's method, or `None` if the iteration
/// does not converge.
///
/// The result may lie outside the reference domain, since the map extends beyond the cell.
///
/// # Examples
///
/// ```
/// use fedic_mesh::{CellType, inverse_map, map};
/// let nodes = [[0.0, 0.0], [3.0, 0.2], [2.5, 2.0], [0.1, 1.5]];
/// let x = map(CellType::Quad, &nodes, [0.3, -0.6]);
/// let at = inverse_map(CellType::Quad, &nodes, x).unwrap();
/// assert!((at[0] - 0.3).abs() < 1e-12 && (at[1] + 0.6).abs() < 1e-12);
/// ```
pub fn inverse_map(cell: CellType, nodes: &[[f64; 2]], x: [f64; 2]) -> Option<[f64; 2]> {
    let mut at = cell.reference_centre();
    for _ in 0..MAX_ITERATIONS {
        let y = map(cell, nodes, at);
        let step = solve(&jacobian(cell, nodes, at), [x[0] - y[0], x[1] - y[1]]);
        if !(step[0].is_finite() && step[1].is_finite()) {
            return None;
        }
        at = [at[0] + step[0], at[1] + step[1]];
        if step[0].abs().max(step[1].abs()) <= STEP_TOLERANCE.max(f64::EPSILON * at[0].abs().max(at[1].abs())) {
            return Some(at);
        }
    }
    let y = map(cell, nodes, at);
    let scale = nodes.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
    let residual = (x[0] - y[0]).abs().max((x[1] - y[1]).abs());
    (residual <= RESIDUAL_TOLERANCE * scale).then_some(at)
}
