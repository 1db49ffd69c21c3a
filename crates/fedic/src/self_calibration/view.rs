//! The images at one level of a pyramid, and the normal equations that they give.

use std::sync::Arc;

use fedic_camera::{Camera, Parameter, Pinhole, Scaled};
use fedic_mesh::{Mesh, jacobian, map};

use crate::cell_loop::for_each_cell;
use crate::cell_quadrature::CellQuadrature;
use crate::self_calibration::motion::Motion;
use crate::self_calibration::sums::{Layout, PointRows, Sums};
use crate::{Error, Monitor, Quadrature, Sampler};

/// Points read at once.
const BATCH: usize = 64;

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

/// The images of one level.
pub(crate) struct View<'a> {
    problem: &'a Problem<'a>,
    samplers: Vec<Sampler>,
    /// Pixels of this level per pixel of the images.
    factor: f64,
    /// Where points are read, in pixels: `low <= u <= high`.
    low: f64,
    high: [f64; 2],
    quadrature: CellQuadrature,
    /// The camera at the start, of which the pixels that a point stands for are counted.
    start: Scaled,
}

/// A point as one image sees it.
#[derive(Clone, Copy, Default)]
struct Sight {
    place: [f64; 3],
    /// Of the image point by the place.
    by_place: [[f64; 3]; 2],
    /// Of the image point by the reference coordinates of the cell.
    by_cell: [[f64; 2]; 2],
}

/// The points of a batch as one image sees them.
#[derive(Clone)]
struct Sights {
    sight: [Sight; BATCH],
    grey: [f32; BATCH],
    slope: [[f32; BATCH]; 2],
}

impl<'a> View<'a> {
    /// `size` is that of the images; points nearer than `margin` to their border are not read.
    pub(crate) fn new(
        problem: &'a Problem<'a>,
        samplers: Vec<Sampler>,
        size: [usize; 2],
        margin: f64,
        start: &Pinhole,
        factor: f64,
        quadrature: Quadrature,
    ) -> Result<Self, Error> {
        let start = Scaled::new(Arc::new(*start), factor);
        let quadrature = CellQuadrature::new(problem.mesh, &start, quadrature)?;
        let high = size.map(|side| side as f64 - 1.0 - margin);
        Ok(Self { problem, samplers, factor, low: margin, high, quadrature, start })
    }

    /// The same points of other images.
    pub(crate) fn with_samplers(self, samplers: Vec<Sampler>) -> Self {
        Self { samplers, ..self }
    }

    pub(crate) fn num_points(&self) -> usize {
        self.quadrature.num_points()
    }

    /// The normal equations at `state`. `weigh` makes the weight of a point out of the pixels that it stands for.
    pub(crate) fn sums(
        &self,
        state: &State,
        weigh: impl Fn(f64) -> f64 + Sync,
        monitor: &dyn Monitor,
    ) -> Result<Sums, Error> {
        let layout = self.problem.layout();
        let mut total = Sums::zeros(layout);
        for_each_cell(
            0..self.problem.mesh.num_cells(),
            monitor,
            |_, cell, _| self.of_cell(state, cell, &weigh),
            |_, sums| total.add_sums(&sums),
        )?;
        Ok(total)
    }

    fn of_cell(&self, state: &State, cell: usize, weigh: &impl Fn(f64) -> f64) -> Sums {
        let mesh = self.problem.mesh;
        let (cell_type, nodes) = (mesh.cell(cell).cell_type, mesh.cell_points(cell));
        let part_area = self.quadrature.part_area(cell);
        let count = self.quadrature.range(cell).len();
        let mut sums = Sums::zeros(self.problem.layout());
        let mut rows = Rows::new(self.problem);
        let (mut xi, mut eta) = ([0.0; BATCH], [0.0; BATCH]);
        let (mut points, mut tangents, mut weights) = ([[0.0; 3]; BATCH], [[[0.0; 2]; 3]; BATCH], [0.0; BATCH]);
        let sights = Sights { sight: [Sight::default(); BATCH], grey: [0.0; BATCH], slope: [[0.0; BATCH]; 2] };
        let mut sights = vec![sights; self.problem.images];
        for first in (0..count).step_by(BATCH) {
            let n = BATCH.min(count - first);
            self.quadrature.coordinates(cell, first, &mut xi[..n], &mut eta[..n]);
            for k in 0..n {
                let at = [xi[k], eta[k]];
                (points[k], tangents[k]) = (map(cell_type, &nodes, at), jacobian(cell_type, &nodes, at));
                let (_, by_place) = self.start.project_with_jacobian(points[k]);
                let pixels = part_area.map_or(1.0, |area| area * determinant(&product(&by_place, &tangents[k])).abs());
                weights[k] = weigh(pixels);
            }
            for (image, sights) in sights.iter_mut().enumerate() {
                self.look(state, image, &points[..n], &tangents, sights);
            }
            for (k, &weight) in weights[..n].iter().enumerate() {
                rows.add(self.factor, state, &sights, k, weight, &mut sums);
            }
        }
        sums
    }

