//! Second-order penalty: the squared second derivatives of the displacement. Affine fields cost nothing, with free edges too.
//!
//! The second derivatives on a [patch](crate::equations::patches) are those of the quadratic polynomial that fits the displacement of
//! its nodes best ([`patch_matrix`]). A rotation of any size and a uniform strain are affine displacements.
//!
//! The factor of the penalty is that of a [`wave`](waves) whose amplitude is halved. At the amplitude `a v` of a measured wave `v` the
//! functional is `(1 - a)^2 v^T M v + factor a^2 v^T R v`, with the Hessian `M` of the image and the matrix `R` of the penalty, and
//! least at `a = 1 / 2` if both quadratic forms are the same.

mod frame;
mod patch_matrix;
mod waves;

use fedic_camera::Camera;
use fedic_mesh::Mesh;
use fedic_sparse::SymmetricMatrix;

use self::frame::in_tangent_plane;
use self::patch_matrix::patch_matrix;
use self::waves::{NUM_WAVES, waves};
use crate::equations::dofs::Dofs;
use crate::equations::patches::Patch;
use crate::parallel::for_each_in_order;
use crate::projection::projected_points::project_nodes;
use crate::{Error, Monitor, OptionError};

/// Shortest waves, in mean edges, at which the penalty is evaluated: shorter ones are too coarse on the mesh.
const SHORTEST_WAVE: f64 = 5.0;
/// Longest length, in mean edges: with longer ones the Hessian of the image is lost in the rounding errors of the penalty.
const LONGEST_WAVE: f64 = 2000.0;

/// Matrix of the squared second derivatives, and what a wave of the stated length costs.
#[derive(Debug, Clone)]
pub(crate) struct Curvature {
    /// `R`, the same for each component.
    pub(crate) matrix: SymmetricMatrix,
    /// Waves in one component, a value per node.
    waves: [Vec<f64>; NUM_WAVES],
    /// Mean of `v^T R v` over the waves `v`, per area of the mesh.
    wave_energy: f64,
    area: f64,
}

impl Curvature {
    /// Assembles the matrix on the pattern of `dofs`, which must have patches, for waves of `length` pixels as the camera sees them.
    ///
    /// # Errors
    ///
    /// [`OptionError::Invalid`] if the length is too long for the mesh; [`Error::Cancelled`] if `monitor` asks to stop.
    pub(crate) fn new<const D: usize>(
        dofs: &Dofs<D>,
        camera: &dyn Camera,
        length: f64,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let (mesh, pattern) = (&dofs.mesh, &dofs.pattern);
        let pixels: Vec<[f64; 2]> = project_nodes::<D>(mesh, camera, None).iter().map(|node| node.pixel).collect();
        let edge = mean_edge(mesh, &pixels);
        if length > LONGEST_WAVE * edge {
            let expected = format!(
                "at most {LONGEST_WAVE} times the mean edge of the cells, which is {edge:.4} pixels; longer ones are lost in \
                 rounding errors"
            );
            return Err(OptionError::invalid("regularization_length", expected, &length).into());
        }
        let resolved = length.max(SHORTEST_WAVE * edge);
        let waves = waves(&pixels, resolved);
        let mut matrix = SymmetricMatrix::zeros(pattern);
        // Incomplete patches at the edges of the mesh do not see all second derivatives.
        let mut inside = Sums::default();
        let mut all = Sums::default();
        for_each_in_order(
            &dofs.patches,
            monitor,
            |(): &mut (), _, patch| patch_share::<D>(mesh, patch, &waves),
            |index, share| {
                matrix.add_cell(pattern, mesh.num_cells() + index, &in_components::<D>(&share.entries));
                all.add(&share);
                if dofs.patches[index].surrounded {
                    inside.add(&share);
                }
            },
        )?;
        let sums = if inside.area > 0.0 { &inside } else { &all };
        // The second derivatives of a wave fall with the square of its length.
        let wave_energy = sums.wave_energy / sums.area * (resolved / length).powi(4);
        Ok(Self { matrix, waves, wave_energy, area: all.area })
    }

    /// Factor of the penalty that halves the amplitude of a wave of the stated length: the mean over directions, phases and components.
    pub(crate) fn factor<const D: usize>(&self, dofs: &Dofs<D>, hessian: &SymmetricMatrix) -> f64 {
        let mut components = vec![[0.0; D]; dofs.mesh.num_nodes()];
        let mut energy = 0.0;
        for wave in &self.waves {
            for c in 0..D {
                components.iter_mut().zip(wave).for_each(|(u, &value)| {
                    *u = [0.0; D];
                    u[c] = value;
                });
                energy += hessian.quadratic_form(&dofs.pattern, components.as_flattened());
            }
        }
        energy / (D * NUM_WAVES) as f64 / self.area / self.wave_energy
    }
}

/// Share of a patch.
struct PatchShare {
    /// Matrix of one component, row after row.
    entries: Vec<f64>,
    /// Mean of its quadratic form over the waves.
    wave_energy: f64,
    area: f64,
}

/// Sums over patches.
#[derive(Default)]
struct Sums {
    wave_energy: f64,
    area: f64,
}

impl Sums {
    fn add(&mut self, share: &PatchShare) {
        self.wave_energy += share.wave_energy;
        self.area += share.area;
    }
}

fn patch_share<const D: usize>(mesh: &Mesh, patch: &Patch, waves: &[Vec<f64>; NUM_WAVES]) -> PatchShare {
    let matrix = patch_matrix(&in_tangent_plane::<D>(mesh, patch), patch.area);
    let energy = |wave: &Vec<f64>| {
        let v =
            nalgebra::DVector::from_iterator(patch.nodes.len(), patch.nodes.iter().map(|&node| wave[node as usize]));
        v.dot(&(&matrix * &v))
    };
    let wave_energy = waves.iter().map(energy).sum::<f64>() / NUM_WAVES as f64;
    PatchShare { entries: matrix.as_slice().to_vec(), wave_energy, area: patch.area }
}

/// The matrix of one component, repeated for `D`.
fn in_components<const D: usize>(entries: &[f64]) -> Vec<f64> {
    let nodes = entries.len().isqrt();
    let width = nodes * D;
    let mut dense = vec![0.0; width * width];
    for (k, &entry) in entries.iter().enumerate() {
        let (a, b) = (k / nodes, k % nodes);
        (0..D).for_each(|c| dense[(a * D + c) * width + b * D + c] = entry);
    }
    dense
}

/// Mean distance in pixels between the corners at the ends of an edge of a cell.
fn mean_edge(mesh: &Mesh, pixels: &[[f64; 2]]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for cell in mesh.cells() {
        let corners = &cell.nodes[..cell.cell_type.num_corners()];
        for (k, &a) in corners.iter().enumerate() {
            let [a, b] = [a, corners[(k + 1) % corners.len()]].map(|node| pixels[node as usize]);
            sum += (a[0] - b[0]).hypot(a[1] - b[1]);
            count += 1.0;
        }
    }
    sum / count
}

#[cfg(test)]
mod tests;
