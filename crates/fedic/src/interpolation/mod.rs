//! Images prepared for evaluation at the projected points.
//!
//! May import: options, projection.

pub(crate) mod cell_prefetch;
pub(crate) mod image_sampler;
