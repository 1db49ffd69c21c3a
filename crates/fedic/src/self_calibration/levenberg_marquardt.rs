//! Levenberg-Marquardt iterations on one level of the images.

use crate::self_calibration::image_stack::ImageStack;
use crate::self_calibration::normal_equations::CalibrationEquations;
use crate::self_calibration::problem::{Problem, State};
use crate::self_calibration::statistics::sensitivities;
use crate::{Error, Iteration, Monitor, Progress, Stage};

/// First damping after a step that increases the residual. The first attempt at a step is not damped.
const FIRST_DAMPING: f64 = 1e-4;
const DAMPING_FACTOR: f64 = 10.0;
/// Damping at which the iterations are given up.
const MAX_DAMPING: f64 = 1e8;
/// Relative increase of the residual variance that is accepted: the Jacobian of the mean texture is approximate, and near the
/// solution its step may end slightly beside the minimum.
const SLACK: f64 = 1e-3;
/// Visibility is recomputed once points have moved by this many pixels, to avoid chatter near convergence.
const VISIBILITY_DRIFT: f64 = 0.5;

/// Stopping criterion.
pub(crate) struct Criterion {
    pub(crate) level: usize,
    /// RMS displacement of the image points by the last correction, in pixels of the level.
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
}

/// End of the iterations.
pub(crate) struct Minimum {
    /// Normal equations at the last state.
    pub(crate) equations: CalibrationEquations,
    /// State that determined which images see a point.
    pub(crate) visibility: State,
    /// Whether the last correction was within the tolerance.
    pub(crate) converged: bool,
}

/// Minimises the residual, starting from `state`, which becomes the last state.
pub(crate) fn minimize(
    problem: &Problem<'_>,
    stack: &ImageStack<'_>,
    state: &mut State,
    criterion: &Criterion,
    history: &mut Vec<Iteration>,
    monitor: &dyn Monitor,
) -> Result<Minimum, Error> {
    let &Criterion { level, tolerance, max_iterations } = criterion;
    let mut visibility = state.clone();
    let mut equations = stack.assemble(state, &visibility, |pixels| pixels, monitor)?;
    let prior_deviations: Vec<f64> =
        sensitivities(problem, state).iter().map(|sensitivity| problem.prior_deviation / sensitivity).collect();
    let mut damping = 0.0;
    for iteration in 1..=max_iterations {
        let residual_rms = equations.residual_variance().sqrt();
        let (correction, undamped) = loop {
            if damping > MAX_DAMPING {
                return Ok(Minimum { equations, visibility, converged: false });
            }
            if let Some(step) = equations.step(damping, &prior_deviations)
                && let Some(next) = state.perturbed(problem, step.as_slice())
            {
                let correction = equations.rms_displacement(&step);
                let drift = visibility.largest_displacement(&next, problem.mesh) / 2.0_f64.powi(level as i32);
                let update_visibility = drift > VISIBILITY_DRIFT;
                let next_visibility = if update_visibility { &next } else { &visibility };
                let next_equations = stack.assemble(&next, next_visibility, |pixels| pixels, monitor)?;
                let within = damping == 0.0 && correction <= tolerance;
                if within || next_equations.residual_variance() <= equations.residual_variance() * (1.0 + SLACK) {
                    if update_visibility {
                        visibility = next.clone();
                    }
                    (*state, equations) = (next, next_equations);
                    break (correction, damping == 0.0);
                }
            }
            damping = f64::max(FIRST_DAMPING, damping * DAMPING_FACTOR);
        };
        damping = if damping <= FIRST_DAMPING { 0.0 } else { damping / DAMPING_FACTOR };
        history.push(Iteration { level, iteration, correction, residual_rms });
        let stage = if level == 0 { Stage::Solve } else { Stage::Pyramid };
        monitor.progress(&Progress { stage, level, iteration, correction, residual_rms });
        if undamped && correction <= tolerance {
            return Ok(Minimum { equations, visibility, converged: true });
        }
    }
    Ok(Minimum { equations, visibility, converged: false })
}
