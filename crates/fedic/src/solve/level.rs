//! One resolution of the reference image, ready to be solved for: an observation and the factor of its Hessian.

use std::sync::{Arc, OnceLock};

use fedic_camera::Camera;
use fedic_image::Interpolator;
use fedic_mesh::{CellType, Mesh};
use fedic_sparse::{Factor, SymmetricMatrix};

use crate::equations::deformation::folded_cells;
use crate::equations::dofs::Dofs;
use crate::equations::term::CellAgreement;
use crate::equations::terms::curvature::Curvature;
use crate::equations::terms::equilibrium_gap::Gap;
use crate::equations::terms::image::ImageTerm;
use crate::equations::terms::image::light::LightSystem;
use crate::equations::terms::image::robust::CellNeighbours;
use crate::equations::terms::laplacian::Laplacian;
use crate::equations::terms::penalty::{Penalty, Rest};
use crate::interpolation::image_sampler::ImageSampler;
use crate::observation::material_filter::MaterialFilter;
use crate::observation::observe::{Observation, ObservationSettings};
use crate::projection::projected_points::{ProjectedPoint, project_nodes};
use crate::quadrature::shape_table::mean_squared_shapes;
use crate::results::quality::MIN_CORRELATION;
use crate::results::solution::Iteration;
use crate::solve::basis::nodal::{NodalBasis, hold_weak_nodes};
use crate::solve::gauss_newton::{GaussNewton, Outcome};
use crate::solve::start::cell_subset::stratified_cells;
use crate::{Brightness, Error, Monitor, Robust};

/// Gradients below this fraction of those of the best cells count as none.
const FLAT_GRADIENT: f64 = 1e-3;
/// Largest number of times that a frame is measured, each without the cells found to be damaged before.
const MAX_ROUNDS: usize = 5;
/// Number of rounds at the end before which doubtful cells are left out together with the damaged ones.
const ROUNDS_WITH_DOUBTFUL: usize = 2;
/// Increment in pixels, at the end of iterations that did not converge, of a node that does not come to rest.
const RESTLESS: f64 = 0.02;
/// Largest share of such nodes for which something is damaged.
const RESTLESS_SHARE: f64 = 0.05;
/// Residual of a doubtful cell, without its own gain and offset, relative to the median.
const LARGE_SCATTER: f64 = 2.0;

/// A level of the pyramid; level 0 is the image at full resolution.
pub(crate) struct Level<const D: usize> {
    pub(crate) observation: Observation<D>,
    /// Area and texture of each cell.
    pub(crate) textures: Vec<CellTexture>,
    /// Cells from which global quantities are estimated.
    pub(crate) subset: Vec<usize>,
    /// Factor of the Hessian at the reference position, the penalty included.
    pub(crate) factor: Factor,
    /// Corrects the smoothing of the reference image for the deformation, if the images are smoothed.
    filter: Option<MaterialFilter<D>>,
    /// Penalty and its factor, if the displacement is smoothed.
    penalty: Option<(Smoothing, f64)>,
    light: OnceLock<LightSystem>,
    neighbours: OnceLock<CellNeighbours>,
}

/// A deformed image, and how its grey levels are compared with those of the reference image.
pub(crate) struct Comparison<'a> {
    pub(crate) deformed: &'a Interpolator,
    pub(crate) brightness: Brightness,
    /// Full scale of the deformed image, if some of its pixels are saturated.
    pub(crate) full_scale: Option<f32>,
    pub(crate) robust: Option<Robust>,
}

/// Area and texture of a cell in the reference image.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellTexture {
    /// Area of the cell in pixels.
    pub(crate) pixels: f64,
    /// Root mean square of the gradient along one direction, in grey levels per pixel; NaN without points.
    pub(crate) gradient: f64,
}

/// A solution on one level.
pub(crate) struct LevelSolution<const D: usize> {
    pub(crate) outcome: Outcome<D>,
    /// Block of each node on the diagonal of the Hessian over the points used last.
    pub(crate) node_blocks: Vec<[[f64; D]; D]>,
    /// Robust weights of the points of each cell; absent in cells without outliers, empty without such weights.
    pub(crate) point_weights: Vec<Option<Box<[f32]>>>,
}

