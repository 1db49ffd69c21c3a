//! Finite-element digital image correlation in the physical space.
//!
//! Two images of a speckled specimen, a finite element mesh and a calibrated camera `P` give the displacement `U` of the
//! mesh's nodes, in the mesh's own unit, that minimises
//!
//! ```text
//! integral over the mesh of [ f(P(X)) - g~(P(X + U(X))) ]^2 dX
//! ```
//!
//! where `g~` is the deformed image with its brightness and contrast brought to those of the reference image. The method
//! and the equation numbers cited in this documentation are those of J.-E. Pierré, J.-C. Passieux, J.-N. Périé, F. Bugarin
//! and L. Robert, *Unstructured finite element-based digital image correlation with enhanced management of quadrature and
//! lens distortions*.
//!
//! Data flow one way: mesh and images, quadrature, projection, interpolation, equations, solve, results. Start at [`Correlator`].
//!
//! # Examples
//!
//! ```
//! use std::sync::Arc;
//! use fedic::{CellType, Correlator, Image, ImageFrame, Options, Start, rectangle_mesh};
//!
//! // A texture, and the same moved by 0.4 pixels to the right.
//! let texture = |u: f32, v: f32| 120.0 + 50.0 * (0.8 * u + 0.1 * v).sin() + 40.0 * (0.7 * v - 0.2 * u).cos();
//! let image = |shift: f32| {
//!     let greys = (0..100 * 100).map(|i| texture((i % 100) as f32 - shift, (i / 100) as f32));
//!     Image::new(100, 100, greys.collect())
//! };
//! let (reference, deformed) = (image(0.0)?, image(0.4)?);
//!
//! let mesh = rectangle_mesh([20.0, 20.0, 80.0, 80.0], 20.0, CellType::Quad)?;
//! let correlator = Correlator::new(Arc::new(reference), &mesh, Arc::new(ImageFrame), Options::default())?;
//! let solution = correlator.correlate(deformed.view(), Start::Zero)?;
//! assert!(solution.converged);
//! assert!(solution.displacement.iter().all(|u| (u[0] - 0.4).abs() < 1e-2 && u[1].abs() < 1e-2));
//! # Ok::<(), fedic::Error>(())
//! ```

mod components;
mod correlator;
mod equations;
mod error;
mod interpolation;
mod kernels;
mod monitor;
mod observation;
mod options;
mod parallel;
mod projection;
mod quadrature;
mod results;
mod self_calibration;
mod solve;
mod threads;

pub use components::{PLANE, SPACE};
pub use correlator::{Correlator, Start};
pub use error::Error;
pub use error::self_calibration::SelfCalibrationError;
pub use error::solve::SolveError;
pub use fedic_camera::{
    BrownDistortion, Camera, CameraError, Distortion, FrontParallel, ImageFrame, InverseSplineDistortion, Lens,
    Parameter, Parametric, Pinhole, Resizable, Scaled, SplineDistortion, SplineField, for_each_lens, lens,
    rotation_from_vector, unproject, unproject_aperture, unproject_with_jacobian,
};
pub use fedic_image::{
    Image, ImageError, ImageView, Interpolation, Interpolator, Pixels, central_differences, downsample, gaussian_filter,
};
pub use fedic_mesh::{
    Cell, CellEdge, CellType, LineError, Locator, Mesh, MeshError, MeshSet, Rule, StrainAxes, StrainField,
    StrainMeasure, SurfaceGradients, SurfaceStrain, UnknownRule, UnknownStrainMeasure, cell_areas, interpolate_field,
    rectangle_mesh, shape_values, surface_gradients,
};
pub use fedic_sparse::SparseError;
pub use interpolation::image_sampler::ImageSampler;
pub use monitor::{Monitor, Progress, Stage};
pub use observation::image_source::ImageSource;
pub use options::{
    Brightness, EquilibriumGap, Gradient, Hessian, OptionError, OptionInfo, OptionKind, OptionType, OptionValue,
    Options, PlaneStress, Quadrature, Range, Robust,
};
pub use results::covariance::Covariance;
pub use results::flags::{CellFlag, NodeFlag};
pub use results::quality::{
    GRADIENT_TO_NOISE, MAX_DEVIATION, MAX_LIGHT, MIN_CORRELATION, NODE_ERROR, Quality, SIGNIFICANCE,
};
pub use results::solution::{Information, Iteration, Solution};
pub use self_calibration::calibrate::{calibrate_on_specimen, calibrate_on_specimen_with};
pub use self_calibration::motion::{MotionKind, RIGID};
pub use self_calibration::options::SelfCalibrationOptions;
pub use self_calibration::result::SelfCalibration;
pub use self_calibration::specimen_images::SpecimenImages;
pub use threads::ThreadPool;
