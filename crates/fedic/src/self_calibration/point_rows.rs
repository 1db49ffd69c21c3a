//! Contribution of one quadrature point to the normal equations.

use fedic_camera::Parametric;

use crate::self_calibration::normal_equations::{CalibrationEquations, PointRows};
use crate::self_calibration::problem::{Problem, State};

/// A quadrature point in one image.
#[derive(Clone, Copy)]
pub(crate) struct PointSample {
    /// Position of the moved point.
    pub(crate) position: [f64; 3],
    /// Jacobian of the image point with respect to the world point.
    pub(crate) world_jacobian: [[f64; 3]; 2],
    /// Jacobian of the image point with respect to the reference coordinates of the cell.
    pub(crate) cell_jacobian: [[f64; 2]; 2],
    /// Grey level; NaN if the image does not see the point.
    pub(crate) grey: f32,
    /// Image gradient.
    pub(crate) gradient: [f32; 2],
}

/// Values at which the normal equations are assembled.
pub(crate) struct Evaluation<'a> {
    pub(crate) problem: &'a Problem<'a>,
    pub(crate) state: &'a State,
    /// Pixels of the level per pixel at full resolution.
    pub(crate) factor: f64,
}

/// Scratch buffers for the rows of a point.
#[derive(Default)]
pub(crate) struct RowBuffers {
    images: Vec<usize>,
    parameter_jacobian: Vec<[f64; 2]>,
    parameters: Vec<f64>,
    mean: Vec<f64>,
    own: Vec<f64>,
    residual: Vec<f64>,
}

impl RowBuffers {
    /// Adds point `k` of a batch, whose `samples` are given image by image, if at least two images see it.
    pub(crate) fn add_point(
        &mut self,
        &Evaluation { problem, state, factor }: &Evaluation<'_>,
        samples: &[Vec<PointSample>],
        k: usize,
        weight: f64,
        equations: &mut CalibrationEquations,
    ) {
        self.images.clear();
        self.images.extend((0..samples.len()).filter(|&image| samples[image][k].grey.is_finite()));
        if self.images.len() < 2 {
            return;
        }
        let count = self.images.len() as f64;
        // Grey level and gradient, in reference coordinates of the cell, of the mean texture.
        let (mean, gradient) = self.mean_texture(problem, state, samples, k);
        self.residual.iter_mut().for_each(|grey| *grey -= mean);
        self.parameter_jacobian.resize(problem.parameters.len(), [0.0; 2]);
        self.parameters.clear();
        self.own.clear();
        let mut squared_gradient = 0.0;
        for &image in &self.images {
            let sample = &samples[image][k];
            // The texture gradient as it appears in this image.
            let [[a, b], [c, d]] = sample.cell_jacobian;
            let det = a * d - b * c;
            let q = [(d * gradient[0] - c * gradient[1]) / det, (a * gradient[1] - b * gradient[0]) / det];
            squared_gradient += q[0] * q[0] + q[1] * q[1];
            state.camera.parameter_jacobian(sample.position, problem.parameters, &mut self.parameter_jacobian);
            self.parameters.extend(self.parameter_jacobian.iter().map(|[u, v]| factor * (q[0] * u + q[1] * v)));
            let [along_u, along_v] = &sample.world_jacobian;
            let sensitivity: [f64; 3] = std::array::from_fn(|d| q[0] * along_u[d] + q[1] * along_v[d]);
            let motion = &state.motions[image];
            self.own.extend(problem.components.iter().map(|&component| {
                let derivative = motion.derivative(component, sample.position);
                sensitivity.iter().zip(derivative).map(|(s, d)| s * d).sum::<f64>()
            }));
            if problem.gain_and_offset {
                self.own.extend([f64::from(sample.grey) - problem.grey_origin, 1.0]);
            }
        }
        equations.add_sensitivities(weight, &self.parameters, squared_gradient);
        equations.add_texture(weight, mean);
        self.subtract_mean(problem.parameters.len(), count);
        let Self { images, parameters, own, residual, .. } = self;
        equations.add(&PointRows { weight, images, parameters, own, residual });
    }

    /// Mean grey level and gradient over the images that see the point. Stores the corrected grey levels as `residual`.
    fn mean_texture(
        &mut self,
        problem: &Problem<'_>,
        state: &State,
        samples: &[Vec<PointSample>],
        k: usize,
    ) -> (f64, [f64; 2]) {
        let count = self.images.len() as f64;
        let (mut mean, mut gradient) = (0.0, [0.0; 2]);
        self.residual.clear();
        for &image in &self.images {
            let ([gain, offset], sample) = (state.brightness[image], &samples[image][k]);
            let grey = gain * (f64::from(sample.grey) - problem.grey_origin) + offset;
            self.residual.push(grey);
            mean += grey / count;
            let [along_u, along_v] = sample.gradient.map(|g| gain * f64::from(g) / count);
            let [by_u, by_v] = &sample.cell_jacobian;
            gradient = [0, 1].map(|t| gradient[t] + along_u * by_u[t] + along_v * by_v[t]);
        }
        (mean, gradient)
    }

    /// Subtracts the mean over the images of the derivatives with respect to the camera's parameters: a change that is the same
    /// in all images only moves the texture on the specimen.
    fn subtract_mean(&mut self, num_parameters: usize, count: f64) {
        let length = num_parameters.max(1);
        self.mean.clear();
        self.mean.resize(num_parameters, 0.0);
        for row in self.parameters.chunks_exact(length) {
            self.mean.iter_mut().zip(row).for_each(|(mean, s)| *mean += s / count);
        }
        for row in self.parameters.chunks_exact_mut(length) {
            row.iter_mut().zip(&self.mean).for_each(|(s, mean)| *s -= mean);
        }
    }
}
