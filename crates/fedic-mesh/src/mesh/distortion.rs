//! Strongly distorted cells.

use super::Mesh;
use crate::isoparametric::{cross, tangents};

impl Mesh {
    /// Ratio of area elements below which the measurement warns of [`distorted_cells`](Self::distorted_cells).
    pub const DISTORTED: f64 = 1.0 / 30.0;

    /// Cells whose area element at some node is less than `ratio` times the largest at their nodes, ascending.
    ///
    /// Quadrilaterals with a repeated node count as the triangles they stand for.
    pub fn distorted_cells(&self, ratio: f64) -> Vec<usize> {
        let mesh = self.collapsed_as_triangles();
        let is_distorted = |&index: &usize| {
            let cell_type = mesh.cell(index).cell_type;
            let (points, num_nodes) = mesh.cell_points_array(index);
            let elements = cell_type.reference_nodes().iter().map(|&at| {
                let normal = cross(tangents(cell_type, &points[..num_nodes], at));
                normal.iter().map(|c| c * c).sum::<f64>().sqrt()
            });
            let (least, most) = elements.fold((f64::INFINITY, 0.0_f64), |(l, m), e| (l.min(e), m.max(e)));
            least < ratio * most
        };
        (0..mesh.num_cells()).filter(is_distorted).collect()
    }
}
