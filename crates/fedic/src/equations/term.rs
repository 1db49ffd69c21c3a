//! Terms of the functional that is minimised.

use crate::equations::basis::Basis;
use crate::equations::normal_equations::NormalEquations;
use crate::{Error, Monitor};

/// A term of the functional: the image term of one observation, or a penalty.
pub(crate) trait Term<const D: usize> {
    /// Adds the share of this term at `displacement` to `equations`.
    ///
    /// # Errors
    ///
    /// [`Error`] if the term cannot be evaluated there, or `monitor` asks to stop.
    fn assemble(
        &mut self,
        displacement: &[[f64; D]],
        basis: &dyn Basis<D>,
        equations: &mut NormalEquations,
        monitor: &dyn Monitor,
    ) -> Result<TermReport, Error>;

    /// Whether the term must be assembled with a new Hessian, as its points have changed.
    fn needs_hessian(&self) -> bool {
        false
    }

    /// Whether the points of the term differ from those of the Hessian in use.
    fn has_changed(&self) -> bool {
        false
    }

    /// Whether the term is a penalty on the displacement, without image.
    fn is_penalty(&self) -> bool {
        false
    }

    /// Whether the term is a penalty in axes that turn with the mean rotation of the displacement.
    fn is_corotated(&self) -> bool {
        false
    }

    /// Length in pixels of an increment at each node, from the displacement that was assembled last. `None` for a term without
    /// image.
    fn pixel_lengths(&mut self, _increment: &[[f64; D]]) -> Option<Vec<f64>> {
        None
    }
}

/// Cost of a term at a displacement.
#[derive(Debug, Clone, Default)]
pub(crate) struct TermReport {
    /// Sum of the weighted squared residuals.
    pub(crate) cost: f64,
    /// Sum of the weights, in the units of the cost per squared grey level; zero for a penalty.
    pub(crate) weight: f64,
    /// Agreement of the images over each cell read. Empty for a penalty.
    pub(crate) cells: Vec<CellAgreement>,
}

/// Effect of robust weights on a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WeighedCell {
    /// Share of the weight of the points that is kept.
    pub(crate) kept: f64,
    /// Mean derivative of the weighed residual with respect to the residual.
    pub(crate) slope: f64,
    /// Mean square of the weighed residual, in squared grey levels.
    pub(crate) power: f64,
    /// Mean square of the weights.
    pub(crate) squared: f64,
}

/// Agreement of the two images over a cell.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CellAgreement {
    /// Root mean square of the residual, in grey levels; NaN without points.
    pub(crate) residual: f64,
    /// Standard deviation, in grey levels, of the residual that is left by the best gain and offset of the cell; NaN without points.
    pub(crate) scatter: f64,
    /// Correlation coefficient of the grey levels; NaN without points, zero where one image is flat.
    pub(crate) correlation: f64,
    /// Share of the weights that is used, from 0 to 1, robust weights not counted.
    pub(crate) used: f64,
    /// Effect of robust weights; `None` if all are one.
    pub(crate) weighed: Option<WeighedCell>,
    /// Whether the cell is left out as damaged.
    pub(crate) is_dropped: bool,
    /// Whether the deformed image has no grey level at some points.
    pub(crate) is_partial: bool,
}

impl CellAgreement {
    /// Share of the weight that robust weights keep.
    pub(crate) fn kept(&self) -> f64 {
        self.weighed.map_or(1.0, |weighed| weighed.kept)
    }
}
