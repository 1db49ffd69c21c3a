//! Synthetic images of textured surfaces with known displacement.
//!
//! A [`Speckle`] is a continuous texture; [`Render`] computes its mean over each pixel of an image, for a [`Plane`] seen
//! through any [`Camera`](fedic_camera::Camera), at rest or displaced; [`Sensor`] turns these means into grey levels.
//! Results do not depend on the number of threads.
//!
//! # Examples
//!
//! Two images of a plane that is tilted towards the camera, before and after a rigid motion in space:
//!
//! ```
//! use fedic_camera::{Pinhole, rotation_from_vector};
//! use fedic_synthetic::{Plane, Render, RigidMotion, Sensor, Speckle, SyntheticError};
//!
//! let facing = rotation_from_vector([std::f64::consts::PI, 0.0, 0.0]);
//! let camera = Pinhole::new([800.0; 2], [49.5, 39.5], facing, [0.0, 0.0, 400.0]).unwrap();
//! let plane = Plane::new([0.0; 3], [[0.9, 0.0, 0.3], [0.0, 1.0, 0.0]])?;
//! let motion = RigidMotion::new([0.0, 0.02, 0.0], [0.0; 3], [0.1, -0.2, 0.3])?;
//! let (speckle, render, sensor) = (Speckle::new(2.0, 0.5, 1)?, Render::new(&camera, [100, 80]), Sensor::default());
//! let reference = sensor.expose(&render.plane(&plane, &speckle)?)?;
//! let deformed = sensor.expose(&render.plane(&plane.moved(&motion), &speckle)?)?;
//! assert_ne!(reference, deformed);
//! # Ok::<(), SyntheticError>(())
//! ```

mod displacement;
mod error;
mod motion;
mod plane;
mod random;
mod render;
mod rendering;
mod sensor;
mod speckle;
mod texture;
mod vector;

pub use displacement::DisplacementField;
pub use error::SyntheticError;
pub use motion::RigidMotion;
pub use plane::Plane;
pub use render::Render;
pub use rendering::Rendering;
pub use sensor::Sensor;
pub use speckle::Speckle;
pub use texture::Texture;
