//! Entries of the inverse on the pattern of the matrix (Takahashi, Fagan and Chen 1973; Erisman and Tinney 1975). Imports the numeric
//! factorization.
//!
//! From the roots of the elimination tree down. The supernode with columns `C` and rows `R` below has the columns `L_CC`, `L_RC` of the
//! factor, and `S = A^-1` satisfies, with `Y = L_RC L_CC^-1`,
//!
//! ```text
//! S_RC = -S_RR Y        S_CC = (L_CC L_CC^T)^-1 - Y^T S_RC
//! ```
//!
//! All of `R` is among the columns and rows of the parent, so that `S_RR` is part of the parent's dense front. This is the multifrontal
//! factorization in reverse: what a supernode takes from its parent has the size of the update matrix that it gave.

mod front;
mod selected;

pub(crate) use selected::selected_inverse;
