//! Stiffness of a cell in plane stress.

use fedic_mesh::{Mesh, gauss_quadrature, jacobian, shape_gradients, shape_values};
use nalgebra::{DMatrix, Matrix2, Matrix3, Matrix3xX, Vector2};

use crate::PLANE;

/// Stiffness matrix of a cell, and the part of its area that each of its nodes stands for.
#[derive(Debug, Clone)]
pub(super) struct CellStiffness {
    /// Rows and columns `PLANE * node + component`.
    pub(super) matrix: DMatrix<f64>,
    pub(super) areas: Vec<f64>,
}

impl CellStiffness {
    /// Integral of `B^T C B` in the plane of `x` and `y`, by Gauss quadrature. `C` is the matrix of the law. None if the cell is parallel
    /// to `z` somewhere.
    ///
    /// The forces of a uniform stress are exact for every shape of the cell, and the matrix is exact for cells whose map is affine. The
    /// area is shared among the nodes in proportion to `integral N_i^2`, as the mass of a cell is lumped by E. Hinton, T. Rock and
    /// O. C. Zienkiewicz, Earthquake Eng. Struct. Dyn. 4 (1976): the parts are positive for all types of cells.
    pub(super) fn new(mesh: &Mesh, cell: usize, law: &Matrix3<f64>) -> Option<Self> {
        let cell_type = mesh.cell(cell).cell_type;
        let nodes: Vec<[f64; 2]> = mesh.cell_points(cell).iter().map(|&[x, y, _]| [x, y]).collect();
        let size = PLANE * nodes.len();
        let mut matrix = DMatrix::zeros(size, size);
        let mut squares = vec![0.0; nodes.len()];
        let (mut area, mut sense) = (0.0, 0.0);
        for (at, weight) in gauss_quadrature(cell_type.data().domain) {
            let [[a, b], [c, d]] = jacobian(cell_type, &nodes, at);
            let jacobian = Matrix2::new(a, b, c, d);
            let determinant = jacobian.determinant();
            let inverse = jacobian.try_inverse().filter(|_| determinant * sense >= 0.0)?;
            sense = determinant;
            let element = weight * determinant.abs();
            let slopes = shape_gradients(cell_type, at);
            let mut strain = Matrix3xX::zeros(size);
            for node in 0..nodes.len() {
                let slope = inverse.transpose() * Vector2::from(slopes[node]);
                let column = PLANE * node;
                (strain[(0, column)], strain[(2, column)]) = (slope.x, slope.y);
                (strain[(1, column + 1)], strain[(2, column + 1)]) = (slope.y, slope.x);
            }
            matrix += strain.tr_mul(&(law * &strain)) * element;
            let shape = shape_values(cell_type, at);
            squares.iter_mut().zip(shape).for_each(|(square, n)| *square += element * n * n);
            area += element;
        }
        let total: f64 = squares.iter().sum();
        Some(Self { matrix, areas: squares.into_iter().map(|square| area * square / total).collect() })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use fedic_mesh::{CellType, rectangle_mesh};
    use nalgebra::DVector;

    use super::*;
    use crate::PlaneStress;

    #[test]
    fn the_quadrilateral_of_plane_stress_has_its_known_entries() {
        // A unit square, E = 1, nu = 0.3: k11 = (1 / 2 - nu / 6) / (1 - nu^2), k12 = (1 + nu) / 8 / (1 - nu^2).
        let mesh = rectangle_mesh([0.0, 0.0, 1.0, 1.0], 1.0, CellType::Quad).unwrap();
        let law = PlaneStress::isotropic(0.3).unwrap();
        let found = CellStiffness::new(&mesh, 0, law.stiffness()).unwrap();
        assert!((found.matrix[(0, 0)] - (0.5 - 0.05) / 0.91).abs() < 1e-14);
        assert!((found.matrix[(0, 1)] - 1.3 / 8.0 / 0.91).abs() < 1e-14);
        assert!(found.areas.iter().all(|area| (area - 0.25).abs() < 1e-14));
    }

    #[test]
    fn rigid_motions_alone_have_no_energy() {
        let law = PlaneStress::orthotropic(3.0, 1.0, 0.4, 0.7, 0.5).unwrap();
        for cell_type in CellType::ALL {
            let mesh = rectangle_mesh([0.0, 0.0, 2.0, 1.0], 2.0, cell_type).unwrap();
            let CellStiffness { matrix, areas } = CellStiffness::new(&mesh, 0, law.stiffness()).unwrap();
            let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
            values.sort_by(f64::total_cmp);
            assert!(values[..3].iter().all(|value| value.abs() < 1e-12), "{cell_type:?}: {values:?}");
            assert!(values[3] > 1e-2, "{cell_type:?}: {values:?}");
            let points = mesh.cell_points(0);
            let turn = DVector::from_iterator(2 * points.len(), points.iter().flat_map(|&[x, y, _]| [-y, x]));
            assert!((matrix * turn).amax() < 1e-12);
            let area: f64 = areas.iter().sum();
            assert!(areas.iter().all(|&part| part > 0.0));
            assert!((area - 2.0 / (if mesh.num_cells() == 2 { 2.0 } else { 1.0 })).abs() < 1e-12, "{cell_type:?}");
        }
    }
}
