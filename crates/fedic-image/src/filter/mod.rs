//! Separable filters with mirrored borders. They know views and images, but no interpolation.

pub(crate) mod bands;
pub(crate) mod gaussian;
pub(crate) mod gradient;
pub(crate) mod line;
pub(crate) mod mirror;
pub(crate) mod prefilter;
pub(crate) mod pyramid;
mod rows;
