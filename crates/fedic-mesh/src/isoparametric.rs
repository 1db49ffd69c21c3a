//! The isoparametric map from the reference domain to a cell, its Jacobian, and its inverse by Newton's method.

use crate::{CellType, shape_gradients, shape_values};

const MAX_NEWTON: usize = 30;
const NEWTON_TOLERANCE: f64 = 1e-13;

/// Image of `(xi, eta)` under `x = sum_i N_i(xi, eta) s_i` (paper, eq. 9), in as many dimensions as the nodes have.
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

/// Determinant of a plane Jacobian.
pub(crate) fn determinant(j: &[[f64; 2]; 2]) -> f64 {
    j[0][0] * j[1][1] - j[0][1] * j[1][0]
}

/// Reference point that [`map`] takes to `x` in the plane, or `None` where Newton's method does not converge.
///
/// The point may lie outside the reference domain: the map is inverted, not the cell searched.
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
    for _ in 0..MAX_NEWTON {
        let y = map(cell, nodes, at);
        let j = jacobian(cell, nodes, at);
        let r = [x[0] - y[0], x[1] - y[1]];
        let det = determinant(&j);
        let step = [(j[1][1] * r[0] - j[0][1] * r[1]) / det, (j[0][0] * r[1] - j[1][0] * r[0]) / det];
        if !(step[0].is_finite() && step[1].is_finite()) {
            return None;
        }
        at = [at[0] + step[0], at[1] + step[1]];
        if step[0].abs().max(step[1].abs()) <= NEWTON_TOLERANCE.max(f64::EPSILON * at[0].abs().max(at[1].abs())) {
            return Some(at);
        }
    }
    let y = map(cell, nodes, at);
    let scale = nodes.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
    let residual = (x[0] - y[0]).abs().max((x[1] - y[1]).abs());
    (residual <= 1e-12 * scale).then_some(at)
}
