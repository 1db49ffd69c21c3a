//! Calibration of the camera on the specimen itself: the camera's parameters and rigid motions from the grey levels.
//!
//! Start at `calibrate.rs`, which states the problem; `solve.rs` runs the stages, `image_stack.rs` samples the images.
//!
//! May import: options, error, quadrature, projection, interpolation, observation, results.

pub(crate) mod calibrate;
pub(crate) mod image_stack;
pub(crate) mod layout;
pub(crate) mod levenberg_marquardt;
pub(crate) mod motion;
pub(crate) mod normal_equations;
pub(crate) mod options;
pub(crate) mod point_rows;
pub(crate) mod problem;
pub(crate) mod result;
pub(crate) mod solve;
pub(crate) mod specimen_images;
pub(crate) mod statistics;
#[cfg(test)]
mod tests;
