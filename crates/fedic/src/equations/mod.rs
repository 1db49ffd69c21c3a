pub(crate) mod cell_matrix;
pub(crate) mod image_term;
pub(crate) mod parallel;
pub(crate) mod tikhonov;
pub(crate) mod unknowns;
