//! Shape functions of the five cells and their derivatives on the reference domain.

use crate::{CellType, MAX_NODES};

/// Shape functions at `(xi, eta)`; entries past the cell's number of nodes are zero.
///
/// # Examples
///
/// ```
/// use fedic_mesh::{CellType, shape_values};
/// let n = shape_values(CellType::Quad, [0.0, 0.0]);
/// assert_eq!(&n[..4], &[0.25; 4]);
/// ```
pub fn shape_values(cell: CellType, at: [f64; 2]) -> [f64; MAX_NODES] {
    let [x, y] = at;
    match cell {
        CellType::Triangle => padded(triangle(x, y)),
        CellType::Triangle6 => padded(triangle6(x, y)),
        CellType::Quad => padded(quad(x, y)),
        CellType::Quad8 => padded(quad8(x, y)),
        CellType::Quad9 => quad9(x, y),
    }
}

/// Shape functions at many points: `out[a * n + k]` is the function of node `a` at point `k` of the `n` points.
///
/// # Panics
///
/// If `eta` is shorter than `xi`, or `out` than `num_nodes * xi.len()`.
pub fn shape_values_batch(cell: CellType, xi: &[f64], eta: &[f64], out: &mut [f64]) {
    match cell {
        CellType::Triangle => batch(triangle, xi, eta, out),
        CellType::Triangle6 => batch(triangle6, xi, eta, out),
        CellType::Quad => batch(quad, xi, eta, out),
        CellType::Quad8 => batch(quad8, xi, eta, out),
        CellType::Quad9 => batch(quad9, xi, eta, out),
    }
}

#[inline]
fn batch<const N: usize>(shape: impl Fn(f64, f64) -> [f64; N], xi: &[f64], eta: &[f64], out: &mut [f64]) {
    let n = xi.len();
    let eta = &eta[..n];
    let mut rest = out;
    let rows: [&mut [f64]; N] = std::array::from_fn(|_| {
        let (row, tail) = std::mem::take(&mut rest).split_at_mut(n);
        rest = tail;
        row
    });
    for k in 0..n {
        let values = shape(xi[k], eta[k]);
        for a in 0..N {
            rows[a][k] = values[a];
        }
    }
}

fn padded<const N: usize>(values: [f64; N]) -> [f64; MAX_NODES] {
    let mut out = [0.0; MAX_NODES];
    out[..N].copy_from_slice(&values);
    out
}

#[inline]
fn triangle(x: f64, y: f64) -> [f64; 3] {
    [1.0 - x - y, x, y]
}

#[inline]
fn triangle6(x: f64, y: f64) -> [f64; 6] {
    let l = 1.0 - x - y;
    [l * (2.0 * l - 1.0), x * (2.0 * x - 1.0), y * (2.0 * y - 1.0), 4.0 * l * x, 4.0 * x * y, 4.0 * y * l]
}

#[inline]
fn quad(x: f64, y: f64) -> [f64; 4] {
    let (xm, xp, ym, yp) = (0.5 - 0.5 * x, 0.5 + 0.5 * x, 0.5 - 0.5 * y, 0.5 + 0.5 * y);
    [xm * ym, xp * ym, xp * yp, xm * yp]
}

#[inline]
fn quad8(x: f64, y: f64) -> [f64; 8] {
    let (xm, xp, ym, yp) = (1.0 - x, 1.0 + x, 1.0 - y, 1.0 + y);
    [
        0.25 * xm * ym * (-x - y - 1.0),
        0.25 * xp * ym * (x - y - 1.0),
        0.25 * xp * yp * (x + y - 1.0),
        0.25 * xm * yp * (-x + y - 1.0),
        0.5 * xm * xp * ym,
        0.5 * xp * ym * yp,
        0.5 * xm * xp * yp,
        0.5 * xm * ym * yp,
    ]
}

#[inline]
fn quad9(x: f64, y: f64) -> [f64; 9] {
    let (x0, x1, x2) = (0.5 * x * (x - 1.0), (1.0 - x) * (1.0 + x), 0.5 * x * (x + 1.0));
    let (y0, y1, y2) = (0.5 * y * (y - 1.0), (1.0 - y) * (1.0 + y), 0.5 * y * (y + 1.0));
    [x0 * y0, x2 * y0, x2 * y2, x0 * y2, x1 * y0, x2 * y1, x1 * y2, x0 * y1, x1 * y1]
}

/// Derivatives `(d/dxi, d/deta)` of the shape functions at `(xi, eta)`; entries past the cell's nodes are zero.
pub fn shape_gradients(cell: CellType, at: [f64; 2]) -> [[f64; 2]; MAX_NODES] {
    let [x, y] = at;
    let mut out = [[0.0; 2]; MAX_NODES];
    match cell {
        CellType::Triangle => out[..3].copy_from_slice(&[[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]),
        CellType::Triangle6 => {
            let l = 1.0 - x - y;
            out[..6].copy_from_slice(&[
                [1.0 - 4.0 * l, 1.0 - 4.0 * l],
                [4.0 * x - 1.0, 0.0],
                [0.0, 4.0 * y - 1.0],
                [4.0 * (l - x), -4.0 * x],
                [4.0 * y, 4.0 * x],
                [-4.0 * y, 4.0 * (l - y)],
            ]);
        }
        CellType::Quad => {
            let (xm, xp, ym, yp) = (1.0 - x, 1.0 + x, 1.0 - y, 1.0 + y);
            out[..4].copy_from_slice(&[
                [-0.25 * ym, -0.25 * xm],
                [0.25 * ym, -0.25 * xp],
                [0.25 * yp, 0.25 * xp],
                [-0.25 * yp, 0.25 * xm],
            ]);
        }
        CellType::Quad8 => {
            let (xm, xp, ym, yp) = (1.0 - x, 1.0 + x, 1.0 - y, 1.0 + y);
            out[..8].copy_from_slice(&[
                [0.25 * ym * (2.0 * x + y), 0.25 * xm * (x + 2.0 * y)],
                [0.25 * ym * (2.0 * x - y), 0.25 * xp * (2.0 * y - x)],
                [0.25 * yp * (2.0 * x + y), 0.25 * xp * (x + 2.0 * y)],
                [0.25 * yp * (2.0 * x - y), 0.25 * xm * (2.0 * y - x)],
                [-x * ym, -0.5 * xm * xp],
                [0.5 * ym * yp, -y * xp],
                [-x * yp, 0.5 * xm * xp],
                [-0.5 * ym * yp, -y * xm],
            ]);
        }
        CellType::Quad9 => {
            let fx = [0.5 * x * (x - 1.0), (1.0 - x) * (1.0 + x), 0.5 * x * (x + 1.0)];
            let fy = [0.5 * y * (y - 1.0), (1.0 - y) * (1.0 + y), 0.5 * y * (y + 1.0)];
            let dx = [x - 0.5, -2.0 * x, x + 0.5];
            let dy = [y - 0.5, -2.0 * y, y + 0.5];
            const TENSOR: [(usize, usize); 9] =
                [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)];
            for (gradient, (i, j)) in out.iter_mut().zip(TENSOR) {
                *gradient = [dx[i] * fy[j], fx[i] * dy[j]];
            }
        }
    }
    out
}
