//! Nine-node quadrilateral, biquadratic.

use super::{CellData, GmshElement, ReferenceDomain};

pub(super) const DATA: CellData = CellData {
    name: "quad9",
    domain: ReferenceDomain::Square,
    reference_nodes: &[
        [-1.0, -1.0],
        [1.0, -1.0],
        [1.0, 1.0],
        [-1.0, 1.0],
        [0.0, -1.0],
        [1.0, 0.0],
        [0.0, 1.0],
        [-1.0, 0.0],
        [0.0, 0.0],
    ],
    outline: &[0, 4, 1, 5, 2, 6, 3, 7],
    reversed: &[0, 3, 2, 1, 7, 6, 5, 4, 8],
    linear_parts: &[&[0, 4, 8, 7], &[4, 1, 5, 8], &[8, 5, 2, 6], &[7, 8, 6, 3]],
    grid_intervals: 2,
    determines: |i, j| i + j <= 4,
    vtk_type: 28,
    gmsh: Some(GmshElement { order: 2, incomplete: false }),
    abaqus_suffixes: &["9"],
};

#[inline]
pub(super) fn values(x: f64, y: f64) -> [f64; 9] {
    let (x0, x1, x2) = (0.5 * x * (x - 1.0), (1.0 - x) * (1.0 + x), 0.5 * x * (x + 1.0));
    let (y0, y1, y2) = (0.5 * y * (y - 1.0), (1.0 - y) * (1.0 + y), 0.5 * y * (y + 1.0));
    [x0 * y0, x2 * y0, x2 * y2, x0 * y2, x1 * y0, x2 * y1, x1 * y2, x0 * y1, x1 * y1]
}

pub(super) fn gradients(x: f64, y: f64) -> [[f64; 2]; 9] {
    let fx = [0.5 * x * (x - 1.0), (1.0 - x) * (1.0 + x), 0.5 * x * (x + 1.0)];
    let fy = [0.5 * y * (y - 1.0), (1.0 - y) * (1.0 + y), 0.5 * y * (y + 1.0)];
    let dx = [x - 0.5, -2.0 * x, x + 0.5];
    let dy = [y - 0.5, -2.0 * y, y + 0.5];
    const TENSOR: [(usize, usize); 9] = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)];
    TENSOR.map(|(i, j)| [dx[i] * fy[j], fx[i] * dy[j]])
}
