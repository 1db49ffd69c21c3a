//! Parameters of cameras: names, derivatives of the image point, and cameras with modified parameters.

mod front_parallel;
mod parameter;
mod parametric;
mod pinhole;

pub use parameter::Parameter;
pub use parametric::Parametric;
