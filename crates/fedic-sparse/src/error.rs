//! Why a system could not be factorised.

use thiserror::Error;

/// A system that has no unique solution, or that does not fit in memory.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum SparseError {
    /// Some pivots vanish: these degrees of freedom are not determined.
    #[error("the system does not determine {} of its unknowns", dofs.len())]
    Singular {
        /// Undetermined degrees of freedom, increasing.
        dofs: Vec<usize>,
    },
    /// An entry of the matrix is not finite.
    #[error("the system matrix has an entry that is not finite")]
    NonFinite,
    /// The factorisation does not fit in memory or its size cannot be numbered.
    #[error("the factorisation of {dofs} unknowns needs more memory than there is")]
    TooLarge {
        /// Number of unknowns.
        dofs: usize,
    },
}
