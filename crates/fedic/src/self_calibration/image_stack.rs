//! Images of one pyramid level, sampled at the quadrature points of the moved mesh.
//!
//! A rigid motion of the nodes of a cell moves every point of the cell rigidly: the points of an image are those of the cell with
//! moved nodes.

use std::ops::Range;
use std::sync::Arc;

use fedic_camera::{Pinhole, Scaled};
use fedic_mesh::{CellType, Rule, jacobian};

use crate::interpolation::image_sampler::ImageSampler;
use crate::parallel::for_each_in_order;
use crate::projection::pointwise::{BATCH, PointwiseProjector};
use crate::quadrature::cell_quadrature::CellQuadrature;
use crate::self_calibration::normal_equations::CalibrationEquations;
use crate::self_calibration::point_rows::{Evaluation, PointSample, RowBuffers};
use crate::self_calibration::problem::{Problem, State};
use crate::{Error, Monitor, Quadrature};

/// Points per parallel task.
const TASK: usize = 4096;

/// Images of one pyramid level.
pub(crate) struct LevelImages {
    pub(crate) samplers: Vec<ImageSampler>,
    /// Columns and rows.
    pub(crate) size: [usize; 2],
    /// Pixels of this level per pixel at full resolution.
    pub(crate) factor: f64,
    /// Width of the border, in pixels, that is not used.
    pub(crate) margin: f64,
}

/// Images of one pyramid level and the quadrature points at which they are sampled.
pub(crate) struct ImageStack<'a> {
    problem: &'a Problem<'a>,
    images: LevelImages,
    quadrature: CellQuadrature,
    /// Camera that determines how many pixels of the level a point stands for.
    counting_camera: Scaled,
}

/// Scratch buffers of one thread.
struct Scratch {
    projector: Box<PointwiseProjector>,
    /// Nodes of the cell moved with each image: at the current state and at the visibility state.
    moved_nodes: Vec<[Vec<[f64; 3]>; 2]>,
    /// Samples of the points of a batch, image by image.
    samples: Vec<Vec<PointSample>>,
    rows: RowBuffers,
}

impl Default for Scratch {
    fn default() -> Self {
        Self {
            projector: PointwiseProjector::new(),
            moved_nodes: Vec::new(),
            samples: Vec::new(),
            rows: RowBuffers::default(),
        }
    }
}

impl<'a> ImageStack<'a> {
    /// Places `density` quadrature points per pixel of the level as seen by `camera`.
    pub(crate) fn new(
        problem: &'a Problem<'a>,
        images: LevelImages,
        camera: &Pinhole,
        density: f64,
    ) -> Result<Self, Error> {
        let counting_camera = Scaled::new(Arc::new(camera.clone()), images.factor);
        let rule = Quadrature::Mesh { rule: Rule::default(), density };
        let quadrature = CellQuadrature::new(problem.mesh, &counting_camera, rule)?;
        Ok(Self { problem, images, quadrature, counting_camera })
    }

    /// Replaces the images, at the same quadrature points.
    pub(crate) fn with_samplers(mut self, samplers: Vec<ImageSampler>) -> Self {
        self.images.samplers = samplers;
        self
    }

    pub(crate) fn num_points(&self) -> usize {
        self.quadrature.num_points()
    }

    /// Assembles the normal equations at `state`. An image is sampled at the points that it sees at the state `visibility`.
    /// `weight` gives the weight of a point from the number of pixels that it stands for.
    pub(crate) fn assemble(
        &self,
        state: &State,
        visibility: &State,
        weight: impl Fn(f64) -> f64 + Sync,
        monitor: &dyn Monitor,
    ) -> Result<CalibrationEquations, Error> {
        let mut total = CalibrationEquations::zeros(self.problem.layout());
        let tasks = (0..self.problem.mesh.num_cells()).flat_map(|cell| {
            let count = self.quadrature.range(cell).len();
            (0..count).step_by(TASK).map(move |first| (cell, first..count.min(first + TASK)))
        });
        for_each_in_order(
            tasks,
            monitor,
            |scratch: &mut Scratch, _, (cell, points)| {
                self.assemble_points(scratch, [state, visibility], cell, points, &weight)
            },
            |_, equations| total.add_equations(&equations),
        )?;
        Ok(total)
    }

