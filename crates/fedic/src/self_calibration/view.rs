//! The images at one level of a pyramid, and the normal equations that they give.

use std::ops::Range;
use std::sync::Arc;

use fedic_camera::{Camera, Pinhole, Scaled};
use fedic_mesh::{Rule, jacobian, map};

use crate::parallel::for_each_in_order;
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::self_calibration::problem::{Problem, State};
use crate::self_calibration::rows::{BATCH, Rows, Sight, Sights};
use crate::self_calibration::sums::Sums;
use crate::{Error, ImageSampler, Monitor, Quadrature};

/// Points per parallel task.
const TASK: usize = 4096;

/// The images of one level.
pub(crate) struct Frames {
    pub(crate) samplers: Vec<ImageSampler>,
    /// Columns and rows.
    pub(crate) size: [usize; 2],
    /// Pixels of this level per pixel of the images.
    pub(crate) factor: f64,
    /// Pixels along the border in which no point is read.
    pub(crate) margin: f64,
}

/// The images of one level and the points that are read in them.
pub(crate) struct View<'a> {
    problem: &'a Problem<'a>,
    frames: Frames,
    quadrature: CellQuadrature,
    /// The camera that the pixels which a point stands for are counted of.
    counting: Scaled,
}

impl<'a> View<'a> {
    /// The images, with the points of `density` per pixel of `camera`.
    pub(crate) fn new(problem: &'a Problem<'a>, frames: Frames, camera: &Pinhole, density: f64) -> Result<Self, Error> {
        let counting = Scaled::new(Arc::new(camera.clone()), frames.factor);
        let rule = Quadrature::Mesh { rule: Rule::default(), density };
        let quadrature = CellQuadrature::new(problem.mesh, &counting, rule)?;
        Ok(Self { problem, frames, quadrature, counting })
    }

    /// The same points of other images.
    pub(crate) fn with_samplers(mut self, samplers: Vec<ImageSampler>) -> Self {
        self.frames.samplers = samplers;
        self
    }

    pub(crate) fn num_points(&self) -> usize {
        self.quadrature.num_points()
    }

    /// The normal equations at `state`, each point read in the images that show it to `sighting`. `weigh` makes the weight of a point out of the pixels that it stands for.
    pub(crate) fn sums(
        &self,
        state: &State,
        sighting: &State,
        weigh: impl Fn(f64) -> f64 + Sync,
        monitor: &dyn Monitor,
    ) -> Result<Sums, Error> {
        let layout = self.problem.layout();
        let mut total = Sums::zeros(layout);
        let parts = (0..self.problem.mesh.num_cells()).flat_map(|cell| {
            let count = self.quadrature.range(cell).len();
            (0..count).step_by(TASK).map(move |first| (cell, first..count.min(first + TASK)))
        });
        for_each_in_order(
            parts,
            monitor,
            |_: &mut (), _, (cell, points)| self.of_part([state, sighting], cell, points, &weigh),
            |_, sums| total.add_sums(&sums),
        )?;
        Ok(total)
    }

    /// Of some points of a cell.
    fn of_part(
        &self,
        [state, sighting]: [&State; 2],
        cell: usize,
        part: Range<usize>,
        weigh: &impl Fn(f64) -> f64,
    ) -> Sums {
        let mesh = self.problem.mesh;
        let (cell_type, nodes) = (mesh.cell(cell).cell_type, mesh.cell_points(cell));
        let part_area = self.quadrature.point_area(cell);
        let mut sums = Sums::zeros(self.problem.layout());
        let mut rows = Rows::new(self.problem);
        let (mut xi, mut eta) = ([0.0; BATCH], [0.0; BATCH]);
        let (mut points, mut tangents, mut weights) = ([[0.0; 3]; BATCH], [[[0.0; 2]; 3]; BATCH], [0.0; BATCH]);
        let sights = Sights { sight: [Sight::default(); BATCH], grey: [0.0; BATCH], slope: [[0.0; BATCH]; 2] };
        let mut sights = vec![sights; self.problem.images];
        for first in part.clone().step_by(BATCH) {
            let n = BATCH.min(part.end - first);
            self.quadrature.coordinates(cell, first, &mut xi[..n], &mut eta[..n]);
            for k in 0..n {
                let at = [xi[k], eta[k]];
                (points[k], tangents[k]) = (map(cell_type, &nodes, at), jacobian(cell_type, &nodes, at));
                let (_, by_place) = self.counting.project_with_jacobian(points[k]);
                let pixels = part_area.map_or(1.0, |area| area * determinant(&product(&by_place, &tangents[k])).abs());
                weights[k] = weigh(pixels);
            }
            for (image, sights) in sights.iter_mut().enumerate() {
                self.look([state, sighting], image, &points[..n], &tangents, sights);
            }
            for (k, &weight) in weights[..n].iter().enumerate() {
                rows.add(self.frames.factor, state, &sights, k, weight, &mut sums);
            }
        }
        sums
    }

    /// Where the points of a batch are in an image, and what it shows there.
    fn look(
        &self,
        [state, sighting]: [&State; 2],
        image: usize,
        points: &[[f64; 3]],
        tangents: &[[[f64; 2]; 3]],
        sights: &mut Sights,
    ) {
        let n = points.len();
        let (mut u, mut v) = ([f64::NAN; BATCH], [f64::NAN; BATCH]);
        let (motion, factor) = (&state.motions[image], self.frames.factor);
        for (k, &point) in points.iter().enumerate() {
            let place = motion.apply(point);
            let (pixel, by_place) = state.camera.project_with_jacobian(place);
            let (pixel, by_place) = (pixel.map(|c| c * factor), by_place.map(|r| r.map(|c| c * factor)));
            let [along, across] = [0, 1].map(|t| motion.turn(tangents[k].map(|row| row[t])));
            let turned = std::array::from_fn(|d| [along[d], across[d]]);
            sights.sight[k] = Sight { place, by_place, by_cell: product(&by_place, &turned) };
            if self.is_seen(sighting, image, point) {
                [u[k], v[k]] = pixel;
            }
        }
        let [along_u, along_v] = &mut sights.slope;
        let slope = [&mut along_u[..n], &mut along_v[..n]];
        self.frames.samplers[image].values_and_gradients(&u[..n], &v[..n], &mut sights.grey[..n], slope);
    }

    fn is_seen(&self, sighting: &State, image: usize, point: [f64; 3]) -> bool {
        let Frames { size, factor, margin, .. } = &self.frames;
        let pixel = sighting.camera.project(sighting.motions[image].apply(point));
        // What is not a number is outside every image.
        pixel.iter().zip(size).all(|(c, &side)| (*margin..=side as f64 - 1.0 - margin).contains(&(c * factor)))
    }
}

fn product(left: &[[f64; 3]; 2], right: &[[f64; 2]; 3]) -> [[f64; 2]; 2] {
    left.map(|row| [0, 1].map(|t| row.iter().zip(right).map(|(l, r)| l * r[t]).sum()))
}

fn determinant([[a, b], [c, d]]: &[[f64; 2]; 2]) -> f64 {
    a * d - b * c
}