/// How a level is made.
pub(crate) struct LevelSettings<const D: usize> {
    pub(crate) observation: ObservationSettings,
    pub(crate) smoothing: Option<Smoothing>,
    /// The reference image and its smoothing, in pixels of this level, to smooth both images by the same filter on the material.
    pub(crate) filter: Option<MaterialFilter<D>>,
    /// Whether the factor may be kept in single precision.
    pub(crate) compact: bool,
}

/// Penalty that smooths the displacement.
pub(crate) enum Smoothing {
    /// On its gradient, below a wavelength in pixels of the level.
    Gradient { laplacian: Arc<Laplacian>, wavelength: f64 },
    /// On its second derivatives.
    Curvature(Curvature),
    /// On the internal forces of linear elasticity.
    Gap(Gap),
}

impl Smoothing {
    fn matrix(&self) -> &SymmetricMatrix {
        match self {
            Self::Gradient { laplacian, .. } => &laplacian.matrix,
            Self::Curvature(curvature) => &curvature.matrix,
            Self::Gap(gap) => &gap.matrix,
        }
    }
}

impl<const D: usize> Level<D> {
    /// Samples the reference image, assembles the Hessian and factorises it.
    ///
    /// # Errors
    ///
    /// Those of [`Observation::new`], and [`SolveError::Singular`](crate::SolveError::Singular) if the image does not determine the
    /// displacement of every node.
    pub(crate) fn new(
        dofs: &Dofs<D>,
        camera: Arc<dyn Camera>,
        reference: ImageSampler,
        settings: LevelSettings<D>,
        monitor: &dyn Monitor,
    ) -> Result<Self, Error> {
        let mesh = &dofs.mesh;
        let mut hessian = SymmetricMatrix::zeros(&dofs.pattern);
        let mut energies = Vec::with_capacity(mesh.num_cells());
        let observation = Observation::new(mesh, camera, reference, &settings.observation, monitor, |cell, sums| {
            hessian.add_cell(&dofs.pattern, cell, &sums.matrix.entries());
            energies.push((sums.matrix.trace(), sums.moments.weight));
        })?;
        let camera = observation.camera.as_ref();
        let nodes = project_nodes::<D>(mesh, camera, None);
        let subset = stratified_cells(mesh, &nodes);
        let textures = cell_textures(mesh, &observation, &energies, &nodes);
        let flat = || flat_cells(&energies, &observation);
        match &settings.smoothing {
            None => dofs.check_texture(&flat(), &observation.quadrature)?,
            Some(Smoothing::Curvature(_)) => dofs.check_texture_of_parts(&flat())?,
            Some(Smoothing::Gap(gap)) => {
                dofs.check_texture_of_parts(&flat())?;
                dofs.check_texture_of_edges(&flat(), &gap.penalised)?;
            }
            Some(Smoothing::Gradient { .. }) => {}
        }
        let mut penalty = None;
        if let Some(smoothing) = settings.smoothing {
            let factorize = |system: &SymmetricMatrix| dofs.factorize(system, false, &observation.quadrature);
            let factor = match &smoothing {
                Smoothing::Gradient { laplacian, wavelength } => {
                    let trace = energies.iter().map(|(trace, _)| trace).sum();
                    laplacian.factor_of_wavelength::<D>(mesh, camera, trace, *wavelength)
                }
                Smoothing::Curvature(Curvature { waves, matrix }) | Smoothing::Gap(Gap { waves, matrix, .. }) => {
                    waves.factor(dofs, &hessian, matrix, factorize)?
                }
            };
            hessian.add_scaled(factor, smoothing.matrix());
            penalty = Some((smoothing, factor));
        }
        if settings.observation.mask.is_some() || settings.observation.saturation.is_some() {
            hold_weak_nodes(dofs, &mut hessian);
        }
        let factor = dofs.factorize(&hessian, settings.compact, &observation.quadrature)?;
        Ok(Self {
            observation,
            textures,
            subset,
            factor,
            filter: settings.filter,
            penalty,
            light: OnceLock::new(),
            neighbours: OnceLock::new(),
        })
    }

    /// Matrix of the penalty and its factor, if the displacement is smoothed.
    pub(crate) fn penalty(&self) -> Option<(&SymmetricMatrix, f64)> {
        self.penalty.as_ref().map(|(smoothing, factor)| (smoothing.matrix(), *factor))
    }

