//! Options of the correlation and of the specimen calibration, each declared once.
//!
//! A declaration gives the field, its type, default, range and documentation. The struct, its checks, its builder
//! methods and the table of [`OptionInfo`], from which bindings and documents are made, follow from it.
//!
//! May import: nothing of the other folders.

mod choice;
mod correlation;
mod declare;
mod elasticity;
mod equilibrium_gap;
mod error;
mod info;
mod range;
mod value;

pub(crate) use choice::choices;
pub use correlation::{Brightness, Gradient, Hessian, Options, Quadrature, Robust};
pub(crate) use declare::{declare_options, range};
pub use elasticity::PlaneStress;
pub use equilibrium_gap::EquilibriumGap;
pub use error::OptionError;
pub use info::OptionInfo;
pub(crate) use info::{describe, read};
pub use range::Range;
pub(crate) use range::{DENSITY, MAX_ITERATIONS, NOISE, NUM_THREADS, SMOOTHING, TOLERANCE};
pub(crate) use value::choice_option;
pub use value::{OptionKind, OptionType, OptionValue};
