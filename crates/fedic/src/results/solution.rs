//! The measured displacement field.

use crate::PLANE;
use crate::results::quality::Quality;

/// One Gauss-Newton iteration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Iteration {
    /// Level of the pyramid, 0 for the full resolution.
    pub level: usize,
    /// Number of the iteration on that level, from 1.
    pub iteration: usize,
    /// Largest nodal correction, in pixels of the full resolution.
    pub correction: f64,
    /// Root mean square of the residual before the correction, in grey levels.
    pub residual_rms: f64,
}

/// What a cell contributes to the covariance of the displacement, relative to that of all its points without robust weights.
#[derive(Debug, Clone, PartialEq)]
pub struct Information {
    /// Factor on its share of the Hessian.
    pub hessian: f64,
    /// Factor on the covariance of its right-hand side.
    pub noise: f64,
    /// Weight of each quadrature point; `None` if all are one.
    pub weights: Option<Box<[f32]>>,
}

/// The displacement field and how it was reached.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Solution {
    /// Displacement of each node of the mesh, in its unit; NaN at nodes that were not measured: those of no valid cell.
    pub displacement: Vec<[f64; PLANE]>,
    /// Displacement as the iterations left it, whatever the verdict; NaN at nodes that no cell uses.
    pub unchecked_displacement: Vec<[f64; PLANE]>,
    /// Displacement of each node in the image, `P(X + U) - P(X)`, in pixels; NaN at nodes that were not measured.
    pub pixel_displacement: Vec<[f64; 2]>,
    /// Whether the error left by the iterations is within the tolerance.
    pub converged: bool,
    /// Estimate of the largest error of a node that the iterations leave, in pixels: the sum of the corrections to come, if each is
    /// smaller than the one before by the ratio found.
    pub error_left: f64,
    /// Iterations on the images at full resolution.
    pub iterations: usize,
    /// Every iteration, coarsest level first.
    pub history: Vec<Iteration>,
    /// Root mean square of the residual over the mesh, in grey levels, before the last correction.
    pub residual_rms: f64,
    /// Root mean square of the residual over each cell, in grey levels; NaN where no point lies in the deformed image.
    pub cell_residuals: Vec<f64>,
    /// Cells with points outside the deformed image, or saturated in it. Their displacement is measured on the other points only.
    pub outside_cells: Vec<usize>,
    /// Number of quadrature points.
    pub num_points: usize,
    /// What each cell contributes to the covariance; `None` if all points of all cells are used with the same weight.
    pub information: Option<Vec<Information>>,
    /// Evidence of each cell and node, and their flags.
    pub quality: Quality,
}
