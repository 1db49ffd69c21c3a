//! The cameras.

mod front_parallel;
mod image_frame;
mod pinhole;
mod scaled;

pub use front_parallel::FrontParallel;
pub use image_frame::ImageFrame;
pub use pinhole::{Pinhole, rotation_from_vector};
pub use scaled::Scaled;
