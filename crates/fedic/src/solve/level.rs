//! One resolution of the reference image, ready to be solved for: an observation and the factor of its Hessian.

use std::sync::Arc;

use fedic_camera::Camera;
use fedic_image::Interpolator;
use fedic_sparse::{Factor, SymmetricMatrix};

use crate::equations::dofs::Dofs;
use crate::equations::terms::curvature::Curvature;
use crate::equations::terms::image::ImageTerm;
use crate::equations::terms::laplacian::Laplacian;
use crate::equations::terms::penalty::Penalty;
use crate::interpolation::image_sampler::ImageSampler;
use crate::observation::material_filter::MaterialFilter;
use crate::observation::observe::{Observation, ObservationSettings};
use crate::projection::projected_points::project_nodes;
use crate::results::solution::Iteration;
use crate::solve::basis::nodal::NodalBasis;
use crate::solve::gauss_newton::{GaussNewton, Outcome};
use crate::solve::start::cell_subset::stratified_cells;
use crate::{Brightness, Error, Monitor};

/// Gradients below this fraction of those of the best cells count as none.
const FLAT_GRADIENT: f64 = 1e-3;

/// A level of the pyramid; level 0 is the image at full resolution.
pub(crate) struct Level<const D: usize> {
    pub(crate) observation: Observation<D>,
    /// Cells from which global quantities are estimated.
    pub(crate) subset: Vec<usize>,
    /// Factor of the Hessian at the reference position, the penalty included.
    pub(crate) factor: Factor,
    /// Corrects the smoothing of the reference image for the deformation, if the images are smoothed.
    filter: Option<MaterialFilter<D>>,
    /// Penalty and its factor, if the displacement is smoothed.
    penalty: Option<(Smoothing, f64)>,
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
}

impl Smoothing {
    fn matrix(&self) -> &SymmetricMatrix {
        match self {
            Self::Gradient { laplacian, .. } => &laplacian.matrix,
            Self::Curvature(curvature) => &curvature.matrix,
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
        let subset = stratified_cells(mesh, &project_nodes::<D>(mesh, camera, None));
        match &settings.smoothing {
            None => dofs.check_texture(&flat_cells(&energies), &observation.quadrature)?,
            Some(Smoothing::Curvature(_)) => dofs.check_texture_of_parts(&flat_cells(&energies))?,
            Some(Smoothing::Gradient { .. }) => {}
        }
        let mut penalty = None;
        if let Some(smoothing) = settings.smoothing {
            let factor = match &smoothing {
                Smoothing::Gradient { laplacian, wavelength } => {
                    let trace = energies.iter().map(|(trace, _)| trace).sum();
                    laplacian.factor_of_wavelength::<D>(mesh, camera, trace, *wavelength)
                }
                Smoothing::Curvature(curvature) => {
                    curvature.factor(dofs, &hessian, |system| dofs.factorize(system, false, &observation.quadrature))?
                }
            };
            hessian.add_scaled(factor, smoothing.matrix());
            penalty = Some((smoothing, factor));
        }
        let factor = dofs.factorize(&hessian, settings.compact, &observation.quadrature)?;
        Ok(Self { observation, subset, factor, filter: settings.filter, penalty })
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

    /// Minimises the image term of a deformed image, and the penalty if there is one, from `start` on.
    ///
    /// # Errors
    ///
    /// Those of [`GaussNewton::run`].
    pub(crate) fn solve(
        &self,
        dofs: &Dofs<D>,
        (deformed, brightness): (&Interpolator, Brightness),
        iterations: &GaussNewton,
        start: Vec<[f64; D]>,
        history: &mut Vec<Iteration>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome<D>, Error> {
        let mut image = self.image_term(dofs, deformed, brightness).with_filter(self.filter.as_ref());
        image.estimate_gain_offset(&start, &self.subset, monitor)?;
        let mut basis = NodalBasis::new(dofs, &self.factor, &self.observation.quadrature);
        let mut penalty = self.penalty.as_ref().map(|(smoothing, factor)| Penalty {
            dofs,
            matrix: smoothing.matrix(),
            factor: *factor,
        });
        let outcome = match &mut penalty {
            Some(penalty) => iterations.run(&mut [&mut image, penalty], &mut basis, start, history, monitor),
            None => iterations.run(&mut [&mut image], &mut basis, start, history, monitor),
        };
        outcome.map_err(|error| dofs.in_user_nodes(error))
    }
}

/// Cells whose gradient is negligible beside that of the best. Interpolation carries ripples of a texture into the flat part of an
/// image, which determine nothing. `energies` are the trace of the Hessian and the weight of each cell.
fn flat_cells(energies: &[(f64, f64)]) -> Vec<bool> {
    let densities: Vec<f64> = energies.iter().map(|&(trace, weight)| trace / weight).collect();
    let mut sorted: Vec<f64> = densities.iter().copied().filter(|density| !density.is_nan()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    // The upper tenth: much of the mesh may be flat.
    let textured = sorted.get(sorted.len() * 9 / 10).copied().unwrap_or_default();
    densities.into_iter().map(|density| density.is_nan() || density <= FLAT_GRADIENT.powi(2) * textured).collect()
}
