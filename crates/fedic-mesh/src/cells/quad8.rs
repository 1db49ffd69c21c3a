//! Eight-node quadrilateral, quadratic serendipity.

use super::{CellData, GmshElement, ReferenceDomain};

pub(super) const DATA: CellData = CellData {
    name: "quad8",
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
    ],
    outline: &[0, 4, 1, 5, 2, 6, 3, 7],
    reversed: &[0, 3, 2, 1, 7, 6, 5, 4],
    linear_parts: &[&[0, 4, 8, 7], &[4, 1, 5, 8], &[8, 5, 2, 6], &[7, 8, 6, 3]],
    grid_intervals: 2,
    determines: |i, j| i + j <= 4,
    vtk_type: 23,
    gmsh: Some(GmshElement { order: 2, incomplete: true }),
    abaqus_suffixes: &["8"],
};

#[inline]
pub(super) fn values(x: f64, y: f64) -> [f64; 8] {
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

pub(super) fn gradients(x: f64, y: f64) -> [[f64; 2]; 8] {
    let (xm, xp, ym, yp) = (1.0 - x, 1.0 + x, 1.0 - y, 1.0 + y);
    [
        [0.25 * ym * (2.0 * x + y), 0.25 * xm * (x + 2.0 * y)],
        [0.25 * ym * (2.0 * x - y), 0.25 * xp * (2.0 * y - x)],
        [0.25 * yp * (2.0 * x + y), 0.25 * xp * (x + 2.0 * y)],
        [0.25 * yp * (2.0 * x - y), 0.25 * xm * (2.0 * y - x)],
        [-x * ym, -0.5 * xm * xp],
        [0.5 * ym * yp, -y * xp],
        [-x * yp, 0.5 * xm * xp],
        [-0.5 * ym * yp, -y * xm],
    ]
}
