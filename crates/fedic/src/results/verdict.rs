//! Verdict on a measured field: what each cell and node shows of its error, and flags with a reason.

use std::f64::consts::PI;

use fedic_mesh::{CellType, Mesh};

use crate::equations::deformation::folded_cells;
use crate::equations::term::{CellAgreement, WeighedCell};
use crate::projection::projected_points::project_nodes;
use crate::quadrature::shape_table::mean_squared_shapes;
use crate::results::covariance::noise_pass::pixels_averaged;
use crate::results::flags::{CellFlag, NodeFlag};
use crate::results::quality::{
    GRADIENT_TO_NOISE, MAX_DEVIATION, MAX_LIGHT, MIN_CORRELATION, NODE_ERROR, Quality, SIGNIFICANCE,
};
use crate::results::solution::Information;
use crate::solve::level::{Level, LevelSolution};
use crate::{PLANE, Robust};

/// Root mean square of the gradient of unit white noise, interpolated by splines without smoothing, about.
const NOISE_GRADIENT: f64 = 0.7;

/// Smallest mean derivative of the weighed residual of a cell: that of few inliers may be zero or negative.
const MIN_SLOPE: f64 = 0.05;

/// Measurement that is judged.
pub(crate) struct Judged<'a> {
    pub(crate) mesh: &'a Mesh,
    pub(crate) level: &'a Level<PLANE>,
    pub(crate) solution: &'a LevelSolution<PLANE>,
    /// Agreement of the images over each cell.
    pub(crate) cells: &'a [CellAgreement],
    pub(crate) smoothing: f64,
    /// Standard deviation of the noise of one image, if it is known.
    pub(crate) noise: Option<f64>,
    /// Function of the robust weights, if there are any.
    pub(crate) robust: Option<Robust>,
}

