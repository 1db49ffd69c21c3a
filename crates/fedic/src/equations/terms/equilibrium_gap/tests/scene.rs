//! Meshes, and the mean Hessian of an image on them.

use fedic_camera::{Camera, ImageFrame};
use fedic_mesh::{CellType, Mesh, gauss_quadrature, jacobian, map, rectangle_mesh, shape_values};
use fedic_sparse::{Cholesky, Factor, SpdFactor, SpdSolver, SymmetricMatrix};

use super::super::Gap;
use crate::equations::dofs::Dofs;
use crate::equations::terms::curvature::Curvature;
use crate::{EquilibriumGap, PLANE, PlaneStress};

pub(super) type Field = Vec<[f64; PLANE]>;

/// A mesh of square cells of length one, with random moves of the nodes by at most `shake` times their distance.
pub(super) fn rectangle([width, height]: [f64; 2], cell_type: CellType, shake: f64) -> Mesh {
    let mesh = rectangle_mesh([0.0, 0.0, width, height], 1.0, cell_type).unwrap();
    let shake = shake / cell_type.data().grid_intervals as f64;
    let boundary = mesh.boundary_nodes();
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        shake * ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    };
    let points = mesh.points().iter().zip(boundary);
    with_points(
        &mesh,
        points.map(|(&[x, y, z], edge)| if edge { [x, y, z] } else { [x + random(), y + random(), z] }).collect(),
    )
}

pub(super) fn with_points(mesh: &Mesh, points: Vec<[f64; 3]>) -> Mesh {
    let cells = mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node))).collect();
    Mesh::new(points, &[(mesh.cell(0).cell_type, cells)]).unwrap()
}

pub(super) fn isotropic() -> PlaneStress {
    PlaneStress::isotropic(0.3).unwrap()
}

/// Nodes of the boundary for which `is_free`.
pub(super) fn free_nodes(mesh: &Mesh, is_free: impl Fn([f64; 3]) -> bool) -> Vec<usize> {
    let boundary = mesh.boundary_nodes();
    (0..mesh.num_nodes()).filter(|&node| boundary[node] && is_free(mesh.points()[node])).collect()
}

/// Nodes of the boundary that are not on the first or last row of nodes.
pub(super) fn sides(mesh: &Mesh, height: f64) -> Vec<usize> {
    free_nodes(mesh, |[_, y, _]| y > 1e-9 && y < height - 1e-9)
}

pub(super) fn field_of(mesh: &Mesh, displacement: impl Fn([f64; 3]) -> [f64; PLANE]) -> Field {
    mesh.points().iter().map(|&point| displacement(point)).collect()
}

/// A mesh, the mean Hessian `M` of an image on it, and the matrix of a penalty times its factor.
pub(super) struct System {
    pub(super) dofs: Dofs<PLANE>,
    pub(super) hessian: SymmetricMatrix,
    pub(super) penalty: SymmetricMatrix,
    plain: Factor,
    regularized: Factor,
}

impl System {
    pub(super) fn gap(mesh: &Mesh, law: PlaneStress, free_nodes: Vec<usize>, length: f64) -> Self {
        Self::gap_seen_by(&ImageFrame, mesh, law, free_nodes, length)
    }

    pub(super) fn gap_seen_by(
        camera: &dyn Camera,
        mesh: &Mesh,
        law: PlaneStress,
        free_nodes: Vec<usize>,
        length: f64,
    ) -> Self {
        let dofs = Dofs::with_stars(mesh).unwrap();
        let gap = Gap::new(&dofs, camera, &EquilibriumGap { law, free_nodes }, length, &()).unwrap();
        Self::new(dofs, gap.matrix.clone(), |dofs, hessian, cholesky| {
            gap.waves.factor(dofs, hessian, &gap.matrix, |system| Ok(cholesky.factorize(system).unwrap())).unwrap()
        })
    }

    pub(super) fn curvature(mesh: &Mesh, length: f64) -> Self {
        let dofs = Dofs::with_patches(mesh).unwrap();
        let curvature = Curvature::new(&dofs, &ImageFrame, length, &()).unwrap();
        Self::new(dofs, curvature.matrix.clone(), |dofs, hessian, cholesky| {
            curvature
                .waves
                .factor(dofs, hessian, &curvature.matrix, |system| Ok(cholesky.factorize(system).unwrap()))
                .unwrap()
        })
    }