    /// The image term of a deformed image.
    pub(crate) fn image_term<'a>(
        &'a self,
        dofs: &'a Dofs<D>,
        deformed: &'a Interpolator,
        brightness: Brightness,
    ) -> ImageTerm<'a, D> {
        ImageTerm::new(&dofs.mesh, &self.observation, deformed, brightness)
    }

    /// Minimises the image term of a deformed image, and the penalty if there is one, from `start` on. A penalty on the gradient is that
    /// of the difference from `rest`.
    ///
    /// # Errors
    ///
    /// Those of [`GaussNewton::run`].
    pub(crate) fn solve(
        &self,
        dofs: &Dofs<D>,
        images: &Comparison<'_>,
        iterations: &GaussNewton,
        (start, rest): (Vec<[f64; D]>, &[[f64; D]]),
        history: &mut Vec<Iteration>,
        monitor: &dyn Monitor,
    ) -> Result<LevelSolution<D>, Error> {
        let mut image = self.image_term(dofs, images.deformed, images.brightness);
        image = image.with_filter(self.filter.as_ref()).with_full_scale(images.full_scale);
        image.estimate_gain_offset(&start, &self.subset, monitor)?;
        self.adapt(&mut image, dofs, &start, images, monitor)?;
        let mut basis = NodalBasis::new(dofs, &self.factor, &self.observation.quadrature);
        let mut penalty = self.penalty.as_ref().map(|(smoothing, factor)| Penalty {
            dofs,
            matrix: smoothing.matrix(),
            factor: *factor,
            rest: match smoothing {
                // A penalty on the gradient would turn back a rotation that is known already.
                Smoothing::Gradient { .. } => Rest::Field(rest.to_vec()),
                Smoothing::Curvature(_) => Rest::Zero,
                Smoothing::Gap(_) => Rest::MeanRotation,
            },
        });
        let mut displacement = start;
        let mut rounds = MAX_ROUNDS;
        loop {
            rounds -= 1;
            let outcome = match &mut penalty {
                Some(penalty) => iterations.run(&mut [&mut image, penalty], &mut basis, displacement, history, monitor),
                None => iterations.run(&mut [&mut image], &mut basis, displacement, history, monitor),
            };
            let outcome = outcome.map_err(|error| dofs.in_user_nodes(error))?;
            let again = rounds > 0
                && images.robust.is_some_and(|robust| {
                    let damaged = damaged_cells(robust, &dofs.mesh, &outcome);
                    let doubtful = doubtful_cells(&damaged, &dofs.mesh, &outcome);
                    let found = image.drop_cells(indices(&damaged));
                    // Many doubtful cells are good once the damaged ones are left out.
                    if found && rounds > ROUNDS_WITH_DOUBTFUL {
                        found
                    } else {
                        image.drop_cells(indices(&doubtful)) || found
                    }
                });
            if !again {
                let node_blocks = image.node_blocks().to_vec();
                return Ok(LevelSolution { outcome, node_blocks, point_weights: image.into_weights() });
            }
            displacement = outcome.displacement;
        }
    }

    /// Makes the light of an image term a field and weighs its points, if that is asked for.
    ///
    /// # Errors
    ///
    /// Those of [`ImageTerm::adapt`].
    pub(crate) fn adapt<'a>(
        &'a self,
        image: &mut ImageTerm<'a, D>,
        dofs: &Dofs<D>,
        displacement: &[[f64; D]],
        images: &Comparison<'_>,
        monitor: &dyn Monitor,
    ) -> Result<(), Error> {
        let mut light = None;
        if images.brightness == Brightness::Field {
            light = Some(match self.light.get() {
                Some(system) => system,
                None => {
                    let system = LightSystem::new(&dofs.mesh)?;
                    self.light.get_or_init(|| system)
                }
            });
        }
        let neighbours = || self.neighbours.get_or_init(|| CellNeighbours::new(&dofs.mesh));
        let robust = images.robust.map(|function| (function, neighbours()));
        if light.is_some() || robust.is_some() { image.adapt(displacement, light, robust, monitor) } else { Ok(()) }
    }
}

