//! Gauss-Newton iterations on a sum of terms.

use crate::equations::basis::Basis;
use crate::equations::term::{Term, TermReport};
use crate::results::solution::Iteration;
use crate::{Error, Hessian, Monitor, Progress, SolveError, Stage};

/// Smallest ratio of successive corrections that is trusted. The first ratios may be far smaller than those that follow.
const MIN_RATIO: f64 = 0.25;
/// Largest ratio of successive corrections that is told from one.
const MAX_RATIO: f64 = 0.99;
/// Relative change of length from which on a penalty is added to a new Hessian: the kept one weighs it in the reference configuration.
const MAX_STRETCH: f64 = 0.05;

/// Stopping criterion and options of the iterations.
pub(crate) struct GaussNewton {
    /// Level of the pyramid, 0 for the full resolution.
    pub(crate) level: usize,
    pub(crate) hessian: Hessian,
    /// Largest error left at which the iterations stop, in pixels of the level.
    pub(crate) tolerance: f64,
    pub(crate) max_iterations: usize,
    /// Increment in pixels from which on the iterations have diverged: the larger side of the image.
    pub(crate) max_increment: f64,
}

/// End of the iterations.
pub(crate) struct Outcome<const D: usize> {
    pub(crate) displacement: Vec<[f64; D]>,
    pub(crate) converged: bool,
    /// Estimate of the largest error of a node that is left, in pixels of the level.
    pub(crate) error_left: f64,
    /// Length of the last increment of each node, in pixels of the level.
    pub(crate) increments: Vec<f64>,
    /// Report of each term at the displacement before the last increment.
    pub(crate) reports: Vec<TermReport>,
}

impl GaussNewton {
    /// Minimises the sum of `terms` over the fields of `basis` from `displacement` on, and appends every iteration to `history`.
    ///
    /// Each term with an image measures an increment in its own pixels; the largest over all terms decides.
    ///
    /// # Errors
    ///
    /// [`SolveError::Diverged`] with node numbers of the mesh of the terms, [`SolveError::Singular`], or the errors of a term.
    pub(crate) fn run<const D: usize>(
        &self,
        terms: &mut [&mut dyn Term<D>],
        basis: &mut dyn Basis<D>,
        mut displacement: Vec<[f64; D]>,
        history: &mut Vec<Iteration>,
        monitor: &dyn Monitor,
    ) -> Result<Outcome<D>, Error> {
        let mut iteration = 0;
        let mut previous = None;
        loop {
            iteration += 1;
            basis.linearize(&displacement);
            let mut penalised = terms.iter().any(|term| term.is_penalty());
            if penalised && basis.stretch() <= MAX_STRETCH {
                // The kept Hessian holds the penalty of the reference configuration. However strong it is, a mean gradient changes
                // neither its null space nor its scale by more than the stretch. The fields in equilibrium are changed by it, but not
                // by a rotation.
                if terms.iter().any(|term| term.is_corotated()) {
                    basis.average_rotation();
                } else {
                    basis.average_deformation();
                }
                penalised = false;
            }
            let changed = terms.iter().any(|term| term.needs_hessian());
            let mut equations = basis.equations(self.hessian == Hessian::Updated || penalised || changed);
            let mut reports = Vec::with_capacity(terms.len());
            for term in terms.iter_mut() {
                reports.push(term.assemble(&displacement, basis, &mut equations, monitor)?);
            }
            let increment = basis.solve(equations)?;
            let lengths = pixel_lengths(terms, &increment);
            let largest = lengths.iter().copied().fold(0.0, f64::max);
            if lengths.iter().any(|&length| self.is_too_large(length)) {
                return Err(self.diverged(iteration, &lengths).into());
            }
            for (u, increment) in displacement.iter_mut().zip(&increment) {
                for (u, increment) in u.iter_mut().zip(increment) {
                    *u += increment;
                }
            }
            let scale = f64::from(1_u32 << self.level);
            let done = Iteration {
                level: self.level,
                iteration,
                correction: largest * scale,
                residual_rms: residual_rms(&reports),
            };
            history.push(done);
            monitor.progress(&Progress {
                stage: if self.level == 0 { Stage::Solve } else { Stage::Pyramid },
                level: self.level,
                iteration,
                correction: done.correction,
                residual_rms: done.residual_rms,
            });
            let error_left = error_left(previous, largest);
            previous = Some(largest);
            let converged = error_left <= self.tolerance && !terms.iter().any(|term| term.has_changed());
            if converged || iteration == self.max_iterations {
                return Ok(Outcome { displacement, converged, error_left, increments: lengths, reports });
            }
        }
    }

    fn is_too_large(&self, length: f64) -> bool {
        length.is_nan() || length > self.max_increment
    }

    fn diverged(&self, iteration: usize, lengths: &[f64]) -> SolveError {
        let nodes = (0..lengths.len()).filter(|&node| self.is_too_large(lengths[node])).collect();
        let correction = lengths.iter().copied().fold(0.0, |m: f64, c| if c.is_nan() { c } else { m.max(c) });
        SolveError::Diverged { iteration, nodes, correction }
    }
}

/// Estimate of the error that is left after the correction `last`: the sum of the corrections to come, a geometric series of the
/// ratio found. A first correction is taken to be followed by ones half as large.
fn error_left(previous: Option<f64>, last: f64) -> f64 {
    let ratio = previous.map_or(0.5, |previous| (last / previous).clamp(MIN_RATIO, MAX_RATIO));
    // Without any correction the ratio may be a NaN.
    if last > 0.0 { last * ratio / (1.0 - ratio) } else { last }
}

/// Length in pixels of an increment at each node: the largest over the terms with an image.
pub(crate) fn pixel_lengths<const D: usize>(terms: &mut [&mut dyn Term<D>], increment: &[[f64; D]]) -> Vec<f64> {
    let mut all = terms.iter_mut().filter_map(|term| term.pixel_lengths(increment));
    let mut largest = all.next().unwrap_or_default();
    for lengths in all {
        // A NaN stays.
        largest.iter_mut().zip(lengths).for_each(|(a, b)| *a = if a.is_nan() || *a >= b { *a } else { b });
    }
    largest
}

/// Root mean square of the residual over all terms with an image.
pub(crate) fn residual_rms(reports: &[TermReport]) -> f64 {
    let images = || reports.iter().filter(|report| report.weight > 0.0);
    let cost: f64 = images().map(|report| report.cost).sum();
    let weight: f64 = images().map(|report| report.weight).sum();
    (cost / weight).sqrt()
}
