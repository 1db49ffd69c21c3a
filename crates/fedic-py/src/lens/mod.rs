//! Lenses: a base class with the methods of all models, and a class for each model.

mod coefficients;
mod distortion;
mod registry;
mod spline;

pub(crate) use distortion::{Distortion, any_lens};
pub(crate) use registry::{LensModel, lens_object, register};
pub(crate) use spline::spline_basis;
