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

    /// Whether the term is a penalty on the displacement, without image.
    fn is_penalty(&self) -> bool {
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
    /// Root mean square of the residual over each cell read, in grey levels; NaN in a cell without points in the image. Empty for a
    /// penalty.
    pub(crate) cell_residuals: Vec<f64>,
    /// Cells with points outside the deformed image.
    pub(crate) outside_cells: Vec<usize>,
}