    /// Assembles the normal equations of some points of a cell.
    fn assemble_points(
        &self,
        scratch: &mut Scratch,
        states: [&State; 2],
        cell: usize,
        points: Range<usize>,
        weight: &impl Fn(f64) -> f64,
    ) -> CalibrationEquations {
        let mesh = self.problem.mesh;
        let (cell_type, nodes) = (mesh.cell(cell).cell_type, mesh.cell_points(cell));
        let point_area = self.quadrature.point_area(cell);
        let mut equations = CalibrationEquations::zeros(self.problem.layout());
        let evaluation = Evaluation { problem: self.problem, state: states[0], factor: self.images.factor };
        let Scratch { projector, moved_nodes, samples, rows } = scratch;
        moved_nodes.clear();
        moved_nodes.extend(
            (0..self.problem.num_images)
                .map(|image| states.map(|state| nodes.iter().map(|&node| state.motions[image].apply(node)).collect())),
        );
        samples.resize_with(self.problem.num_images, Vec::new);
        let mut weights = [0.0; BATCH];
        for first in points.clone().step_by(BATCH) {
            let n = BATCH.min(points.end - first);
            projector.load(&self.quadrature, cell, cell_type, first, n);
            projector.project_with_jacobian(&self.counting_camera, &nodes);
            for (k, w) in weights[..n].iter_mut().enumerate() {
                let pixels = point_area.map_or(1.0, |area| {
                    area * projector.pixel_element(k, &jacobian(cell_type, &nodes, projector.coordinates(k)))
                });
                *w = weight(pixels);
            }
            for (image, (nodes, samples)) in moved_nodes.iter().zip(&mut *samples).enumerate() {
                self.sample_image(projector, image, states, (cell_type, nodes), samples);
            }
            for (k, &weight) in weights[..n].iter().enumerate() {
                rows.add_point(&evaluation, samples, k, weight, &mut equations);
            }
        }
        equations
    }

    /// Samples an image at the points of the batch that `projector` holds.
    fn sample_image(
        &self,
        projector: &mut PointwiseProjector,
        image: usize,
        [state, visibility]: [&State; 2],
        (cell_type, [nodes, visibility_nodes]): (CellType, &[Vec<[f64; 3]>; 2]),
        samples: &mut Vec<PointSample>,
    ) {
        let factor = self.images.factor;
        projector.project(&visibility.camera, visibility_nodes);
        let n = projector.len();
        let (mut u, mut v) = ([f64::NAN; BATCH], [f64::NAN; BATCH]);
        let mut visible = [false; BATCH];
        for (k, visible) in visible[..n].iter_mut().enumerate() {
            *visible = self.is_inside(projector.pixel_at(k));
        }
        projector.project_with_jacobian(&state.camera, nodes);
        for k in (0..n).filter(|&k| visible[k]) {
            [u[k], v[k]] = projector.pixel_at(k).map(|c| c * factor);
        }
        let mut grey = [0.0; BATCH];
        let [mut along_u, mut along_v] = [[0.0; BATCH]; 2];
        let gradient = [&mut along_u[..n], &mut along_v[..n]];
        self.images.samplers[image].values_and_gradients(&u[..n], &v[..n], &mut grey[..n], gradient);
        samples.clear();
        samples.extend((0..n).map(|k| {
            let world_jacobian = projector.jacobian_at(k).map(|row| row.map(|entry| entry * factor));
            let tangents = jacobian(cell_type, nodes, projector.coordinates(k));
            PointSample {
                position: projector.position_at(k),
                world_jacobian,
                cell_jacobian: product(&world_jacobian, &tangents),
                grey: grey[k],
                gradient: [along_u[k], along_v[k]],
            }
        }));
    }

    /// Whether an image point at full resolution lies inside the used part of the images; false for NaN.
    fn is_inside(&self, pixel: [f64; 2]) -> bool {
        let LevelImages { size, factor, margin, .. } = &self.images;
        pixel.iter().zip(size).all(|(c, &side)| (*margin..=side as f64 - 1.0 - margin).contains(&(c * factor)))
    }
}

fn product(left: &[[f64; 3]; 2], right: &[[f64; 2]; 3]) -> [[f64; 2]; 2] {
    left.map(|row| [0, 1].map(|t| row.iter().zip(right).map(|(l, r)| l * r[t]).sum()))
}
