//! Cameras.

mod any_camera;
mod front_parallel;
mod image_frame;
mod methods;
mod parameters;
mod pinhole;
mod projection;
mod resizing;

pub(crate) use any_camera::any_camera;
pub(crate) use front_parallel::FrontParallel;
pub(crate) use image_frame::ImageFrame;
pub(crate) use pinhole::Pinhole;
