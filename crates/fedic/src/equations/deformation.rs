//! Deformation gradient of a displacement field at the nodes.
//!
//! The sensitivity of the residual is `J_P(X + U)^T F^-T grad f(P(X))`. Instead of carrying `F^-T` to every quadrature point, the
//! equations are written for an increment `dV` in the reference configuration, with the sensitivity `J_P(X)^T grad f(P(X))`. Their
//! Hessian does not depend on the displacement. The increment of the displacement is `dU = F dV`.

use fedic_mesh::{CellType, MAX_NODES, Mesh, shape_gradients};
use nalgebra::{Matrix2, Matrix3, Vector3};
use rayon::prelude::*;

use crate::components::PLANE;

/// Deformation gradients whose determinant is below this, or above its inverse, are ignored: the field is folded or not yet found.
const MIN_DETERMINANT: f64 = 0.1;

/// A matrix of `D` rows and columns.
pub(crate) type Tensor<const D: usize> = [[f64; D]; D];

/// The mean deformation gradient of the cells of each node, in the components of the displacement.
#[derive(Debug, Clone)]
pub(crate) struct NodalDeformation<const D: usize> {
    gradients: Vec<Tensor<D>>,
    /// Largest relative elongation or shortening of a cell.
    pub(crate) stretch: f64,
}

impl<const D: usize> NodalDeformation<D> {
    /// No deformation.
    pub(crate) fn none(num_nodes: usize) -> Self {
        Self { gradients: vec![identity(); num_nodes], stretch: 0.0 }
    }

    /// Deformation gradients of a displacement field, from the centres of the cells. In three components the normal of the surface
    /// is carried along.
    pub(crate) fn of(mesh: &Mesh, displacement: &[[f64; D]]) -> Self {
        let slopes = CellType::ALL.map(|cell| shape_gradients(cell, cell.reference_centre()));
        let of_cell = |cell: usize| {
            let cell = mesh.cell(cell);
            cell_deformation(mesh, cell.nodes, &slopes[cell.cell_type as usize], displacement)
        };
        let cells: Vec<Option<(Tensor<D>, f64)>> = (0..mesh.num_cells()).into_par_iter().map(of_cell).collect();
        let mut gradients = vec![[[0.0; D]; D]; mesh.num_nodes()];
        let mut counts = vec![0.0; mesh.num_nodes()];
        let mut stretch = 0.0_f64;
        for (cell, found) in mesh.cells().zip(&cells) {
            let Some((gradient, of_cell)) = found else { continue };
            stretch = stretch.max(*of_cell);
            for &node in cell.nodes {
                let sums = gradients[node as usize].as_flattened_mut();
                sums.iter_mut().zip(gradient.as_flattened()).for_each(|(sum, entry)| *sum += entry);
                counts[node as usize] += 1.0;
            }
        }
        for (gradient, count) in gradients.iter_mut().zip(counts) {
            if count > 0.0 {
                gradient.as_flattened_mut().iter_mut().for_each(|entry| *entry /= count);
            } else {
                *gradient = identity();
            }
        }
        Self { gradients, stretch }
    }

    /// Replaces the deformation gradient of each node by their mean.
    pub(crate) fn average(&mut self) {
        let count = self.gradients.len().max(1) as f64;
        let mut mean = [[0.0; D]; D];
        for gradient in &self.gradients {
            let sums = mean.as_flattened_mut().iter_mut().zip(gradient.as_flattened());
            sums.for_each(|(sum, entry)| *sum += entry / count);
        }
        self.gradients.fill(mean);
    }

    /// Rotation of the mean deformation gradient, that of its polar decomposition.
    pub(crate) fn mean_rotation(&self) -> Tensor<D> {
        let mut mean = self.clone();
        mean.average();
        let entry = |i: usize, j: usize| match mean.gradients.first() {
            Some(gradient) if i < D && j < D => gradient[i][j],
            _ => f64::from(i == j),
        };
        let rotation = polar_rotation(&Matrix3::from_fn(entry));
        std::array::from_fn(|i| std::array::from_fn(|j| rotation[(i, j)]))
    }

    /// Replaces the deformation gradient of each node by the rotation of their mean.
    pub(crate) fn average_rotation(&mut self) {
        let rotation = self.mean_rotation();
        self.gradients.fill(rotation);
    }

    /// Deformation gradient of each node.
    pub(crate) fn gradients(&self) -> &[Tensor<D>] {
        &self.gradients
    }

