//! What a point adds to the normal equations, from what the images show there.

use crate::self_calibration::problem::{Problem, State};
use crate::self_calibration::sums::{PointRows, Sums};

/// Points read at once.
pub(crate) const BATCH: usize = 64;

/// A point as one image sees it.
#[derive(Clone, Copy, Default)]
pub(crate) struct Sight {
    pub(crate) place: [f64; 3],
    /// Of the image point by the place.
    pub(crate) by_place: [[f64; 3]; 2],
    /// Of the image point by the reference coordinates of the cell.
    pub(crate) by_cell: [[f64; 2]; 2],
}

/// The points of a batch as one image sees them.
#[derive(Clone)]
pub(crate) struct Sights {
    pub(crate) sight: [Sight; BATCH],
    pub(crate) grey: [f32; BATCH],
    pub(crate) slope: [[f32; BATCH]; 2],
}

/// Memory for the rows of a point.
pub(crate) struct Rows<'a> {
    problem: &'a Problem<'a>,
    seen: Vec<usize>,
    columns: Vec<[f64; 2]>,
    parameters: Vec<f64>,
    mean: Vec<f64>,
    own: Vec<f64>,
    residual: Vec<f64>,
}

impl<'a> Rows<'a> {
    pub(crate) fn new(problem: &'a Problem<'a>) -> Self {
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
    pub(crate) fn add(
        &mut self,
        factor: f64,
        state: &State,
        sights: &[Sights],
        k: usize,
        weight: f64,
        sums: &mut Sums,
    ) {
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
