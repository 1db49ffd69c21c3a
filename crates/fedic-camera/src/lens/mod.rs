//! Lens distortion in normalised image coordinates, between canonical projection and intrinsic matrix (paper, Fig. 11-13).
//!
//! [`Lens`] is the trait of the models in `models/`, each in one file, and [`Distortion`] is a lens of any model. The list
//! of the models is [`for_each_lens!`](crate::for_each_lens) in `models/mod.rs`.

mod approximation;
mod coefficients;
mod distortion;
mod domain;
mod fold;
mod model;
mod models;
mod spline_field;

pub use coefficients::CoefficientGroup;
pub use distortion::{Distortion, LensVisitor, ModelSummary};
pub use domain::{Domain, Plane};
pub use model::Lens;
pub use models::*;
pub use spline_field::SplineField;
