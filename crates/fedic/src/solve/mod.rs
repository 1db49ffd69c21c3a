pub(crate) mod cell_subset;
pub(crate) mod gauss_newton;
pub(crate) mod pyramid;
pub(crate) mod smooth_start;
