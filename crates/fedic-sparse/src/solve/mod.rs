//! Solution of systems with a factor: forward and backward substitution. Imports the numeric factorization.

mod factor;
mod supernode;
mod triangular_solve;

pub use factor::Factor;
pub(crate) use factor::Values;