impl Judged<'_> {
    /// Evidence and flags, of the nodes of the mesh that is solved on.
    pub(crate) fn quality(&self) -> Quality {
        let averaged = pixels_averaged(self.smoothing);
        let folded = folded_cells(self.mesh, &self.solution.outcome.displacement);
        let variance = match self.noise {
            Some(noise) => 2.0 * noise * noise / averaged,
            None => self.estimated_variance(&folded, averaged),
        };
        let noise = self.noise.unwrap_or_else(|| (0.5 * averaged * variance).sqrt());
        let cell_flags = self.cell_flags(&folded, variance, averaged);
        let (deviation, conditioning) = self.deviations(noise);
        let cells = || self.cells.iter().enumerate();
        Quality {
            noise,
            used_share: cells().map(|(_, cell)| cell.used.min(1.0)).collect(),
            kept_share: cells().map(|(_, cell)| cell.kept()).collect(),
            correlation: cells().map(|(_, cell)| cell.correlation).collect(),
            normalized_residual: cells().map(|(_, cell)| cell.scatter / variance.sqrt()).collect(),
            misfit: cells().map(|(index, _)| self.misfit(index, variance)).collect(),
            node_flags: self.node_flags(&cell_flags, &deviation),
            cell_flags,
            deviation,
            conditioning,
        }
    }

    /// What each cell contributes to the covariance, for a verdict on it; `None` if all points are used with the same weight.
    pub(crate) fn information(&self, quality: &Quality) -> Option<Vec<Information>> {
        let averaged = pixels_averaged(self.smoothing);
        let variance = 2.0 * quality.noise * quality.noise / averaged;
        let of_cell = |(index, cell): (usize, &CellAgreement)| {
            if cell.is_dropped || cell.used.is_nan() || cell.used <= 0.0 {
                return Information { hessian: 0.0, noise: 0.0, weights: None };
            }
            let used = cell.used.min(1.0);
            let weights = self.solution.point_weights.get(index).cloned().flatten();
            match cell.weighed.filter(|weighed| weighed.kept > 0.0 && weights.is_some()) {
                None => Information { hessian: used, noise: used, weights: None },
                Some(WeighedCell { kept, slope, power, squared }) => Information {
                    hessian: used * slope.max(MIN_SLOPE) / kept,
                    noise: used * power / (variance * squared),
                    weights,
                },
            }
        };
        let all: Vec<Information> = self.cells.iter().enumerate().map(of_cell).collect();
        let full = Information { hessian: 1.0, noise: 1.0, weights: None };
        all.iter().any(|cell| *cell != full).then_some(all)
    }

    fn cell_flags(&self, folded: &[bool], variance: f64, averaged: f64) -> Vec<u8> {
        let weakest = GRADIENT_TO_NOISE * (0.5 * averaged * variance).sqrt() * noise_gradient(self.smoothing);
        let smallest_misfits = CellType::ALL.map(smallest_misfit);
        let flags = |(index, cell): (usize, &CellAgreement)| {
            let smallest_misfit = smallest_misfits[self.mesh.cell(index).cell_type as usize];
            let independent = (cell.used * self.level.textures[index].pixels / averaged).max(1.0);
            let is_significant = cell.scatter * cell.scatter > largest_mean_square(independent) * variance;
            let of_images = if cell.used.is_nan() || cell.used <= 0.0 {
                CellFlag::FewPoints.bit()
            } else if cell.is_dropped || self.robust.is_some_and(|robust| cell.kept() < robust.min_kept()) {
                CellFlag::Damaged.bit()
            } else if cell.correlation.is_nan() || cell.correlation < MIN_CORRELATION {
                CellFlag::Uncorrelated.bit()
            } else if self.level.textures[index].gradient < weakest {
                CellFlag::WeakTexture.bit()
            } else if is_significant && self.misfit(index, variance) > smallest_misfit {
                CellFlag::Misfit.bit()
            } else if self.light(index) > MAX_LIGHT {
                CellFlag::Light.bit()
            } else {
                0
            };
            of_images | if folded[index] { CellFlag::Folded.bit() } else { 0 }
        };
        self.cells.iter().enumerate().map(flags).collect()
    }

    /// Variance of the residual due to the noise: the median over the cells that are not flagged. They are told by the lower quartile
    /// of the cells whose images correlate, most of which may be wrong.
    fn estimated_variance(&self, folded: &[bool], averaged: f64) -> f64 {
        let quartile = self.quantile(0.25, |_, cell| cell.correlation >= MIN_CORRELATION);
        let flags = self.cell_flags(folded, quartile, averaged);
        let median = self.quantile(0.5, |index, _| flags[index] == 0);
        if median.is_nan() { quartile } else { median }
    }

    /// Quantile of the residual variance over some cells; NaN without any.
    fn quantile(&self, share: f64, is_taken: impl Fn(usize, &CellAgreement) -> bool) -> f64 {
        let taken = self.cells.iter().enumerate().filter(|&(index, cell)| is_taken(index, cell));
        let mut squares: Vec<f64> = taken.map(|(_, cell)| cell.scatter * cell.scatter).collect();
        squares.sort_unstable_by(f64::total_cmp);
        squares.get((share * squares.len() as f64) as usize).copied().unwrap_or(f64::NAN)
    }

    /// Displacement in pixels that would explain the residual of a cell beyond that of the noise.
    fn misfit(&self, cell: usize, variance: f64) -> f64 {
        let scatter = self.cells[cell].scatter;
        (scatter * scatter - variance).max(0.0).sqrt() / self.level.textures[cell].gradient
    }

    /// Displacement in pixels that would cause as large a residual as a gain and offset of the cell would remove.
    fn light(&self, cell: usize) -> f64 {
        let CellAgreement { residual, scatter, .. } = self.cells[cell];
        (residual * residual - scatter * scatter).max(0.0).sqrt() / self.level.textures[cell].gradient
    }

    /// Standard deviation of each node in its worst direction, in pixels, and ratio of the best to the worst.
    fn deviations(&self, noise: f64) -> (Vec<f64>, Vec<f64>) {
        let observation = &self.level.observation;
        // Where points weigh one pixel each, the blocks are those of displacements in the unit of the mesh.
        let in_pixels = (self.mesh.num_cells() > 0 && observation.quadrature.point_area(0).is_none())
            .then(|| project_nodes::<PLANE>(self.mesh, observation.camera.as_ref(), None));
        let both = self.solution.node_blocks.iter().enumerate().map(|(node, &[[a, b], [_, d]])| {
            let (mean, half) = (0.5 * (a + d), (0.25 * (a - d) * (a - d) + b * b).sqrt());
            let [smallest, largest] = [(mean - half).max(0.0), mean + half];
            let scale = in_pixels.as_ref().map_or(1.0, |nodes| nodes[node].pixels_per_area::<PLANE>());
            ((2.0 * scale / smallest).sqrt() * noise, (smallest / largest).sqrt())
        });
        both.unzip()
    }

    fn node_flags(&self, cell_flags: &[u8], deviation: &[f64]) -> Vec<u8> {
        let num_nodes = self.mesh.num_nodes();
        let (mut with_valid, mut with_flagged) = (vec![false; num_nodes], vec![false; num_nodes]);
        for (cell, &flags) in self.mesh.cells().zip(cell_flags) {
            for &node in cell.nodes {
                with_valid[node as usize] |= !CellFlag::is_invalid(flags);
                with_flagged[node as usize] |= flags != 0;
            }
        }
        let outcome = &self.solution.outcome;
        let flags = |node: usize| {
            let mut flags = 0;
            if !with_valid[node] {
                flags |= NodeFlag::NotMeasured.bit();
            } else if with_flagged[node] {
                flags |= NodeFlag::BesideFlagged.bit();
            }
            if deviation[node].is_nan() || deviation[node] > MAX_DEVIATION {
                flags |= NodeFlag::Uncertain.bit();
            }
            if !outcome.converged {
                flags |= NodeFlag::Unconverged.bit();
            }
            flags
        };
        (0..num_nodes).map(flags).collect()
    }
}

/// Misfit of a cell, in pixels, one of whose nodes is wrong by [`NODE_ERROR`]: the one that moves the cell least.
fn smallest_misfit(cell_type: CellType) -> f64 {
    NODE_ERROR * mean_squared_shapes(cell_type).into_iter().fold(f64::INFINITY, f64::min).sqrt()
}

/// Root mean square of the gradient of unit white noise along one direction, after a smoothing and the interpolation.
fn noise_gradient(smoothing: f64) -> f64 {
    let smoothed = 1.0 / ((8.0 * PI).sqrt() * smoothing * smoothing);
    smoothed.min(NOISE_GRADIENT)
}

/// Mean square of this many independent normal variables of variance one that is exceeded [`SIGNIFICANCE`] standard deviations from
/// the mean (Wilson and Hilferty, 1931).
fn largest_mean_square(count: f64) -> f64 {
    let spread = 2.0 / (9.0 * count);
    (1.0 - spread + SIGNIFICANCE * spread.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn largest_mean_square_approaches_that_of_a_normal_distribution() {
        let count = 1e6_f64;
        assert!((largest_mean_square(count) - 1.0 - SIGNIFICANCE * (2.0 / count).sqrt()).abs() < 1e-4);
        // Chi-squared distribution of one degree of freedom: the square of a normal variable, two-sided.
        assert!((largest_mean_square(1.0) - 27.0).abs() < 4.0);
    }
}
