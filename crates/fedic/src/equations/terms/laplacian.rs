//! First-order penalty: the squared gradient of the displacement. Translations alone cost nothing.

use fedic_camera::Camera;
use fedic_mesh::{Mesh, Subdivision, jacobian, shape_gradients};
use fedic_sparse::{Pattern, SymmetricMatrix};

/// Number of subdivisions of each edge for the integrals over a cell.
const SUBDIVISIONS: u32 = 8;

/// `integral of grad N_i . grad N_j` for every component, and the area of the mesh.
#[derive(Debug, Clone)]
pub(crate) struct Laplacian {
    pub(crate) matrix: SymmetricMatrix,
    pub(crate) area: f64,
}

impl Laplacian {
    /// Assembles the matrix for `D` unknowns at each node, on a pattern of the cells of the mesh.
    pub(crate) fn new<const D: usize>(mesh: &Mesh, pattern: &Pattern) -> Self {
        let mut matrix = SymmetricMatrix::zeros(pattern);
        let mut area = 0.0;
        for cell in 0..mesh.num_cells() {
            let (entries, cell_area) = cell_laplacian::<D>(mesh, cell);
            matrix.add_cell(pattern, cell, &entries);
            area += cell_area;
        }
        Self { matrix, area }
    }

    /// Factor with which the penalty weighs as much as the image for a displacement of this wavelength, in pixels.
    ///
    /// A wave of wavelength `T` has a squared gradient of `(2 pi / T)^2` times its square; the Hessian gives that square the weight
    /// `trace(M) / (D area)` on average.
    pub(crate) fn factor_of_wavelength<const D: usize>(
        &self,
        mesh: &Mesh,
        camera: &dyn Camera,
        hessian_trace: f64,
        wavelength: f64,
    ) -> f64 {
        let points = mesh.points();
        let scale = points.iter().map(|&point| pixels_per_unit(camera, point)).sum::<f64>() / points.len() as f64;
        let length = wavelength / scale;
        let weight = hessian_trace / (D as f64 * self.area);
        weight * (length / std::f64::consts::TAU).powi(2)
    }
}

fn cell_laplacian<const D: usize>(mesh: &Mesh, cell: usize) -> (Vec<f64>, f64) {
    let cell_type = mesh.cell(cell).cell_type;
    let nodes = mesh.cell_points(cell);
    let subdivision = Subdivision::uniform(cell_type, SUBDIVISIONS);
    let size = nodes.len() * D;
    let mut entries = vec![0.0; size * size];
    let mut area = 0.0;
    for at in subdivision.all_points() {
        let j = jacobian(cell_type, &nodes, at);
        let g = shape_gradients(cell_type, at);
        // Metric of the surface: grad N_a . grad N_b = dN_a^T (J^T J)^-1 dN_b.
        let dot = |p: usize, q: usize| j.iter().map(|row| row[p] * row[q]).sum::<f64>();
        let (xx, xy, yy) = (dot(0, 0), dot(0, 1), dot(1, 1));
        let det = xx * yy - xy * xy;
        let weight = subdivision.subcell_area() * det.sqrt();
        area += weight;
        for a in 0..nodes.len() {
            for b in 0..nodes.len() {
                let product =
                    yy * g[a][0] * g[b][0] - xy * (g[a][0] * g[b][1] + g[a][1] * g[b][0]) + xx * g[a][1] * g[b][1];
                for c in 0..D {
                    entries[(a * D + c) * size + b * D + c] += weight * product / det;
                }
            }
        }
    }
    (entries, area)
}

fn pixels_per_unit(camera: &dyn Camera, point: [f64; 3]) -> f64 {
    let (_, [[a, b, _], [c, d, _]]) = camera.project_with_jacobian(point);
    (a * d - b * c).abs().sqrt()
}
