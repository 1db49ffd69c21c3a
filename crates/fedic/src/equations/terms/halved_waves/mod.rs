//! The factor of a penalty on the displacement, from the length of the waves whose amplitude it halves.
//!
//! At the amplitude `a v` of a measured wave `v` the functional is `(1 - a)^2 v^T M v + factor a^2 v^T R v`, with the Hessian `M` of
//! the image and the matrix `R` of the penalty, and least at `a = 1 / 2` if both quadratic forms are the same. The field may lower `R`
//! beside the wave, by up to a tenth on irregular cells: the amplitude left by such a factor is therefore [measured](Probe) on the
//! mesh, and the factor corrected.

mod depth;
mod energies;
mod probe;
mod waves;

use fedic_camera::Camera;
use fedic_mesh::Mesh;
use fedic_sparse::{Factor, SymmetricMatrix};

pub(crate) use self::energies::Energies;
use self::probe::Probe;
pub(crate) use self::waves::{Polarization, Waves};
use crate::equations::dofs::Dofs;
use crate::projection::projected_points::{ProjectedPoint, project_nodes};
use crate::{OptionError, SolveError};

/// Shortest waves, in mean edges, at which a penalty is evaluated: shorter ones are too coarse on the mesh.
const SHORTEST_WAVE: f64 = 5.0;
/// Longest length, in mean edges: with longer ones the Hessian of the image is lost in the rounding errors of the penalty.
const LONGEST_WAVE: f64 = 2000.0;

/// Waves of a stated length, and those on which the amplitude left is measured.
pub(crate) struct HalvedWaves {
    /// Length stated, in pixels.
    length: f64,
    /// Length of the waves in its place, which the mesh resolves.
    resolved: f64,
    stated: Waves,
    /// None on meshes too small for them.
    probe: Option<(Probe, Waves)>,
}

/// Waves, and what a penalty makes of them.
#[derive(Debug, Clone)]
pub(crate) struct PenalisedWaves {
    stated: CostOfWaves,
    probe: Option<(Probe, CostOfWaves)>,
}

/// Waves and their mean cost.
#[derive(Debug, Clone)]
struct CostOfWaves {
    waves: Waves,
    /// Mean of `v^T R v` over the waves `v`, for the area of the mesh.
    energy: f64,
}

impl HalvedWaves {
    /// Waves of `length` pixels as the camera sees them on the mesh of `dofs`, which must have patches.
    ///
    /// # Errors
    ///
    /// [`OptionError::Invalid`] if the length is too long for the mesh.
    pub(crate) fn new<const D: usize>(
        dofs: &Dofs<D>,
        camera: &dyn Camera,
        length: f64,
        polarization: Polarization,
    ) -> Result<Self, OptionError> {
        let nodes = project_nodes::<D>(&dofs.mesh, camera, None);
        let edge = mean_edge(&dofs.mesh, &nodes);
        if length > LONGEST_WAVE * edge {
            let expected = format!(
                "at most {LONGEST_WAVE} times the mean edge of the cells, which is {edge:.4} pixels; longer ones are lost in \
                 rounding errors"
            );
            return Err(OptionError::invalid("regularization_length", expected, &length));
        }
        let resolved = length.max(SHORTEST_WAVE * edge);
        let probe = Probe::new(&dofs.mesh, &dofs.patches, edge, SHORTEST_WAVE * edge, resolved);
        let of_length = |length| Waves::new(&nodes, length, polarization);
        let probe = probe.map(|probe| (probe.length, probe)).map(|(length, probe)| (probe, of_length(length)));
        Ok(Self { length, resolved, stated: of_length(resolved), probe })
    }

    /// A number for the waves of the stated length and one for those that are measured, zero without.
    pub(crate) fn map(&self, number: impl Fn(&Waves) -> f64) -> [f64; 2] {
        [Some(&self.stated), self.probe.as_ref().map(|(_, waves)| waves)].map(|waves| waves.map_or(0.0, &number))
    }

    /// The displacement at the nodes in the waves of the stated length and in those that are measured, none without.
    pub(crate) fn fields<const D: usize>(&self) -> [Vec<Vec<[f64; D]>>; 2] {
        let all = |waves: &Waves| waves.fields::<D>().collect();
        [all(&self.stated), self.probe.as_ref().map_or_else(Vec::new, |(_, waves)| all(waves))]
    }

    /// The waves with the mean of `v^T R v` of each kind, for the area of the mesh.
    pub(crate) fn costing(self, [of_stated, of_probed]: [f64; 2]) -> PenalisedWaves {
        // The square of the second derivatives of a wave falls with the fourth power of its length.
        let energy = of_stated * (self.resolved / self.length).powi(4);
        let probe = self.probe.map(|(probe, waves)| (probe, CostOfWaves { waves, energy: of_probed }));
        PenalisedWaves { stated: CostOfWaves { waves: self.stated, energy }, probe }
    }
}

impl PenalisedWaves {
    /// Factor of the penalty of `matrix` that halves the amplitude of a wave of the stated length, in the mean over directions, phases
    /// and components.
    ///
    /// # Errors
    ///
    /// Those of `factorize`, which factorises a Hessian with a penalty.
    pub(crate) fn factor<const D: usize>(
        &self,
        dofs: &Dofs<D>,
        hessian: &SymmetricMatrix,
        matrix: &SymmetricMatrix,
        factorize: impl FnOnce(&SymmetricMatrix) -> Result<Factor, SolveError>,
    ) -> Result<f64, SolveError> {
        let factor = self.stated.factor(dofs, hessian);
        let Some((probe, cost)) = &self.probe else { return Ok(factor) };
        let mut system = hessian.clone();
        system.add_scaled(cost.factor(dofs, hessian), matrix);
        let left = probe.amplitude_left(dofs, hessian, &factorize(&system)?, &cost.waves);
        // The amplitude left is 1 / (1 + c factor), with the same c for all lengths that the mesh resolves.
        Ok(factor * left / (1.0 - left))
    }
}

impl CostOfWaves {
    /// Factor that makes the penalty of a wave as large as its share of the Hessian.
    fn factor<const D: usize>(&self, dofs: &Dofs<D>, hessian: &SymmetricMatrix) -> f64 {
        let (mut sum, mut count) = (0.0, 0.0);
        for field in self.waves.fields::<D>() {
            sum += hessian.quadratic_form(&dofs.pattern, field.as_flattened());
            count += 1.0;
        }
        sum / count / self.energy
    }
}

/// Mean distance in pixels between the corners at the ends of an edge of a cell.
fn mean_edge(mesh: &Mesh, nodes: &[ProjectedPoint]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for cell in mesh.cells() {
        let corners = &cell.nodes[..cell.cell_type.num_corners()];
        for (k, &a) in corners.iter().enumerate() {
            let [a, b] = [a, corners[(k + 1) % corners.len()]].map(|node| nodes[node as usize].pixel);
            sum += (a[0] - b[0]).hypot(a[1] - b[1]);
            count += 1.0;
        }
    }
    sum / count
}
