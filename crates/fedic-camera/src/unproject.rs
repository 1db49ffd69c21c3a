//! From the image back to a plane of the world.

use crate::Camera;

const MAX_NEWTON: usize = 30;
const TOLERANCE_PX: f64 = 1e-11;
/// What is accepted when rounding keeps the iteration above [`TOLERANCE_PX`], relative to the image coordinates.
const ROUNDING: f64 = 1e-13;

/// World point of the plane `Z = z` that `camera` sees at `pixel`, by Newton's method on `x - P(X) = 0`
/// (paper, Sect. 5.2); `None` where it does not converge, or to a point beyond a fold of the lens model.
///
/// # Examples
///
/// ```
/// use fedic_camera::{Camera, FrontParallel, unproject};
/// let camera = FrontParallel::new(10.0, [100.0, 200.0])?;
/// assert_eq!(unproject(&camera, [110.0, 180.0], 0.5), Some([1.0, 2.0, 0.5]));
/// # Ok::<(), fedic_camera::CameraError>(())
/// ```
pub fn unproject<C: Camera + ?Sized>(camera: &C, pixel: [f64; 2], z: f64) -> Option<[f64; 3]> {
    newton(camera, pixel, z).filter(|&point| !camera.is_beyond_fold(point))
}

fn newton<C: Camera + ?Sized>(camera: &C, pixel: [f64; 2], z: f64) -> Option<[f64; 3]> {
    let mut point = camera.unproject_linear(pixel, z);
    let mut best = f64::INFINITY;
    for _ in 0..MAX_NEWTON {
        let (seen, j) = camera.project_with_jacobian(point);
        let r = [pixel[0] - seen[0], pixel[1] - seen[1]];
        let error = r[0].abs().max(r[1].abs());
        if error <= TOLERANCE_PX {
            return Some(point);
        }
        let stalled = error >= best;
        if !error.is_finite() || (stalled && error <= rounding(pixel)) {
            return error.is_finite().then_some(point);
        }
        best = error.min(best);
        let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
        point[0] += (j[1][1] * r[0] - j[0][1] * r[1]) / det;
        point[1] += (j[0][0] * r[1] - j[1][0] * r[0]) / det;
    }
    None
}

fn rounding(pixel: [f64; 2]) -> f64 {
    TOLERANCE_PX.max(ROUNDING * pixel[0].abs().max(pixel[1].abs()).max(1e3))
}
