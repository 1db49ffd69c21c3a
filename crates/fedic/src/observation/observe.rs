//! An observation: one camera and the samples of its reference image.

use std::sync::Arc;

use fedic_camera::Camera;
use fedic_mesh::Mesh;

use crate::interpolation::image_sampler::ImageSampler;
use crate::kernels::gradient::LinearJacobian;
use crate::observation::cell_context::exact_sensitivity;
use crate::observation::photometry::Moments;
use crate::observation::pixel_mask::PixelMask;
use crate::observation::reference_pass::{ReferencePass, ReferenceSums, touches_cell, typical_grey_level};
use crate::observation::reference_samples::ReferenceSamples;
use crate::observation::weights::cell_weights;
use crate::observation::workspace::Workspace;
use crate::parallel::for_each_in_order;
use crate::projection::cell_edges::CellEdges;
use crate::projection::projected_points::project_nodes;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::{Error, Monitor, Quadrature, SolveError};

/// One camera and its reference image, sampled at the quadrature points of a mesh. The displacement has `D` components.
pub(crate) struct Observation<const D: usize> {
    pub(crate) camera: Arc<dyn Camera>,
    /// Columns and rows of the image.
    pub(crate) size: [usize; 2],
    pub(crate) quadrature: CellQuadrature,
    pub(crate) samples: ReferenceSamples,
    /// Jacobian of the camera over each cell at the reference position; `None` where it is not nearly linear.
    pub(crate) jacobians: Vec<Option<LinearJacobian<D>>>,
    /// Origin of the grey levels in moments.
    pub(crate) grey_origin: f32,
    /// Moments of the reference image over each cell.
    pub(crate) moments: Vec<Moments>,
    /// Sum of the weights of all points of each cell, masked and saturated ones as well.
    pub(crate) full_weights: Vec<f64>,
    /// Block of each node on the diagonal of the Hessian.
    pub(crate) node_blocks: Vec<[[f64; D]; D]>,
    /// Derivatives of the right-hand side, but for the sign, with respect to a gain and an offset of the reference image, its grey
    /// levels counted from the origin: `sum w N^T q f` and `sum w N^T q`, by unknown.
    pub(crate) photometric: [Vec<f64>; 2],
}

/// How an observation is made.
pub(crate) struct ObservationSettings {
    pub(crate) quadrature: Quadrature,
    /// Columns and rows of the image.
    pub(crate) size: [usize; 2],
    /// Whether a mesh that leaves the image is an error; otherwise its points outside are dropped.
    pub(crate) require_full_coverage: bool,
    /// Pixels whose points get no weight.
    pub(crate) mask: Option<Arc<PixelMask>>,
    /// Distance in pixels from a cut of the mesh up to which points get no weight; `None` for no distance. What opens there is seen by
    /// the smoothing and the interpolation of the deformed image.
    pub(crate) cut_margin: Option<f64>,
    /// Full scale of the grey levels and saturated pixels, if there are any: points among them get no weight.
    pub(crate) saturation: Option<(f32, PixelMask)>,
}