    /// Where the points of a batch are in an image, and what it shows there.
    fn look(&self, state: &State, image: usize, points: &[[f64; 3]], tangents: &[[[f64; 2]; 3]], sights: &mut Sights) {
        let n = points.len();
        let (mut u, mut v) = ([f64::NAN; BATCH], [f64::NAN; BATCH]);
        let motion = &state.motions[image];
        for (k, &point) in points.iter().enumerate() {
            let place = motion.apply(point);
            let (pixel, by_place) = state.camera.project_with_jacobian(place);
            let (pixel, by_place) = (pixel.map(|c| c * self.factor), by_place.map(|r| r.map(|c| c * self.factor)));
            let [along, across] = [0, 1].map(|t| motion.turn(tangents[k].map(|row| row[t])));
            let turned = std::array::from_fn(|d| [along[d], across[d]]);
            sights.sight[k] = Sight { place, by_place, by_cell: product(&by_place, &turned) };
            // A point that is not a number is outside every image.
            if (0..2).all(|d| self.low <= pixel[d] && pixel[d] <= self.high[d]) {
                [u[k], v[k]] = pixel;
            }
        }
        let [along_u, along_v] = &mut sights.slope;
        let slope = [&mut along_u[..n], &mut along_v[..n]];
        self.samplers[image].values_and_gradients(&u[..n], &v[..n], &mut sights.grey[..n], slope);
    }
}

/// Memory for the rows of a point.
struct Rows<'a> {
    problem: &'a Problem<'a>,
    seen: Vec<usize>,
    columns: Vec<[f64; 2]>,
    parameters: Vec<f64>,
    mean: Vec<f64>,
    own: Vec<f64>,
    residual: Vec<f64>,
}

impl<'a> Rows<'a> {
    fn new(problem: &'a Problem<'a>) -> Self {
        let np = problem.parameters.len();
        Self {
            problem,
            seen: Vec::new(),
            columns: vec![[0.0; 2]; np],
            parameters: Vec::new(),
            mean: vec![0.0; np],
            own: Vec::new(),
            residual: Vec::new(),
        }
    }

    /// Adds point `k` of a batch, where two images at least see it.
    fn add(&mut self, factor: f64, state: &State, sights: &[Sights], k: usize, weight: f64, sums: &mut Sums) {
        self.seen.clear();
        self.seen.extend((0..sights.len()).filter(|&image| sights[image].grey[k].is_finite()));
        if self.seen.len() < 2 {
            return;
        }
        let count = self.seen.len() as f64;
        // The texture as all images show it: its grey level and its gradient in the cell.
        let (mut mean, mut gradient) = (0.0, [0.0; 2]);
        self.residual.clear();
        for &image in &self.seen {
            let ([gain, offset], sights) = (state.brightness[image], &sights[image]);
            let grey = gain * (f64::from(sights.grey[k]) - self.problem.pivot) + offset;
            self.residual.push(grey);
            mean += grey / count;
            let slope = [0, 1].map(|d| gain * f64::from(sights.slope[d][k]) / count);
            let by_cell = &sights.sight[k].by_cell;
            gradient = [0, 1].map(|t| gradient[t] + slope[0] * by_cell[0][t] + slope[1] * by_cell[1][t]);
        }
        self.residual.iter_mut().for_each(|grey| *grey -= mean);
        self.parameters.clear();
        self.own.clear();
        let mut slope = 0.0;
        for &image in &self.seen {
            let (sight, grey) = (&sights[image].sight[k], f64::from(sights[image].grey[k]));
            // That gradient as this image would show it.
            let [[a, b], [c, d]] = sight.by_cell;
            let det = a * d - b * c;
            let q = [(d * gradient[0] - c * gradient[1]) / det, (a * gradient[1] - b * gradient[0]) / det];
            slope += q[0] * q[0] + q[1] * q[1];
            state.camera.parameter_jacobian(sight.place, self.problem.parameters, &mut self.columns);
            self.parameters.extend(self.columns.iter().map(|[u, v]| factor * (q[0] * u + q[1] * v)));
            let pulled: [f64; 3] = std::array::from_fn(|d| q[0] * sight.by_place[0][d] + q[1] * sight.by_place[1][d]);
            let motion = &state.motions[image];
            self.own.extend(self.problem.components.iter().map(|&component| {
                let way = motion.derivative(component, sight.place);
                pulled.iter().zip(way).map(|(p, w)| p * w).sum::<f64>()
            }));
            if self.problem.brightness {
                self.own.extend([grey - self.problem.pivot, 1.0]);
            }
        }
        sums.add_energy(weight, &self.parameters, slope);
        sums.add_texture(weight, mean);
        self.take_off_mean(count);
        let Self { seen, parameters, own, residual, .. } = self;
        sums.add(&PointRows { weight, seen, parameters, own, residual });
    }

    /// What a parameter does alike in all images only moves the texture on the specimen.
    fn take_off_mean(&mut self, count: f64) {
        let np = self.problem.parameters.len().max(1);
        self.mean.fill(0.0);
        for row in self.parameters.chunks_exact(np) {
            self.mean.iter_mut().zip(row).for_each(|(mean, s)| *mean += s / count);
        }
        for row in self.parameters.chunks_exact_mut(np) {
            row.iter_mut().zip(&self.mean).for_each(|(s, mean)| *s -= mean);
        }
    }
}

fn product(left: &[[f64; 3]; 2], right: &[[f64; 2]; 3]) -> [[f64; 2]; 2] {
    left.map(|row| [0, 1].map(|t| row.iter().zip(right).map(|(l, r)| l * r[t]).sum()))
}

fn determinant([[a, b], [c, d]]: &[[f64; 2]; 2]) -> f64 {
    a * d - b * c
}
