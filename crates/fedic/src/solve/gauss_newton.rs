//! Gauss-Newton iterations on one level.

use crate::equations::image_term::{Evaluation, Evaluator};
use crate::projection::projected_points::Sight;
use crate::{COMPONENTS, Error, Hessian, Iteration, Monitor, Progress, SolveError, Stage};

/// Pixels that a mesh may move before its polynomials are compared with the camera again.
const UNCHECKED: f64 = 1.0;

/// How the iterations run on a level.
pub(crate) struct Iterations {
    pub(crate) level: usize,
    pub(crate) hessian: Hessian,
    /// In pixels of the level's own image.
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
    /// Larger side of the level's image: no correction can be larger.
    pub(crate) largest_correction: f64,
}

/// Where the iterations ended.
pub(crate) struct Outcome {
    pub(crate) displacement: Vec<[f64; COMPONENTS]>,
    pub(crate) converged: bool,
    /// At the displacement before the last correction.
    pub(crate) evaluation: Evaluation,
}

impl Iterations {
    /// Minimises the residual from `displacement` on and appends every iteration to `history`.
    pub(crate) fn run(
        &self,
        evaluator: &Evaluator<'_>,
        mut displacement: Vec<[f64; COMPONENTS]>,
        history: &mut Vec<Iteration>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome, Error> {
        let (system, level) = (evaluator.system, evaluator.level);
        let mut brightness = evaluator.first_correction(&displacement, monitor)?;
        let (mut followed, mut moved) = (None::<Vec<bool>>, 0.0);
        let mut iteration = 0;
        loop {
            iteration += 1;
            let with_hessian = self.hessian == Hessian::Updated;
            let mut evaluation =
                evaluator.evaluate(&displacement, brightness, followed.as_deref(), with_hessian, monitor)?;
            brightness = evaluation.correction;
            let mut step = std::mem::take(&mut evaluation.right_hand_side);
            if let Some(penalty) = level.penalty {
                let pull = system.laplacian().matrix.multiply(&system.pattern, displacement.as_flattened());
                step.iter_mut().zip(pull).for_each(|(b, pull)| *b -= penalty * pull);
            }
            match &mut evaluation.hessian {
                Some(hessian) => {
                    if let Some(penalty) = level.penalty {
                        hessian.add_scaled(penalty, &system.laplacian().matrix);
                    }
                    system.factorize(hessian, false, &level.quadrature)?.solve(&mut step);
                }
                None => level.factor.solve(&mut step),
            }
            let step = step.as_chunks::<COMPONENTS>().0;
            let corrections = corrections(&evaluation.views, step);
            let correction = corrections.iter().copied().fold(0.0, f64::max);
            if corrections.iter().any(|&c| self.is_too_large(c)) {
                return Err(self.diverged(evaluator, iteration, &corrections));
            }
            moved = if followed.is_some() { moved + correction } else { correction };
            followed = (moved <= UNCHECKED).then(|| std::mem::take(&mut evaluation.followed));
            for (u, step) in displacement.iter_mut().zip(step) {
                for (u, step) in u.iter_mut().zip(step) {
                    *u += step;
                }
            }
            let scale = f64::from(1_u32 << self.level);
            let done = Iteration {
                level: self.level,
                iteration,
                correction: correction * scale,
                residual_rms: evaluation.residual_rms,
            };
            history.push(done);
            monitor.progress(&Progress {
                stage: if self.level == 0 { Stage::Solve } else { Stage::Pyramid },
                level: self.level,
                iteration,
                correction: done.correction,
                residual_rms: done.residual_rms,
            });
            let converged = correction <= self.tolerance;
            if converged || iteration == self.max_iterations {
                return Ok(Outcome { displacement, converged, evaluation });
            }
        }
    }

    fn is_too_large(&self, correction: f64) -> bool {
        correction.is_nan() || correction > self.largest_correction
    }

    fn diverged(&self, evaluator: &Evaluator<'_>, iteration: usize, corrections: &[f64]) -> Error {
        let moved = |&node: &usize| self.is_too_large(corrections[node]);
        let nodes = evaluator.system.user_nodes((0..corrections.len()).filter(moved).collect());
        let correction = corrections.iter().copied().fold(0.0, |m: f64, c| if c.is_nan() { c } else { m.max(c) });
        SolveError::Diverged { iteration, nodes, correction }.into()
    }
}

/// Length in pixels of the correction of each node.
pub(crate) fn corrections(views: &[Sight], step: &[[f64; COMPONENTS]]) -> Vec<f64> {
    let length = |(view, step): (&Sight, &[f64; COMPONENTS])| {
        let [du, dv] = view.jacobian.map(|row| row.iter().zip(step).map(|(j, s)| j * s).sum::<f64>());
        (du * du + dv * dv).sqrt()
    };
    views.iter().zip(step).map(length).collect()
}
