//! Unknowns of a specimen calibration and their current values.

use fedic_camera::{Camera, Parameter, Parametric, Pinhole};
use fedic_mesh::Mesh;

use crate::self_calibration::layout::Layout;
use crate::self_calibration::motion::Motion;

/// Values of the unknowns.
#[derive(Debug, Clone)]
pub(crate) struct State {
    pub(crate) camera: Pinhole,
    /// Motion of each image; the identity for the reference image.
    pub(crate) motions: Vec<Motion>,
    /// Gain and offset of each image; 1 and 0 for the reference image.
    pub(crate) brightness: Vec<[f64; 2]>,
}

impl State {
    /// The state after a step of all unknowns; `None` if the step does not lead to a valid camera.
    pub(crate) fn perturbed(&self, problem: &Problem<'_>, step: &[f64]) -> Option<Self> {
        let layout = problem.layout();
        let steps = problem.parameters.iter().copied().zip(step.iter().copied());
        let camera = self.camera.perturbed(steps).ok()?;
        let mut perturbed = Self { camera, ..self.clone() };
        for image in 1..layout.images {
            let (motion, brightness) = step[layout.block(image)].split_at(layout.motion);
            perturbed.motions[image] = self.motions[image].perturbed(problem.components, motion);
            perturbed.brightness[image].iter_mut().zip(brightness).for_each(|(b, step)| *b += step);
        }
        Some(perturbed)
    }

    /// Largest displacement of a projected node in any image between this state and another, in pixels of the full
    /// resolution; infinite if a node cannot be projected.
    pub(crate) fn largest_displacement(&self, other: &Self, mesh: &Mesh) -> f64 {
        let displacements = self.motions.iter().zip(&other.motions).flat_map(|(from, to)| {
            mesh.points().iter().map(move |&node| {
                let [u, v] = self.camera.project(from.apply(node));
                let [x, y] = other.camera.project(to.apply(node));
                (x - u).hypot(y - v)
            })
        });
        displacements.fold(0.0, |largest, d| if d.is_nan() { f64::INFINITY } else { f64::max(largest, d) })
    }
}

/// Constants of a specimen calibration.
pub(crate) struct Problem<'a> {
    pub(crate) mesh: &'a Mesh,
    /// Unknown parameters of the camera.
    pub(crate) parameters: &'a [Parameter],
    /// Unknown components of each motion.
    pub(crate) components: &'static [usize],
    /// Whether a gain and an offset of each moved image are unknown.
    pub(crate) gain_and_offset: bool,
    /// Number of images, including the reference image.
    pub(crate) num_images: usize,
    /// Grey level from which gains are counted.
    pub(crate) grey_origin: f64,
    /// Prior standard deviation of the projection error, in pixels; regularises weakly observable parameters.
    pub(crate) prior_deviation: f64,
}

impl Problem<'_> {
    pub(crate) fn layout(&self) -> Layout {
        Layout {
            parameters: self.parameters.len(),
            motion: self.components.len(),
            brightness: if self.gain_and_offset { 2 } else { 0 },
            images: self.num_images,
        }
    }
}
