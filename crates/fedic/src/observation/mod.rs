//! One camera and its reference image, sampled at the quadrature points.
//!
//! An observation knows no solver: it takes part in the normal equations through an image term.
//!
//! May import: options, error, quadrature, kernels, projection, interpolation.

pub(crate) mod cell_context;
pub(crate) mod deformed_pass;
pub(crate) mod image_source;
pub(crate) mod material_filter;
pub(crate) mod observe;
pub(crate) mod photometry;
pub(crate) mod pixel_mask;
pub(crate) mod quantized_gradient;
pub(crate) mod reference_pass;
pub(crate) mod reference_samples;
pub(crate) mod used_points;
pub(crate) mod weights;
pub(crate) mod workspace;
