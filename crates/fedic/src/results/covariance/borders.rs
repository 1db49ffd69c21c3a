//! Noise at the border of the mesh.
//!
//! The noise of the right-hand side is that of the images gathered with the weights `G * (chi N q)`: the sensitivities inside the mesh
//! (`chi = 1`), smoothed. Near the border that is less than `chi N (G * q)`. For a texture with the wavenumber `k` across the border
//! the squares lack those over a strip of the width `s / sqrt(pi) (1 - 2 x D(x))`, with `x = s k` and Dawson's function `D`.

use fedic_mesh::Mesh;

use crate::projection::cell_edges::CellEdges;
use crate::projection::projected_points::ProjectedPoint;

/// `1 - 2 x D(x)`, relative to the energy `exp(-x^2)` that passes the smoothing, for speckle about five pixels wide smoothed by 0.8
/// pixels: `x = 0.5`.
const STRIP: f64 = 0.74;
/// Distance from the border, in standard deviations of the smoothing, up to which the noise is less.
const REACH: f64 = 4.0;

/// Edges on the border of the mesh, and the smoothing.
pub(super) struct Borders {
    edges: CellEdges,
    smoothing: f64,
}

impl Borders {
    /// Edges of a mesh with these projected nodes; none without a smoothing.
    pub(super) fn new(mesh: &Mesh, nodes: &[ProjectedPoint], smoothing: f64) -> Self {
        let edges = if smoothing > 0.0 { CellEdges::borders(mesh, nodes) } else { CellEdges::default() };
        Self { edges, smoothing }
    }

    /// Variance of the noise gathered at an image point of a cell, relative to that far from the border.
    pub(super) fn factor(&self, cell: usize, point: [f64; 2]) -> f64 {
        let distances = self.edges.distances(cell, point).map(|distance| distance / self.smoothing);
        distances.filter(|&distance| distance < REACH).map(|distance| 1.0 - STRIP * strip(distance)).product()
    }
}

/// Part of the squares that is lacking at a distance from the border, in standard deviations: `2 Phi (1 - Phi)` with the normal
/// distribution `Phi`, whose integral is `1 / sqrt(pi)`.
fn strip(distance: f64) -> f64 {
    let phi = normal_distribution(distance);
    2.0 * phi * (1.0 - phi)
}

/// Normal distribution, to 1e-7 (Abramowitz and Stegun, 26.2.17, for positive numbers).
fn normal_distribution(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x);
    let series = [0.319_381_530, -0.356_563_782, 1.781_477_937, -1.821_255_978, 1.330_274_429];
    let sum = series.iter().rev().fold(0.0, |sum, c| (sum + c) * t);
    1.0 - (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt() * sum
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_camera::ImageFrame;
    use fedic_mesh::{CellType, rectangle_mesh};

    use super::*;
    use crate::projection::projected_points::project_nodes;

    #[test]
    fn the_strip_has_the_stated_width() {
        let step = 1e-3;
        let width: f64 = (0..8000).map(|k| step * strip((f64::from(k) + 0.5) * step)).sum();
        assert!((width - std::f64::consts::PI.sqrt().recip()).abs() < 1e-5, "{width}");
    }

    #[test]
    fn only_points_near_the_border_have_less_noise() {
        for cell_type in CellType::ALL {
            let mesh = rectangle_mesh([0.0, 0.0, 60.0, 40.0], 20.0, cell_type).unwrap();
            let nodes = project_nodes::<2>(&mesh, &ImageFrame, None);
            let borders = Borders::new(&mesh, &nodes, 0.8);
            for cell in 0..mesh.num_cells() {
                let centre = mesh.cell_points(cell).iter().fold([0.0; 2], |sum, p| [sum[0] + p[0], sum[1] + p[1]]);
                let centre = centre.map(|c| c / mesh.cell_points(cell).len() as f64);
                assert_eq!(borders.factor(cell, centre), 1.0);
            }
            assert!((borders.factor(0, [7.0, 0.0]) - (1.0 - 0.5 * STRIP)).abs() < 1e-6);
            assert_eq!(Borders::new(&mesh, &nodes, 0.0).factor(0, [7.0, 0.0]), 1.0);
        }
    }
}
