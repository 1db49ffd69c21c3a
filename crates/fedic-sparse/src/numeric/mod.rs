//! Numeric factorization: multifrontal Cholesky with faer's dense kernels. Imports the symbolic factorization.

mod factorize;
mod front;
mod multifrontal;
mod packed;
mod pivots;
mod tiles;

pub(crate) use factorize::{Factorized, factorize};
pub(crate) use packed::{PackedColumns, StoredFloat};
pub(crate) use pivots::PivotCheck;
pub(crate) use tiles::{TILE, TILED_WORK, for_each_tile, subtract_products};
