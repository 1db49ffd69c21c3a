//! Second-order penalty: the squared second derivatives of the displacement. Affine fields cost nothing, with free edges too.
//!
//! The second derivatives on a [patch](crate::equations::patches) are those of the quadratic polynomial that fits the displacement of
//! its points best ([`patch_matrix`]). A rotation of any size and a uniform strain are affine displacements.
//!
//! The factor of the penalty is that of a wave whose amplitude is halved. At the amplitude `a v` of a measured wave `v` the functional
//! is `(1 - a)^2 v^T M v + factor a^2 v^T R v`, with the Hessian `M` of the image and the matrix `R` of the penalty, and least at
//! `a = 1 / 2` if both quadratic forms are the same. The field may lower `R` beside the wave, by up to a tenth on irregular cells: the
//! amplitude left by such a factor is therefore [measured](Probe) on the mesh, and the factor corrected.

mod depth;
mod frame;
mod patch_matrix;
mod probe;
mod waves;

use fedic_camera::Camera;
use fedic_mesh::Mesh;
use fedic_sparse::{Factor, SymmetricMatrix};
use nalgebra::DMatrix;

use self::frame::in_tangent_plane;
use self::patch_matrix::patch_matrix;
use self::probe::Probe;
use self::waves::{NUM_WAVES, Waves};
use crate::equations::dofs::Dofs;
use crate::equations::patches::{Patch, shares};
use crate::parallel::for_each_in_order;
use crate::projection::projected_points::project_nodes;
use crate::{Error, Monitor, OptionError, SolveError};

/// Shortest waves, in mean edges, at which the penalty is evaluated: shorter ones are too coarse on the mesh.
const SHORTEST_WAVE: f64 = 5.0;
/// Longest length, in mean edges: with longer ones the Hessian of the image is lost in the rounding errors of the penalty.
const LONGEST_WAVE: f64 = 2000.0;

/// Matrix of the squared second derivatives, and what waves cost.
#[derive(Debug, Clone)]
pub(crate) struct Curvature {
    /// `R`, the same for each component.
    pub(crate) matrix: SymmetricMatrix,
    /// Waves of the stated length.
    stated: CostOfWaves,
    /// Waves on which the amplitude left is measured. None on meshes too small for them.
    probe: Option<(Probe, CostOfWaves)>,
}

/// Waves and their mean cost.
#[derive(Debug, Clone)]
struct CostOfWaves {
    waves: Waves,
    /// Mean of `v^T R v` over the waves `v`, for the area of the mesh.
    energy: f64,
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
        let probe = Probe::new(mesh, &dofs.patches, edge, SHORTEST_WAVE * edge, resolved);
        let stated = Waves::new(&pixels, resolved);
        let probed = probe.as_ref().map(|probe| Waves::new(&pixels, probe.length));
        let mut matrix = SymmetricMatrix::zeros(pattern);
        // Incomplete patches at the edges of the mesh do not see all second derivatives.
        let (mut inside, mut all) = (Sums::default(), Sums::default());
        for_each_in_order(
            &dofs.patches,
            monitor,
            |(): &mut (), _, patch| {
                let form = patch_form::<D>(mesh, patch);
                let energies =
                    [Some(&stated), probed.as_ref()].map(|waves| waves.map_or(0.0, |waves| waves.mean(patch, &form)));
                (in_components::<D>(&form), energies)
            },
            |index, (entries, energies)| {
                matrix.add_cell(pattern, mesh.num_cells() + index, &entries);
                let patch = &dofs.patches[index];
                all.add(patch.area, energies);
                if patch.surrounded {
                    inside.add(patch.area, energies);
                }
            },
        )?;
        let sums = if inside.area > 0.0 { &inside } else { &all };
        let [of_stated, of_probed] = sums.energies.map(|energy| energy * all.area / sums.area);
        // The second derivatives of a wave fall with the square of its length.
        let stated = CostOfWaves { waves: stated, energy: of_stated * (resolved / length).powi(4) };
        let probe = probe.zip(probed.map(|waves| CostOfWaves { waves, energy: of_probed }));
        Ok(Self { matrix, stated, probe })
    }

    /// Factor of the penalty that halves the amplitude of a wave of the stated length, in the mean over directions, phases and
    /// components.
    ///
    /// # Errors
    ///
    /// Those of `factorize`, which factorises a Hessian with a penalty.
    pub(crate) fn factor<const D: usize>(
        &self,
        dofs: &Dofs<D>,
        hessian: &SymmetricMatrix,
        factorize: impl FnOnce(&SymmetricMatrix) -> Result<Factor, SolveError>,
    ) -> Result<f64, SolveError> {
        let factor = self.stated.factor(dofs, hessian);
        let Some((probe, cost)) = &self.probe else { return Ok(factor) };
        let trial = cost.factor(dofs, hessian);
        let mut system = hessian.clone();
        system.add_scaled(trial, &self.matrix);
        let left = probe.amplitude_left(dofs, hessian, &factorize(&system)?, &cost.waves);
        // The amplitude left is 1 / (1 + c factor), with the same c for all lengths that the mesh resolves.
        Ok(factor * left / (1.0 - left))
    }
}

impl CostOfWaves {
    /// Factor that makes the penalty of a wave as large as its share of the Hessian.
    fn factor<const D: usize>(&self, dofs: &Dofs<D>, hessian: &SymmetricMatrix) -> f64 {
        let energy = |wave: &Vec<f64>, c: usize| {
            let field = waves::in_component::<D>(wave, c);
            hessian.quadratic_form(&dofs.pattern, field.as_flattened())
        };
        let sum: f64 =
            self.waves.iter().flat_map(|wave| (0..D).map(move |c| (wave, c))).map(|(wave, c)| energy(wave, c)).sum();
        sum / (D * NUM_WAVES) as f64 / self.energy
    }
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

/// Sums over patches.
#[derive(Default)]
struct Sums {
    energies: [f64; 2],
    area: f64,
}

impl Sums {
    fn add(&mut self, area: f64, energies: [f64; 2]) {
        self.area += area;
        self.energies.iter_mut().zip(energies).for_each(|(sum, energy)| *sum += energy);
    }
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
