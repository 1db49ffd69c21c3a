//! Gauss-Newton held back where it overshoots (Levenberg and Marquardt), on one level of the images.

use crate::self_calibration::problem::{Problem, State};
use fedic_camera::Camera;

use crate::self_calibration::statistics::sensitivities;
use crate::self_calibration::sums::Sums;
use crate::self_calibration::view::View;
use crate::{Error, Iteration, Monitor, Progress, Stage};

const FIRST_DAMPING: f64 = 1e-4;
const DAMPING_FACTOR: f64 = 10.0;
/// Damping at which a step no longer moves anything.
const LARGEST_DAMPING: f64 = 1e8;
/// Relative growth of the residual's variance that is let pass: near the solution the Jacobian of the mean texture may
/// lead to one a little beside the least.
const SLACK: f64 = 1e-3;

/// Pixels by which points may stray before it is asked anew which images see them: lest at the end points come and go.
const STRAY: f64 = 0.5;

/// When to stop.
pub(crate) struct Limits {
    pub(crate) level: usize,
    /// Root mean square of the last correction, in pixels of the level.
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
}

/// Improves `state`; returns the sums there, the state that tells which images see a point, and whether the last correction was within the tolerance.
pub(crate) fn iterate(
    problem: &Problem<'_>,
    view: &View<'_>,
    state: &mut State,
    limits: &Limits,
    history: &mut Vec<Iteration>,
    monitor: &dyn Monitor,
) -> Result<(Sums, State, bool), Error> {
    let mut sighting = state.clone();
    let mut sums = view.sums(state, &sighting, |pixels| pixels, monitor)?;
    let reach: Vec<f64> = sensitivities(problem, state).iter().map(|s| problem.reach / s).collect();
    let mut damping = 0.0;
    for iteration in 1..=limits.max_iterations {
        let residual_rms = sums.variance().sqrt();
        let (correction, free) = loop {
            if damping > LARGEST_DAMPING {
                return Ok((sums, sighting, false));
            }
            if let Some(step) = sums.step(damping, &reach)
                && let Some(moved) = state.moved_by(problem, step.as_slice())
            {
                let correction = sums.visible_motion(&step);
                let strayed = largest_way(problem, &sighting, &moved) / 2.0_f64.powi(limits.level as i32) > STRAY;
                let seen_by = if strayed { &moved } else { &sighting };
                let found = view.sums(&moved, seen_by, |pixels| pixels, monitor)?;
                let within = damping == 0.0 && correction <= limits.tolerance;
                if within || found.variance() <= sums.variance() * (1.0 + SLACK) {
                    if strayed {
                        sighting = moved.clone();
                    }
                    (*state, sums) = (moved, found);
                    break (correction, damping == 0.0);
                }
            }
            damping = f64::max(FIRST_DAMPING, damping * DAMPING_FACTOR);
        };
        damping = if damping <= FIRST_DAMPING { 0.0 } else { damping / DAMPING_FACTOR };
        history.push(Iteration { level: limits.level, iteration, correction, residual_rms });
        let stage = if limits.level == 0 { Stage::Solve } else { Stage::Pyramid };
        monitor.progress(&Progress { stage, level: limits.level, iteration, correction, residual_rms });
        if free && correction <= limits.tolerance {
            return Ok((sums, sighting, true));
        }
    }
    Ok((sums, sighting, false))
}

/// By how many pixels of the full images a node is seen elsewhere in another state, at most.
fn largest_way(problem: &Problem<'_>, one: &State, other: &State) -> f64 {
    let ways = one.motions.iter().zip(&other.motions).flat_map(|(here, there)| {
        problem.mesh.points().iter().map(move |&node| {
            let [u, v] = one.camera.project(here.apply(node));
            let [x, y] = other.camera.project(there.apply(node));
            (x - u).hypot(y - v)
        })
    });
    ways.fold(0.0, |largest, way| if way.is_nan() { f64::INFINITY } else { f64::max(largest, way) })
}
