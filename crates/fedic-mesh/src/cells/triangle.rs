//! Three-node triangle, linear.

use super::{CellData, GmshElement, ReferenceDomain};

pub(super) const DATA: CellData = CellData {
    name: "triangle",
    domain: ReferenceDomain::Triangle,
    reference_nodes: &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
    outline: &[0, 1, 2],
    reversed: &[0, 2, 1],
    linear_parts: &[&[0, 1, 2]],
    grid_intervals: 1,
    determines: |i, j| i + j <= 3,
    vtk_type: 5,
    gmsh: Some(GmshElement { order: 1, incomplete: false }),
    abaqus_suffixes: &["3"],
};

#[inline]
pub(super) fn values(x: f64, y: f64) -> [f64; 3] {
    [1.0 - x - y, x, y]
}

pub(super) fn gradients(_: f64, _: f64) -> [[f64; 2]; 3] {
    [[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]]
}
