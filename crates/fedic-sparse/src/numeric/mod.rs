//! Numeric factorization: multifrontal Cholesky with faer's dense kernels. Imports the symbolic factorization.

mod factorize;
mod front;
mod multifrontal;
mod packed;
mod pivots;

pub(crate) use factorize::{Factorized, factorize};
pub(crate) use packed::{PackedColumns, StoredFloat};
pub(crate) use pivots::PivotCheck;
