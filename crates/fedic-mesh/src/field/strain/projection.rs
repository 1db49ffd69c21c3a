//! `L^2` projection of a field given inside the cells onto the shape functions.

use rayon::prelude::*;

use crate::field::gauss::gauss_quadrature;
use crate::isoparametric::{cross, tangents};
use crate::{MAX_NODES, Mesh, shape_values};

/// Residual, relative to the right-hand side, at which the conjugate gradients stop.
const TOLERANCE: f64 = 1e-15;
/// Mass matrices scaled by their diagonal have condition numbers of about ten, whatever the mesh: fifty iterations do.
const MAX_ITERATIONS: usize = 200;

/// Shares of a cell in the mass matrix and the right-hand sides.
struct CellShare<const K: usize> {
    cell: usize,
    mass: [[f64; MAX_NODES]; MAX_NODES],
    load: [[f64; K]; MAX_NODES],
}

/// Nodal values of the field of shape functions that is closest, in the mean square, to the field `value(cell, at)` of `K`
/// components given at reference points of the cells.
///
/// Cells where the field is not finite do not take part; nodes of no other cell are NaN.
pub(super) fn project<const K: usize>(
    mesh: &Mesh,
    value: impl Fn(usize, [f64; 2]) -> [f64; K] + Sync,
) -> Vec<[f64; K]> {
    let shares: Vec<CellShare<K>> = (0..mesh.num_cells())
        .into_par_iter()
        .filter_map(|cell| CellShare::new(mesh, cell, |at| value(cell, at)))
        .collect();
    let mut load = vec![[0.0; K]; mesh.num_nodes()];
    let mut diagonal = vec![0.0; mesh.num_nodes()];
    for share in &shares {
        let nodes = mesh.cell(share.cell).nodes;
        for (a, &row) in nodes.iter().enumerate() {
            for (sum, part) in load[row as usize].iter_mut().zip(share.load[a]) {
                *sum += part;
            }
            // A node that a cell has twice adds its off-diagonal entries as well.
            let columns = nodes.iter().zip(share.mass[a]).filter(|&(&column, _)| column == row);
            diagonal[row as usize] += columns.map(|(_, mass)| mass).sum::<f64>();
        }
    }
    let mut nodal = vec![[f64::NAN; K]; mesh.num_nodes()];
    for k in 0..K {
        let right: Vec<f64> = load.iter().map(|row| row[k]).collect();
        let solution = conjugate_gradients(&diagonal, &right, |x, y| multiply(mesh, &shares, x, y));
        for ((value, solution), &mass) in nodal.iter_mut().zip(solution).zip(&diagonal) {
            if mass > 0.0 {
                value[k] = solution;
            }
        }
    }
    nodal
}

impl<const K: usize> CellShare<K> {
    /// Integrals over a cell by Gauss quadrature; `None` if the field is not finite somewhere in it.
    fn new(mesh: &Mesh, cell: usize, value: impl Fn([f64; 2]) -> [f64; K]) -> Option<Self> {
        let (points, num_nodes) = mesh.cell_points_array(cell);
        let cell_type = mesh.cell(cell).cell_type;
        let mut share = Self { cell, mass: [[0.0; MAX_NODES]; MAX_NODES], load: [[0.0; K]; MAX_NODES] };
        for (at, weight) in gauss_quadrature(cell_type.data().domain) {
            let [x, y, z] = cross(tangents(cell_type, &points[..num_nodes], at));
            let weight = weight * (x * x + y * y + z * z).sqrt();
            let value = value(at);
            if !value.iter().all(|component| component.is_finite()) {
                return None;
            }
            let n = shape_values(cell_type, at);
            for a in 0..num_nodes {
                for b in 0..num_nodes {
                    share.mass[a][b] += weight * n[a] * n[b];
                }
                for (load, component) in share.load[a].iter_mut().zip(value) {
                    *load += weight * n[a] * component;
                }
            }
        }
        Some(share)
    }
}

/// Product `y = M x` of the mass matrix.
fn multiply<const K: usize>(mesh: &Mesh, shares: &[CellShare<K>], x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    for share in shares {
        let nodes = mesh.cell(share.cell).nodes;
        for (row, &node) in share.mass.iter().zip(nodes) {
            y[node as usize] += nodes.iter().zip(row).map(|(&column, mass)| mass * x[column as usize]).sum::<f64>();
        }
    }
}

/// Solution of `A x = b` by conjugate gradients preconditioned by the diagonal; zero in rows with a diagonal of zero.
fn conjugate_gradients(diagonal: &[f64], right: &[f64], multiply: impl Fn(&[f64], &mut [f64])) -> Vec<f64> {
    let precondition =
        |r: &[f64]| -> Vec<f64> { r.iter().zip(diagonal).map(|(r, &d)| if d > 0.0 { r / d } else { 0.0 }).collect() };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut solution = vec![0.0; right.len()];
    let mut residual = right.to_vec();
    let mut scaled = precondition(&residual);
    let mut direction = scaled.clone();
    let mut product = vec![0.0; right.len()];
    let mut square = dot(&residual, &scaled);
    let target = TOLERANCE * TOLERANCE * square;
    for _ in 0..MAX_ITERATIONS {
        if square <= target {
            break;
        }
        multiply(&direction, &mut product);
        let step = square / dot(&direction, &product);
        for k in 0..right.len() {
            solution[k] += step * direction[k];
            residual[k] -= step * product[k];
        }
        scaled = precondition(&residual);
        let next = dot(&residual, &scaled);
        for (direction, scaled) in direction.iter_mut().zip(&scaled) {
            *direction = scaled + next / square * *direction;
        }
        square = next;
    }
    solution
}
