//! Six-node triangle, quadratic.

use super::{CellData, GmshElement, ReferenceDomain};

pub(super) const DATA: CellData = CellData {
    name: "triangle6",
    domain: ReferenceDomain::Triangle,
    reference_nodes: &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]],
    outline: &[0, 3, 1, 4, 2, 5],
    reversed: &[0, 2, 1, 5, 4, 3],
    linear_parts: &[&[0, 3, 5], &[3, 1, 4], &[5, 4, 2], &[3, 4, 5]],
    grid_intervals: 2,
    determines: |i, j| i + j <= 4,
    vtk_type: 22,
    gmsh: Some(GmshElement { order: 2, incomplete: false }),
    abaqus_suffixes: &["6", "65"],
};

#[inline]
pub(super) fn values(x: f64, y: f64) -> [f64; 6] {
    let l = 1.0 - x - y;
    [l * (2.0 * l - 1.0), x * (2.0 * x - 1.0), y * (2.0 * y - 1.0), 4.0 * l * x, 4.0 * x * y, 4.0 * y * l]
}

pub(super) fn gradients(x: f64, y: f64) -> [[f64; 2]; 6] {
    let l = 1.0 - x - y;
    [
        [1.0 - 4.0 * l, 1.0 - 4.0 * l],
        [4.0 * x - 1.0, 0.0],
        [0.0, 4.0 * y - 1.0],
        [4.0 * (l - x), -4.0 * x],
        [4.0 * y, 4.0 * x],
        [-4.0 * y, 4.0 * (l - y)],
    ]
}
