//! The cameras.

mod front_parallel;
mod image_frame;
mod pinhole;
mod scaled;

pub use front_parallel::FrontParallel;
pub use image_frame::ImageFrame;
pub use pinhole::{Pinhole, rotation_from_vector};
pub use scaled::Scaled;

use crate::CameraError;

/// Checks the scale of a camera and the image point of its origin; errors call the scale `parameter`.
fn check_scale(scale: f64, origin: [f64; 2], parameter: &'static str) -> Result<(), CameraError> {
    if !origin.iter().all(|c| c.is_finite()) {
        return Err(CameraError::NonFinite { parameter: "origin" });
    }
    if !scale.is_finite() {
        return Err(CameraError::NonFinite { parameter: "scale" });
    }
    if scale <= 0.0 { Err(CameraError::NotPositive { parameter, value: scale }) } else { Ok(()) }
}
