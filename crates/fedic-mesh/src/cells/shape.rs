//! Evaluation of the shape functions of any cell type.

use super::{CellType, MAX_NODES};

/// Shape functions at `(xi, eta)`; entries beyond the cell's number of nodes are zero.
///
/// # Examples
///
/// ```
/// use fedic_mesh::{CellType, shape_values};
/// let n = shape_values(CellType::Quad, [0.0, 0.0]);
/// assert_eq!(&n[..4], &[0.25; 4]);
/// ```
pub fn shape_values(cell_type: CellType, at: [f64; 2]) -> [f64; MAX_NODES] {
    cell_type.padded_values(at)
}

/// Derivatives `(d/dxi, d/deta)` of the shape functions at `(xi, eta)`; entries beyond the cell's number of nodes are zero.
pub fn shape_gradients(cell_type: CellType, at: [f64; 2]) -> [[f64; 2]; MAX_NODES] {
    cell_type.padded_gradients(at)
}

/// Shape functions at many points: `out[a * n + k]` is the function of node `a` at point `k` of the `n` points.
///
/// # Panics
///
/// If `eta` is shorter than `xi`, or `out` than `num_nodes * xi.len()`.
pub fn shape_values_batch(cell_type: CellType, xi: &[f64], eta: &[f64], out: &mut [f64]) {
    cell_type.batch_values(xi, eta, out);
}

#[inline]
pub(super) fn batch<const N: usize>(values: impl Fn(f64, f64) -> [f64; N], xi: &[f64], eta: &[f64], out: &mut [f64]) {
    let n = xi.len();
    let eta = &eta[..n];
    let mut rest = out;
    let rows: [&mut [f64]; N] = std::array::from_fn(|_| {
        let (row, tail) = std::mem::take(&mut rest).split_at_mut(n);
        rest = tail;
        row
    });
    for k in 0..n {
        let values = values(xi[k], eta[k]);
        for a in 0..N {
            rows[a][k] = values[a];
        }
    }
}

#[inline]
pub(super) fn padded<T: Copy + Default, const N: usize>(values: [T; N]) -> [T; MAX_NODES] {
    let mut out = [T::default(); MAX_NODES];
    out[..N].copy_from_slice(&values);
    out
}
