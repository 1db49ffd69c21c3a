//! Four-node quadrilateral, bilinear.

use super::{CellData, GmshElement, ReferenceDomain};

pub(super) const DATA: CellData = CellData {
    name: "quad",
    domain: ReferenceDomain::Square,
    reference_nodes: &[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]],
    outline: &[0, 1, 2, 3],
    reversed: &[0, 3, 2, 1],
    linear_parts: &[&[0, 1, 2, 3]],
    grid_intervals: 1,
    // Corners and centre do not tell fourth powers from squares.
    determines: |i, j| i + j <= 4 && i < 4 && j < 4,
    vtk_type: 9,
    gmsh: Some(GmshElement { order: 1, incomplete: false }),
    abaqus_suffixes: &["4"],
};

#[inline]
pub(super) fn values(x: f64, y: f64) -> [f64; 4] {
    let (xm, xp, ym, yp) = (0.5 - 0.5 * x, 0.5 + 0.5 * x, 0.5 - 0.5 * y, 0.5 + 0.5 * y);
    [xm * ym, xp * ym, xp * yp, xm * yp]
}

pub(super) fn gradients(x: f64, y: f64) -> [[f64; 2]; 4] {
    let (xm, xp, ym, yp) = (1.0 - x, 1.0 + x, 1.0 - y, 1.0 + y);
    [[-0.25 * ym, -0.25 * xm], [0.25 * ym, -0.25 * xp], [0.25 * yp, 0.25 * xp], [-0.25 * yp, 0.25 * xm]]
}
