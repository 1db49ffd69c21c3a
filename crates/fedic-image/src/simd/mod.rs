//! Instruction sets: fused products, blocks of points, transposition.

pub(crate) mod lanes;
pub(crate) mod transpose;
