//! Scaled, translated and rotated meshes.

use super::Mesh;
use crate::MeshError;

/// Largest deviation from orthonormality of a rotation matrix.
const ROTATION_TOLERANCE: f64 = 1e-9;

impl Mesh {
    /// The mesh with all coordinates multiplied by `factor`, as for a change of unit.
    ///
    /// # Errors
    ///
    /// [`MeshError::InvalidScale`] if the factor is not a positive number; [`MeshError::NonFinitePoint`] if a coordinate
    /// overflows.
    pub fn scaled(&self, factor: f64) -> Result<Self, MeshError> {
        if !(factor.is_finite() && factor > 0.0) {
            return Err(MeshError::InvalidScale { factor });
        }
        self.with_points(self.points.iter().map(|p| p.map(|c| c * factor)).collect())
    }

    /// The mesh moved by a vector.
    ///
    /// # Errors
    ///
    /// [`MeshError::NonFinitePoint`] if a coordinate is not finite afterwards.
    pub fn translated(&self, vector: [f64; 3]) -> Result<Self, MeshError> {
        self.with_points(self.points.iter().map(|p| [0, 1, 2].map(|d| p[d] + vector[d])).collect())
    }

    /// The mesh rotated by a matrix about a point: `x' = R (x - centre) + centre`.
    ///
    /// Cells are oriented anew, as by [`Mesh::new`]: those of a plane mesh that is turned over are reversed.
    ///
    /// # Errors
    ///
    /// [`MeshError::InvalidRotation`] if the matrix is not orthonormal with determinant 1; [`MeshError::NonFinitePoint`] if a
    /// coordinate is not finite afterwards.
    pub fn rotated(&self, rotation: [[f64; 3]; 3], centre: [f64; 3]) -> Result<Self, MeshError> {
        if !is_rotation(&rotation) {
            return Err(MeshError::InvalidRotation);
        }
        let rotate = |p: &[f64; 3]| {
            let from_centre = [0, 1, 2].map(|d| p[d] - centre[d]);
            [0, 1, 2].map(|d| (0..3).map(|e| rotation[d][e] * from_centre[e]).sum::<f64>() + centre[d])
        };
        self.with_points(self.points.iter().map(rotate).collect())
    }

    /// The same cells and sets on other points. [`Mesh::flipped`] then holds the cells whose order differs from the one that
    /// was given to [`Mesh::new`].
    fn with_points(&self, points: Vec<[f64; 3]>) -> Result<Self, MeshError> {
        let mut mesh = Self { points, ..self.clone() };
        mesh.check_points()?;
        mesh.orient()?;
        Ok(mesh)
    }
}

fn is_rotation(r: &[[f64; 3]; 3]) -> bool {
    let orthonormal = (0..3).all(|a| {
        (0..3).all(|b| {
            let product: f64 = (0..3).map(|k| r[a][k] * r[b][k]).sum();
            (product - f64::from(u8::from(a == b))).abs() <= ROTATION_TOLERANCE
        })
    });
    let determinant = r[0][0] * (r[1][1] * r[2][2] - r[1][2] * r[2][1])
        - r[0][1] * (r[1][0] * r[2][2] - r[1][2] * r[2][0])
        + r[0][2] * (r[1][0] * r[2][1] - r[1][1] * r[2][0]);
    orthonormal && determinant > 0.0
}
