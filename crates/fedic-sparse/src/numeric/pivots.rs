//! Pivots of the factorization: those that vanish belong to undetermined degrees of freedom.

use crate::symbolic::Structure;
use crate::{SparseError, SymmetricMatrix};

/// A pivot vanishes if it is at most this fraction of its diagonal entry ...
const VANISHING_TO_OWN_DIAGONAL: f64 = 1e-11;
/// ... or at most this fraction of the largest diagonal entry, where it may consist of rounding errors.
const VANISHING_TO_LARGEST_DIAGONAL: f64 = 1e-10;
/// If all pivots exceed this fraction of their diagonal entries, the factor may be stored in single precision.
const WELL_CONDITIONED: f64 = 1e-3;

/// Reference values for the pivots of a matrix.
pub(crate) struct PivotCheck {
    diagonal: Vec<f64>,
    threshold: f64,
}

/// Assessment of the pivots of a factorization.
pub(crate) struct PivotReport {
    /// Degrees of freedom whose pivots vanish, increasing.
    pub(crate) undetermined: Vec<usize>,
    /// Whether all pivots are of the order of their diagonal entries.
    pub(crate) well_conditioned: bool,
}

impl PivotCheck {
    /// Reads the diagonal of a matrix.
    ///
    /// # Errors
    ///
    /// [`SparseError::NonFinite`] if an entry is NaN or infinite, [`SparseError::Singular`] if no diagonal entry is
    /// positive.
    pub(crate) fn new(structure: &Structure, matrix: &SymmetricMatrix) -> Result<Self, SparseError> {
        if !matrix.values().iter().all(|v| v.is_finite()) {
            return Err(SparseError::NonFinite);
        }
        let diagonal = structure.diagonal(matrix.values());
        let largest = diagonal.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return Err(SparseError::Singular { dofs: (0..diagonal.len()).collect() });
        }
        Ok(Self { diagonal, threshold: VANISHING_TO_LARGEST_DIAGONAL * largest })
    }

    /// Value that replaces smaller pivots so that the factorization can proceed; it is itself below the threshold.
    pub(crate) fn replacement(&self) -> f64 {
        0.5 * self.threshold
    }

    /// Assesses pivots, which are in the order of elimination.
    pub(crate) fn assess(&self, structure: &Structure, pivots: &[f64]) -> PivotReport {
        let (mut undetermined, mut smallest) = (Vec::new(), f64::MAX);
        let dofs = (0..structure.order.len() as u32).flat_map(|node| structure.dofs(node));
        for (dof, &pivot) in dofs.zip(pivots) {
            let relative = pivot / self.diagonal[dof];
            smallest = smallest.min(relative);
            if !(relative > VANISHING_TO_OWN_DIAGONAL && pivot > self.threshold) {
                undetermined.push(dof);
            }
        }
        undetermined.sort_unstable();
        PivotReport { undetermined, well_conditioned: smallest > WELL_CONDITIONED }
    }
}