    /// Multiplies the vector of each node by its deformation gradient.
    pub(crate) fn push_forward(&self, vectors: &mut [f64]) {
        for (vector, gradient) in vectors.as_chunks_mut::<D>().0.iter_mut().zip(&self.gradients) {
            *vector = std::array::from_fn(|i| (0..D).map(|j| gradient[i][j] * vector[j]).sum());
        }
    }

    /// Vector of each node multiplied by the transpose of its deformation gradient.
    pub(crate) fn pulled_back(&self, vectors: &[f64]) -> Vec<f64> {
        let each = vectors.as_chunks::<D>().0.iter().zip(&self.gradients);
        let pulled: Vec<[f64; D]> = each
            .map(|(vector, gradient)| std::array::from_fn(|j| (0..D).map(|i| gradient[i][j] * vector[i]).sum()))
            .collect();
        pulled.into_flattened()
    }
}

/// Whether a determinant is that of a field that is not folded; false for a NaN.
fn is_usable(determinant: f64) -> bool {
    determinant > MIN_DETERMINANT && determinant < 1.0 / MIN_DETERMINANT
}

/// Whether each cell is folded by a displacement field, or changes its area by more than a factor of ten.
pub(crate) fn folded_cells<const D: usize>(mesh: &Mesh, displacement: &[[f64; D]]) -> Vec<bool> {
    let slopes = CellType::ALL.map(|cell| shape_gradients(cell, cell.reference_centre()));
    let is_folded = |cell: fedic_mesh::Cell<'_>| {
        cell_deformation(mesh, cell.nodes, &slopes[cell.cell_type as usize], displacement).is_none()
    };
    mesh.cells().map(is_folded).collect()
}

/// Change of area of a surface with this deformation gradient, whose normal is carried along without a change of length; one where it
/// is folded, or changes its area by more than a factor of ten.
pub(crate) fn area_ratio<const D: usize>(gradient: &Tensor<D>) -> f64 {
    let entry = |i: usize, j: usize| if i < D && j < D { gradient[i][j] } else { f64::from(i == j) };
    let determinant = Matrix3::from_fn(entry).determinant();
    if is_usable(determinant) { determinant } else { 1.0 }
}

/// The rotation nearest to a matrix.
fn polar_rotation(matrix: &Matrix3<f64>) -> Matrix3<f64> {
    let svd = matrix.svd(true, true);
    let (Some(left), Some(right)) = (svd.u, svd.v_t) else { return Matrix3::identity() };
    // Against a reflection the direction of the least singular value, the last, is turned round.
    let sign = (left * right).determinant().signum();
    left * Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, sign)) * right
}

fn identity<const D: usize>() -> Tensor<D> {
    std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }))
}

/// Deformation gradient at the centre of a cell, and its largest relative change of length; `None` where it is unusable.
fn cell_deformation<const D: usize>(
    mesh: &Mesh,
    nodes: &[u32],
    slopes: &[[f64; 2]; MAX_NODES],
    displacement: &[[f64; D]],
) -> Option<(Tensor<D>, f64)> {
    let [mut from, mut to] = [[[0.0; 3]; 2]; 2];
    for (&node, slopes) in nodes.iter().zip(slopes) {
        let (x, u) = (&mesh.points()[node as usize], &displacement[node as usize]);
        for (direction, slope) in slopes.iter().enumerate() {
            for c in 0..D {
                from[direction][c] += slope * x[c];
                to[direction][c] += slope * (x[c] + u[c]);
            }
        }
    }
    let gradient = if D == PLANE { plane_gradient(from, to)? } else { space_gradient(from, to)? };
    if !is_usable(gradient.determinant()) {
        return None;
    }
    let stretches = (gradient.transpose() * gradient).symmetric_eigenvalues();
    let stretch = stretches.iter().map(|square| (square.max(0.0).sqrt() - 1.0).abs()).fold(0.0, f64::max);
    Some((std::array::from_fn(|i| std::array::from_fn(|j| gradient[(i, j)])), stretch))
}

/// The deformation gradient in the plane, and one normal to it.
fn plane_gradient(from: [[f64; 3]; 2], to: [[f64; 3]; 2]) -> Option<Matrix3<f64>> {
    let [from, to] = [from, to].map(|[a, b]| Matrix2::new(a[0], b[0], a[1], b[1]));
    let gradient = to * from.try_inverse()?;
    Some(gradient.to_homogeneous())
}

