//! Options of the specimen calibration.

use fedic_image::Interpolation;

use crate::options::{DENSITY, MAX_ITERATIONS, NOISE, NUM_THREADS, SMOOTHING, TOLERANCE, declare_options};
use crate::self_calibration::motion::MotionKind;

declare_options! {
    /// Options of [`calibrate_on_specimen`](crate::calibrate_on_specimen).
    pub struct SelfCalibrationOptions {
        /// Motions that the specimen may have made: `translation`, along X and Y; `in-plane`, also about Z; or `spatial`, any.
        motion: MotionKind = MotionKind::default();
        /// Whether the given translations are exact. They are then kept, and determine the scale; otherwise they are the start.
        known_translations: bool = false;
        /// Quadrature points per pixel of the reference image.
        density: f64 = 1.0, in DENSITY;
        /// Interpolation of the images between pixels.
        interpolation: Interpolation = Interpolation::default();
        /// Standard deviation, in pixels, of a Gaussian smoothing of the images; 0 for none.
        smoothing: f64 = 0.8, in SMOOTHING;
        /// Whether a gain and an offset of each image are unknown too.
        gain_and_offset: bool = true;
        /// Standard deviation of the noise of one image as recorded, in grey levels; estimated from the residual by default.
        noise: Option<f64> = None, in NOISE;
        /// The iterations stop when the root mean square of the motion in the images caused by a correction is below this, in
        /// pixels.
        tolerance: f64 = 1e-5, in TOLERANCE;
        /// Largest number of iterations on the images at full resolution.
        max_iterations: usize = 50, in MAX_ITERATIONS;
        /// Number of threads; all processors by default. The result does not depend on it.
        num_threads: Option<usize> = None, in NUM_THREADS;
    }
}
