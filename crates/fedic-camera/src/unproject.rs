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
    newton(camera, pixel, z).map(|(point, _)| point)
}

/// The point of [`unproject`] and the derivatives of its `(X, Y)` by the pixel: row 0 is `(dX/du, dX/dv)`; `None` also
/// where these do not exist because the plane is seen edge-on.
pub fn unproject_with_jacobian<C: Camera + ?Sized>(
    camera: &C,
    pixel: [f64; 2],
    z: f64,
) -> Option<([f64; 3], [[f64; 2]; 2])> {
    let (point, j) = newton(camera, pixel, z)?;
    let det = j[0][0] * j[1][1] - j[0][1] * j[1][0];
    let inverse = [[j[1][1] / det, -j[0][1] / det], [-j[1][0] / det, j[0][0] / det]];
    inverse.iter().flatten().all(|c| c.is_finite()).then_some((point, inverse))
}

/// World points `[X, Y]` of the plane `Z = z` seen at `samples` by `samples` points spread evenly over the square aperture
/// of a pixel, row by row; `None` where [`unproject_with_jacobian`] finds none for its centre.
///
/// The centre is unprojected and the others follow from the derivatives there: exact for a camera whose Jacobian is
/// constant on the plane, for others an error of the second order in the size of the pixel.
///
/// # Examples
///
/// ```
/// use fedic_camera::{FrontParallel, unproject_aperture};
/// let camera = FrontParallel::new(4.0, [100.0, 200.0])?;
/// let points = unproject_aperture(&camera, [100.0, 200.0], 0.0, 2).map(Iterator::collect::<Vec<_>>);
/// let d = 0.25 / 4.0;
/// assert_eq!(points, Some(vec![[-d, d], [d, d], [-d, -d], [d, -d]]));
/// # Ok::<(), fedic_camera::CameraError>(())
/// ```
pub fn unproject_aperture<C: Camera + ?Sized>(
    camera: &C,
    pixel: [f64; 2],
    z: f64,
    samples: u32,
) -> Option<impl Iterator<Item = [f64; 2]>> {
    let ([x, y, _], [[xu, xv], [yu, yv]]) = unproject_with_jacobian(camera, pixel, z)?;
    let spacing = 1.0 / f64::from(samples);
    let offset = move |k: u32| (f64::from(k) - 0.5 * (f64::from(samples) - 1.0)) * spacing;
    let row = move |dv: f64| (0..samples).map(offset).map(move |du| [x + xu * du + xv * dv, y + yu * du + yv * dv]);
    Some((0..samples).map(offset).flat_map(row))
}

/// The point seen at a pixel and the Jacobian of the projection there.
fn newton<C: Camera + ?Sized>(camera: &C, pixel: [f64; 2], z: f64) -> Option<([f64; 3], [[f64; 3]; 2])> {
    iterate(camera, pixel, z).filter(|&(point, _)| !camera.is_beyond_fold(point))
}

fn iterate<C: Camera + ?Sized>(camera: &C, pixel: [f64; 2], z: f64) -> Option<([f64; 3], [[f64; 3]; 2])> {
    let mut point = camera.unproject_linear(pixel, z);
    let mut best = f64::INFINITY;
    for _ in 0..MAX_NEWTON {
        let (seen, j) = camera.project_with_jacobian(point);
        let r = [pixel[0] - seen[0], pixel[1] - seen[1]];
        let error = r[0].abs().max(r[1].abs());
        if error <= TOLERANCE_PX {
            return Some((point, j));
        }
        let stalled = error >= best;
        if !error.is_finite() || (stalled && error <= rounding(pixel)) {
            return error.is_finite().then_some((point, j));
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
