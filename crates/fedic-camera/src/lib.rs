//! Cameras: projections from physical space to an image, with analytic Jacobians.
//!
//! World points are `[X, Y, Z]` in the unit of the mesh. Image points are `[u, v]` in pixels, `u` to the right and `v`
//! downwards, with the origin at the centre of the top-left pixel.
//!
//! * [`Camera`]: the trait of all cameras; `models/` holds the implementations.
//! * [`lens`]: lens distortion; one file per lens model and one list of them.
//! * [`Parametric`]: derivatives with respect to the parameters of a camera.
//! * [`Resizable`]: the size of the images of a camera, cameras of regions and of binned images.
//! * [`unproject`]: from a pixel back to a plane of the world.

mod batch;
mod camera;
mod error;
pub mod lens;
mod models;
mod newton;
mod parameters;
mod resizable;
mod unprojection;

pub use camera::Camera;
pub use error::CameraError;
pub use lens::{BrownDistortion, Distortion, InverseSplineDistortion, Lens, SplineDistortion, SplineField};
pub use models::{FrontParallel, ImageFrame, Pinhole, Scaled, rotation_from_vector};
pub use parameters::{Parameter, Parametric};
pub use resizable::Resizable;
pub use unprojection::{unproject, unproject_aperture, unproject_with_jacobian};