    fn new(
        dofs: Dofs<PLANE>,
        matrix: SymmetricMatrix,
        factor: impl FnOnce(&Dofs<PLANE>, &SymmetricMatrix, &Cholesky) -> f64,
    ) -> Self {
        let hessian = mass(&dofs);
        let cholesky = Cholesky::new(&dofs.pattern, dofs.mesh.points()).unwrap();
        let factor = factor(&dofs, &hessian, &cholesky);
        let mut penalty = SymmetricMatrix::zeros(&dofs.pattern);
        penalty.add_scaled(factor, &matrix);
        let mut system = hessian.clone();
        system.add_scaled(1.0, &penalty);
        let (plain, regularized) = (cholesky.factorize(&hessian).unwrap(), cholesky.factorize(&system).unwrap());
        Self { dofs, hessian, penalty, plain, regularized }
    }

    /// Solution of `(M + R) u = b`.
    pub(super) fn solve(&self, right_hand_side: &[f64]) -> Field {
        Self::solved(&self.regularized, right_hand_side)
    }

    /// Solution of `M u = b`.
    pub(super) fn solve_plain(&self, right_hand_side: &[f64]) -> Field {
        Self::solved(&self.plain, right_hand_side)
    }

    fn solved(factor: &Factor, right_hand_side: &[f64]) -> Field {
        let mut solution = right_hand_side.to_vec();
        factor.solve(&mut solution);
        solution.as_chunks::<PLANE>().0.to_vec()
    }

    /// Largest error of the solution of `(M + R) u = M v` beside the largest displacement.
    pub(super) fn relative_error(&self, v: &Field) -> f64 {
        let found = self.solve(&self.hessian.multiply(&self.dofs.pattern, v.as_flattened()));
        let largest = |values: &[f64]| values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
        let errors: Vec<f64> = found.as_flattened().iter().zip(v.as_flattened()).map(|(a, b)| a - b).collect();
        largest(&errors) / largest(v.as_flattened())
    }
}

/// Integral of `N_i N_j` for each component: the mean Hessian of an image, up to a factor.
fn mass(dofs: &Dofs<PLANE>) -> SymmetricMatrix {
    let mut matrix = SymmetricMatrix::zeros(&dofs.pattern);
    for (index, cell) in dofs.mesh.cells().enumerate() {
        let nodes: Vec<[f64; 2]> = dofs.mesh.cell_points(index).iter().map(|&[x, y, _]| [x, y]).collect();
        let width = PLANE * nodes.len();
        let mut entries = vec![0.0; width * width];
        for (at, weight) in gauss_quadrature(cell.cell_type.data().domain) {
            let [[a, b], [c, d]] = jacobian(cell.cell_type, &nodes, at);
            let shape = shape_values(cell.cell_type, at);
            for i in 0..nodes.len() {
                for j in 0..nodes.len() {
                    let product = weight * (a * d - b * c).abs() * shape[i] * shape[j];
                    (0..PLANE).for_each(|c| entries[(PLANE * i + c) * width + PLANE * j + c] += product);
                }
            }
        }
        matrix.add_cell(&dofs.pattern, index, &entries);
    }
    matrix
}

/// Integral of `N_i` times a field, and of its square over the points where `is_near`: what an image measures of the field.
pub(super) fn loads(dofs: &Dofs<PLANE>, field: impl Fn([f64; 2]) -> [f64; PLANE]) -> Vec<f64> {
    let mut loads = vec![0.0; dofs.pattern.num_dofs()];
    at_points(dofs, |nodes, shape, x, weight| {
        let value = field(x);
        for (&node, n) in nodes.iter().zip(shape) {
            (0..PLANE).for_each(|c| loads[PLANE * node as usize + c] += weight * n * value[c]);
        }
    });
    loads
}

/// Calls a function with the nodes of the cell, the shape functions, the place and the weight of each quadrature point.
pub(super) fn at_points(dofs: &Dofs<PLANE>, mut call: impl FnMut(&[u32], &[f64], [f64; 2], f64)) {
    for (index, cell) in dofs.mesh.cells().enumerate() {
        let nodes: Vec<[f64; 2]> = dofs.mesh.cell_points(index).iter().map(|&[x, y, _]| [x, y]).collect();
        for (at, weight) in gauss_quadrature(cell.cell_type.data().domain) {
            let [[a, b], [c, d]] = jacobian(cell.cell_type, &nodes, at);
            let shape = shape_values(cell.cell_type, at);
            call(cell.nodes, &shape, map(cell.cell_type, &nodes, at), weight * (a * d - b * c).abs());
        }
    }
}
