//! What is unknown, and its values so far.

use fedic_camera::{Parameter, Pinhole};
use fedic_mesh::Mesh;

use crate::self_calibration::motion::Motion;
use crate::self_calibration::sums::Layout;

/// What is estimated.
#[derive(Debug, Clone)]
pub(crate) struct State {
    pub(crate) camera: Pinhole,
    /// Of every image; none for the reference.
    pub(crate) motions: Vec<Motion>,
    /// Gain and offset of every image; 1 and 0 for the reference.
    pub(crate) brightness: Vec<[f64; 2]>,
}

impl State {
    /// The state after a step of all unknowns; `None` where that is no camera.
    pub(crate) fn moved_by(&self, problem: &Problem<'_>, step: &[f64]) -> Option<Self> {
        let layout = problem.layout();
        let camera = self.camera.moved_by(problem.parameters, &step[..layout.parameters]).ok()?;
        let mut moved = Self { camera, ..self.clone() };
        for image in 1..layout.images {
            let (motion, brightness) = step[layout.block(image)].split_at(layout.motion);
            moved.motions[image] = self.motions[image].moved_by(problem.components, motion);
            moved.brightness[image].iter_mut().zip(brightness).for_each(|(b, step)| *b += step);
        }
        Some(moved)
    }
}

/// What is unknown, and over which surface.
pub(crate) struct Problem<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) parameters: &'a [Parameter],
    /// Unknown numbers of each motion.
    pub(crate) components: &'static [usize],
    /// Whether gain and offset of each image are unknown.
    pub(crate) brightness: bool,
    pub(crate) images: usize,
    /// Grey level from which the others are counted.
    pub(crate) pivot: f64,
    /// By how many pixels the camera may be wrong: keeps a parameter that hardly shows from running away.
    pub(crate) reach: f64,
}

impl Problem<'_> {
    pub(crate) fn layout(&self) -> Layout {
        Layout {
            parameters: self.parameters.len(),
            motion: self.components.len(),
            brightness: if self.brightness { 2 } else { 0 },
            images: self.images,
        }
    }
}
