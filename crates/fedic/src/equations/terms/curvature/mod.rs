//! Second-order penalty: the squared second derivatives of the displacement. Affine fields cost nothing, with free edges too.
//!
//! The second derivatives on a [patch](crate::equations::patches) are those of the quadratic polynomial that fits the displacement of
//! its points best ([`patch_matrix`]). A rotation of any size and a uniform strain are affine displacements.

mod frame;
mod patch_matrix;

use fedic_camera::Camera;
use fedic_mesh::Mesh;
use fedic_sparse::SymmetricMatrix;
use nalgebra::{DMatrix, DVector};

use self::frame::in_tangent_plane;
use self::patch_matrix::patch_matrix;
use super::halved_waves::{Energies, HalvedWaves, PenalisedWaves, Polarization, Waves};
use crate::equations::dofs::Dofs;
use crate::equations::patches::{Patch, shares};
use crate::parallel::for_each_in_order;
use crate::{Error, Monitor};

/// Matrix of the squared second derivatives, and what waves cost.
#[derive(Debug, Clone)]
pub(crate) struct Curvature {
    /// `R`, the same for each component.
    pub(crate) matrix: SymmetricMatrix,
    pub(crate) waves: PenalisedWaves,
}

impl Curvature {
    /// Assembles the matrix on the pattern of `dofs`, whose patches must be coupled, for waves of `length` pixels as the camera sees
    /// them.
    ///
    /// # Errors
    ///
    /// [`OptionError::Invalid`](crate::OptionError::Invalid) if the length is too long for the mesh; [`Error::Cancelled`] if `monitor`
    /// asks to stop.
    pub(crate) fn new<const D: usize>(
        dofs: &Dofs<D>,
        camera: &dyn Camera,
        length: f64,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let (mesh, pattern) = (&dofs.mesh, &dofs.pattern);
        let waves = HalvedWaves::new(dofs, camera, length, Polarization::Components)?;
        let mut matrix = SymmetricMatrix::zeros(pattern);
        // Incomplete patches at the edges of the mesh do not see all second derivatives.
        let mut energies = Energies::default();
        for_each_in_order(
            &dofs.patches,
            monitor,
            |(): &mut (), _, patch| {
                let form = patch_form::<D>(mesh, patch);
                (in_components::<D>(&form), waves.map(|waves| mean_energy(waves, patch, &form)))
            },
            |index, (entries, of_patch)| {
                matrix.add_cell(pattern, mesh.num_cells() + index, &entries);
                let patch = &dofs.patches[index];
                energies.add(patch.area, of_patch, patch.surrounded);
            },
        )?;
        let energies = energies.over(energies.area());
        Ok(Self { matrix, waves: waves.costing(energies) })
    }
}

/// Mean over waves of a quadratic form of the values at the nodes of a patch.
fn mean_energy(waves: &Waves, patch: &Patch, form: &DMatrix<f64>) -> f64 {
    let energy = |wave: &Vec<f64>| {
        let v = DVector::from_iterator(patch.nodes.len(), patch.nodes.iter().map(|&node| wave[node as usize]));
        v.dot(&(form * &v))
    };
    waves.values().iter().map(energy).sum::<f64>() / waves.values().len() as f64
}

/// Quadratic form of the squared second derivatives on a patch, of the values at its nodes.
fn patch_form<const D: usize>(mesh: &Mesh, patch: &Patch) -> DMatrix<f64> {
    let of_points = patch_matrix(&in_tangent_plane::<D>(mesh, patch), patch.area);
    let mut values = DMatrix::zeros(patch.points.len(), patch.nodes.len());
    for (row, &point) in patch.points.iter().enumerate() {
        for (node, share) in shares(mesh, point) {
            if let Ok(column) = patch.nodes.binary_search(&node) {
                values[(row, column)] += share;
            }
        }
    }
    values.tr_mul(&(of_points * &values))
}

/// The matrix of one component, repeated for `D`.
fn in_components<const D: usize>(form: &DMatrix<f64>) -> Vec<f64> {
    let nodes = form.nrows();
    let width = nodes * D;
    let mut dense = vec![0.0; width * width];
    for (k, &entry) in form.iter().enumerate() {
        let (a, b) = (k / nodes, k % nodes);
        (0..D).for_each(|c| dense[(a * D + c) * width + b * D + c] = entry);
    }
    dense
}

#[cfg(test)]
mod tests;