impl<const D: usize> Observation<D> {
    /// Samples `reference` at the quadrature points of `mesh` seen by `camera`. `collect` gets the sums over each cell, in the
    /// order of the cells.
    ///
    /// # Errors
    ///
    /// [`Error::MeshOutsideImage`], [`Error::Flat`], [`SolveError::TooManyPoints`] or [`Error::Cancelled`].
    pub(crate) fn new(
        mesh: &Mesh,
        camera: Arc<dyn Camera>,
        reference: ImageSampler,
        settings: &ObservationSettings,
        monitor: &dyn Monitor,
        mut collect: impl FnMut(usize, &ReferenceSums<D>) + Send,
    ) -> Result<Self, Error> {
        let size = settings.size;
        let [width, height] = size;
        let refuse = |cells| Error::MeshOutsideImage { cells, num_cells: mesh.num_cells(), width, height };
        if settings.require_full_coverage {
            let cells = cells_outside(mesh, camera.as_ref(), size);
            if !cells.is_empty() {
                return Err(refuse(cells));
            }
        }
        let quadrature = CellQuadrature::new(mesh, camera.as_ref(), settings.quadrature)?;
        let num_points = quadrature.num_points();
        let nodes = project_nodes::<D>(mesh, camera.as_ref(), None);
        let mask = settings.mask.as_deref();
        let saturation = settings.saturation.as_ref();
        let masks = || mask.into_iter().chain(saturation.map(|(_, pixels)| pixels));
        let cuts = settings.cut_margin.map(|margin| (CellEdges::cuts(mesh, &nodes), margin));
        let is_cut = |cell| cuts.as_ref().is_some_and(|(cuts, _)| cuts.has(cell));
        let masked = |cell| is_cut(cell) || masks().any(|mask| touches_cell(mask, mesh.cell(cell).nodes, &nodes));
        let weights = cell_weights(mesh, &quadrature, |cell| !settings.require_full_coverage || masked(cell));
        let mut samples =
            ReferenceSamples::zeros(&quadrature, &weights).ok_or(SolveError::TooManyPoints { points: num_points })?;
        let grey_origin = typical_grey_level(&reference, &nodes);
        let pass = ReferencePass {
            mesh,
            camera: camera.as_ref(),
            quadrature: &quadrature,
            image: &reference,
            nodes: &nodes,
            grey_origin,
            mask,
            saturation,
            cuts: cuts.as_ref(),
        };
        let (mut moments, mut total) = (Vec::with_capacity(mesh.num_cells()), Moments::default());
        let (mut outside, mut jacobians) = (Vec::new(), Vec::with_capacity(mesh.num_cells()));
        let mut photometric = [(); 2].map(|()| vec![0.0; mesh.num_nodes() * D]);
        let mut full_weights = Vec::with_capacity(mesh.num_cells());
        let mut node_blocks = vec![[[0.0; D]; D]; mesh.num_nodes()];
        for_each_in_order(
            samples.cells_mut(),
            monitor,
            |workspace: &mut Workspace<D>, cell, (samples, scale)| pass.sample_cell(workspace, cell, samples, scale),
            |cell, sums| {
                for (vector, sums) in photometric.iter_mut().zip(&sums.photometric) {
                    add_to_nodes(mesh.cell(cell).nodes, sums, vector);
                }
                let of_cell = mesh.cell(cell).nodes;
                add_node_blocks(of_cell, (0..of_cell.len()).map(|a| sums.matrix.node_block(a)), &mut node_blocks);
                full_weights.push(sums.full_weight);
                total.add(&sums.moments);
                moments.push(sums.moments);
                jacobians.push(sums.jacobian);
                if sums.outside {
                    outside.push(cell);
                }
                collect(cell, &sums);
            },
        )?;
        // The prepared image is the largest allocation: freed before the factorisation needs memory.
        drop(reference);
        if settings.require_full_coverage && !outside.is_empty() {
            return Err(refuse(outside));
        }
        if num_points > 0 && total.weight == 0.0 && masks().next().is_some() {
            return Err(Error::NoUsablePoints { masked: mask.is_some() });
        }
        if num_points > 0 && total.is_flat_f(f64::from(grey_origin)) {
            return Err(Error::Flat { which: "reference", std: total.std_f() });
        }
        Ok(Self {
            camera,
            size,
            quadrature,
            samples,
            jacobians,
            grey_origin,
            moments,
            full_weights,
            node_blocks,
            photometric,
        })
    }

    /// Writes the sensitivities of a cell whose Jacobian is not nearly linear, from the exact one at each point.
    pub(crate) fn exact_sensitivities(&self, mesh: &Mesh, workspace: &mut Workspace<D>, cell: usize) {
        let Workspace { projector, points: buffers, .. } = workspace;
        let samples = self.samples.cell(cell);
        let (of_cell, nodes) = ((cell, mesh.cell(cell).cell_type), mesh.cell_points(cell));
        let camera = self.camera.as_ref();
        projector.pointwise.for_each_batch(&self.quadrature, of_cell, &nodes, camera, |batch, points| {
            exact_sensitivity(batch, points, |k| samples.gradient_at(k), &mut buffers.q);
        });
    }

    /// Number of quadrature points.
    pub(crate) fn num_points(&self) -> usize {
        self.quadrature.num_points()
    }
}

/// Adds the sums at the nodes of a cell to a vector of all unknowns.
pub(crate) fn add_to_nodes<const D: usize>(nodes: &[u32], sums: &[[f64; D]], vector: &mut [f64]) {
    let all = vector.as_chunks_mut::<D>().0;
    for (&node, sums) in nodes.iter().zip(sums) {
        all[node as usize].iter_mut().zip(sums).for_each(|(b, sum)| *b += sum);
    }
}

/// Adds the diagonal blocks of the Hessian of a cell to those of its nodes.
pub(crate) fn add_node_blocks<const D: usize>(
    nodes: &[u32],
    blocks: impl IntoIterator<Item = [[f64; D]; D]>,
    sums: &mut [[[f64; D]; D]],
) {
    for (&node, block) in nodes.iter().zip(blocks) {
        let sums = sums[node as usize].as_flattened_mut();
        sums.iter_mut().zip(block.as_flattened()).for_each(|(sum, entry)| *sum += entry);
    }
}

/// Cells with a node outside the image. Checked before anything is allocated: a camera in the wrong unit would ask for more
/// quadrature points than there is memory.
fn cells_outside(mesh: &Mesh, camera: &dyn Camera, size: [usize; 2]) -> Vec<usize> {
    let inside = |&point: &[f64; 3]| {
        camera.project(point).iter().zip(size).all(|(&c, size)| c >= -0.5 && c <= size as f64 - 0.5)
    };
    let inside: Vec<bool> = mesh.points().iter().map(inside).collect();
    (0..mesh.num_cells()).filter(|&cell| mesh.cell(cell).nodes.iter().any(|&node| !inside[node as usize])).collect()
}
