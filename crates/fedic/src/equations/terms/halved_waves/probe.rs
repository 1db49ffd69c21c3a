//! Measurement of the amplitude that a penalty leaves of waves, away from the edges of a mesh.

use fedic_mesh::Mesh;
use fedic_sparse::{Factor, SpdFactor, SymmetricMatrix};

use super::depth::depths;
use super::waves::Waves;
use crate::equations::dofs::Dofs;
use crate::equations::patches::Patch;

/// Distance from the edges of the mesh, in wavelengths, beyond which they do not matter.
const MARGIN: f64 = 0.5;
/// Part of the largest distance from the edges that the margin takes at most.
const SHARE: f64 = 0.75;

/// Nodes on which waves are measured.
#[derive(Debug, Clone)]
pub(super) struct Probe {
    /// Length of the waves in pixels.
    pub(super) length: f64,
    /// Whether each node is far enough from the edges.
    inside: Vec<bool>,
}

impl Probe {
    /// A probe for waves of the length `longest`, or for the longest ones that the mesh has room for. None if these are shorter than
    /// `shortest`.
    pub(super) fn new(mesh: &Mesh, patches: &[Patch], edge: f64, shortest: f64, longest: f64) -> Option<Self> {
        let intervals = mesh.cells().map(|cell| cell.cell_type.edge_intervals()).max().unwrap_or(1);
        let spacing = edge / intervals as f64;
        // A patch spans two intervals.
        let distance = |depth: usize| (2.0 * depth as f64 - 1.0) * spacing;
        let limit = (MARGIN * longest / SHARE / spacing).ceil() as usize;
        let depths = depths(mesh.num_nodes(), patches, limit.max(1));
        let deepest = distance(depths.iter().copied().max().unwrap_or_default());
        let length = longest.min(SHARE * deepest / MARGIN);
        let inside = depths.iter().map(|&depth| distance(depth) >= MARGIN * length).collect();
        (length >= shortest).then_some(Self { length, inside })
    }

    /// Amplitude that a system of Hessian and penalty, of this factor, leaves of waves: the mean over directions and components.
    pub(super) fn amplitude_left<const D: usize>(
        &self,
        dofs: &Dofs<D>,
        hessian: &SymmetricMatrix,
        factor: &Factor,
        waves: &Waves,
    ) -> f64 {
        let (mut found, mut given) = (0.0, 0.0);
        for wave in waves.some_fields::<D>() {
            let mut solution = hessian.multiply(&dofs.pattern, wave.as_flattened());
            let inside = wave.iter().zip(&self.inside).flat_map(|(u, &inside)| if inside { *u } else { [0.0; D] });
            let weights = hessian.multiply(&dofs.pattern, &inside.collect::<Vec<_>>());
            factor.solve(&mut solution);
            let product = |field: &[f64]| weights.iter().zip(field).map(|(w, u)| w * u).sum::<f64>();
            found += product(&solution);
            given += product(wave.as_flattened());
        }
        found / given
    }
}