/// The deformation gradient of a surface, with unit normals carried to unit normals.
fn space_gradient(from: [[f64; 3]; 2], to: [[f64; 3]; 2]) -> Option<Matrix3<f64>> {
    let frame = |tangents: [[f64; 3]; 2]| {
        let [a, b] = tangents.map(Vector3::from);
        Matrix3::from_columns(&[a, b, a.cross(&b).normalize()])
    };
    Some(frame(to) * frame(from).try_inverse()?)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_mesh::rectangle_mesh;
    use nalgebra::Rotation3;

    use super::*;
    use crate::components::SPACE;

    fn largest_difference<const D: usize>(a: &[Tensor<D>], b: Tensor<D>) -> f64 {
        let each = a.iter().flat_map(|a| a.as_flattened().iter().zip(b.as_flattened()));
        each.map(|(a, b)| (a - b).abs()).fold(0.0, |m, d| if d > m || d.is_nan() { d } else { m })
    }

    #[test]
    fn an_affine_field_has_its_gradient_at_every_node() {
        let expected = [[0.3, -1.1], [0.9, 0.4]];
        for cell in CellType::ALL {
            let mesh = rectangle_mesh([-3.0, 2.0, 5.0, 7.0], 1.5, cell).unwrap();
            let field: Vec<[f64; 2]> = mesh
                .points()
                .iter()
                .map(|x| [0, 1].map(|i| expected[i][0] * x[0] + expected[i][1] * x[1] - x[i] + 4.0))
                .collect();
            let found = NodalDeformation::of(&mesh, &field);
            assert!(largest_difference(found.gradients(), expected) < 1e-12, "{cell}");
        }
    }

    #[test]
    fn a_rotation_in_space_is_found_and_has_no_stretch() {
        let rotation = Rotation3::from_euler_angles(0.7, -1.2, 2.0);
        let mesh = rectangle_mesh([0.0, 0.0, 4.0, 3.0], 1.0, CellType::Quad).unwrap();
        let field: Vec<[f64; SPACE]> = mesh
            .points()
            .iter()
            .map(|&x| {
                let moved = rotation * Vector3::from(x);
                std::array::from_fn(|c| moved[c] - x[c])
            })
            .collect();
        let found = NodalDeformation::of(&mesh, &field);
        let expected = std::array::from_fn(|i| std::array::from_fn(|j| rotation.matrix()[(i, j)]));
        assert!(largest_difference(found.gradients(), expected) < 1e-12);
        assert!(found.stretch < 1e-12);
    }

    #[test]
    fn the_mean_rotation_is_that_of_the_polar_decomposition() {
        let mesh = rectangle_mesh([0.0, 0.0, 4.0, 3.0], 1.0, CellType::Quad).unwrap();
        for degrees in [0.0_f64, 30.0, 90.0, 179.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let stretched = |x: f64, y: f64| [1.1 * x + 0.02 * y, 0.02 * x + 0.95 * y];
            let field: Vec<[f64; 2]> = mesh
                .points()
                .iter()
                .map(|&[x, y, _]| {
                    let [a, b] = stretched(x, y);
                    [cos * a - sin * b - x, sin * a + cos * b - y]
                })
                .collect();
            let found = NodalDeformation::of(&mesh, &field).mean_rotation();
            assert!(largest_difference(&[found], [[cos, -sin], [sin, cos]]) < 1e-14, "{degrees} degrees");
        }
        let reflected = polar_rotation(&Matrix3::from_diagonal(&Vector3::new(1.0, -0.1, 1.0)));
        assert!((reflected - Matrix3::identity()).abs().max() < 1e-14);
    }

    #[test]
    fn a_folded_cell_has_no_deformation() {
        let mesh = rectangle_mesh([0.0, 0.0, 1.0, 1.0], 1.0, CellType::Quad).unwrap();
        let folded: Vec<[f64; 2]> = mesh.points().iter().map(|x| [-2.0 * x[0], 0.0]).collect();
        let found = NodalDeformation::of(&mesh, &folded);
        assert!(largest_difference(found.gradients(), identity()) < 1e-15);
    }

    #[test]
    fn pulling_back_is_the_transpose_of_pushing_forward() {
        let mesh = rectangle_mesh([0.0, 0.0, 3.0, 2.0], 1.0, CellType::Quad).unwrap();
        let field: Vec<[f64; 2]> = mesh.points().iter().map(|x| [0.2 * x[1] * x[0], -0.1 * x[0]]).collect();
        let deformation = NodalDeformation::of(&mesh, &field);
        let vector = |phase: f64| (0..2 * mesh.num_nodes()).map(|k| (phase * k as f64).sin()).collect::<Vec<_>>();
        let (a, mut b) = (vector(1.3), vector(0.7));
        let pulled: f64 = deformation.pulled_back(&a).iter().zip(&b).map(|(a, b)| a * b).sum();
        deformation.push_forward(&mut b);
        let pushed: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
        assert!((pulled - pushed).abs() < 1e-12);
    }
}
