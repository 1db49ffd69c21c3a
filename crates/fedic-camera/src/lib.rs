//! Cameras: the projectors `P` that carry a point of the physical space into the image.
//!
//! World points are `[X, Y, Z]` in the mesh's unit; image points are `[u, v]` in pixels, `u` to the right, `v`
//! downwards, the centre of the top-left pixel at the origin. Every camera gives its analytic 2x3 Jacobian.

mod camera;
mod distortion;
mod error;
mod front_parallel;
mod image_frame;
mod parameters;
mod pinhole;
mod scaled;
mod unproject;

pub use camera::Camera;
pub use distortion::{BrownDistortion, Distortion, InverseSplineDistortion, SplineDistortion, SplineField};
pub use error::CameraError;
pub use front_parallel::FrontParallel;
pub use image_frame::ImageFrame;
pub use parameters::Parameter;
pub use pinhole::{Pinhole, rotation_from_vector};
pub use scaled::Scaled;
pub use unproject::{unproject, unproject_aperture, unproject_with_jacobian};