/// Cells that are damaged: most of their points are outliers, they do not correlate, or they are folded.
fn damaged_cells<const D: usize>(robust: Robust, mesh: &Mesh, outcome: &Outcome<D>) -> Vec<bool> {
    let folded = folded_cells(mesh, &outcome.displacement);
    let is_damaged = |(cell, folded): (&CellAgreement, bool)| {
        let of_weights = cell.is_dropped || cell.kept() < robust.min_kept();
        of_weights || cell.correlation < MIN_CORRELATION || folded
    };
    let cells = outcome.reports.iter().flat_map(|report| &report.cells);
    cells.zip(folded).map(is_damaged).collect()
}

/// Cells with a large residual beside damaged ones, or beside nodes that do not come to rest.
fn doubtful_cells<const D: usize>(damaged: &[bool], mesh: &Mesh, outcome: &Outcome<D>) -> Vec<bool> {
    let cells = || outcome.reports.iter().flat_map(|report| &report.cells);
    let mut scatter: Vec<f64> = cells().map(|cell| cell.scatter).filter(|scatter| !scatter.is_nan()).collect();
    scatter.sort_unstable_by(f64::total_cmp);
    let large = LARGE_SCATTER * scatter.get(scatter.len() / 2).copied().unwrap_or(f64::INFINITY);
    let is_restless = |&increment: &f64| !outcome.converged && increment > RESTLESS;
    let mut beside: Vec<bool> = outcome.increments.iter().map(is_restless).collect();
    // Many nodes move where the start was too far off, not where something is damaged.
    if beside.iter().filter(|&&restless| restless).count() as f64 > RESTLESS_SHARE * beside.len() as f64 {
        beside.fill(false);
    }
    for cell in indices(damaged) {
        mesh.cell(cell).nodes.iter().for_each(|&node| beside[node as usize] = true);
    }
    let is_beside = |cell: usize| mesh.cell(cell).nodes.iter().any(|&node| beside[node as usize]);
    cells().enumerate().map(|(index, cell)| cell.scatter > large && is_beside(index)).collect()
}

/// Indices of the true entries.
fn indices(entries: &[bool]) -> impl Iterator<Item = usize> {
    entries.iter().enumerate().filter(|(_, entry)| **entry).map(|(index, _)| index)
}

/// Area and texture of each cell, from the trace of its Hessian and its weight.
fn cell_textures<const D: usize>(
    mesh: &Mesh,
    observation: &Observation<D>,
    energies: &[(f64, f64)],
    nodes: &[ProjectedPoint],
) -> Vec<CellTexture> {
    // Each point adds the sum of its squared shape functions to the trace.
    let squares = CellType::ALL.map(|cell_type| mean_squared_shapes(cell_type).iter().sum::<f64>());
    let texture = |(index, &(trace, weight)): (usize, &(f64, f64))| {
        let cell = mesh.cell(index);
        let at_nodes = cell.nodes.iter().map(|&node| nodes[node as usize].pixels_per_area::<D>());
        let pixels_per_area = at_nodes.sum::<f64>() / cell.nodes.len() as f64;
        let pixels = match observation.quadrature.point_area(index) {
            Some(_) => observation.full_weights[index] * pixels_per_area,
            None => observation.full_weights[index],
        };
        let gradient = trace / (2.0 * squares[cell.cell_type as usize] * weight * pixels_per_area);
        CellTexture { pixels, gradient: gradient.sqrt() }
    };
    energies.iter().enumerate().map(texture).collect()
}

/// Cells whose gradient is negligible beside that of the best. Interpolation carries ripples of a texture into the flat part of an
/// image, which determine nothing. `energies` are the trace of the Hessian and the weight of each cell.
fn flat_cells<const D: usize>(energies: &[(f64, f64)], observation: &Observation<D>) -> Vec<bool> {
    let densities: Vec<f64> = energies.iter().map(|&(trace, weight)| trace / weight).collect();
    let mut sorted: Vec<f64> = densities.iter().copied().filter(|density| !density.is_nan()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    // The upper tenth: much of the mesh may be flat.
    let textured = sorted.get(sorted.len() * 9 / 10).copied().unwrap_or_default();
    let textured = FLAT_GRADIENT.powi(2) * textured;
    // A cell all of whose points are left out is not flat; one without points is.
    let is_flat = |(density, &full): (f64, &f64)| if density.is_nan() { full == 0.0 } else { density <= textured };
    densities.into_iter().zip(&observation.full_weights).map(is_flat).collect()
}
