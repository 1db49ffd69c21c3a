//! From a pixel back to a plane of the world.

use crate::Camera;
use crate::newton::{Jacobian2, Root, Verdict, solve};

const TOLERANCE_PX: f64 = 1e-11;
/// Residual accepted if rounding keeps the iteration above [`TOLERANCE_PX`], relative to the image coordinates.
const ROUNDING: f64 = 1e-13;

/// World point of the plane `Z = z` that `camera` sees at `pixel`, by Newton's method on `x - P(X) = 0`
/// (paper, Sect. 5.2); `None` if the iteration does not converge or ends beyond a fold of the lens model.
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

/// The point of [`unproject`] and the derivatives of its `(X, Y)` with respect to the pixel: row 0 is
/// `(dX/du, dX/dv)`. `None` also if the derivatives do not exist because the plane is seen edge-on.
pub fn unproject_with_jacobian<C: Camera + ?Sized>(
    camera: &C,
    pixel: [f64; 2],
    z: f64,
) -> Option<([f64; 3], [[f64; 2]; 2])> {
    newton(camera, pixel, z).filter(|(_, inverse)| inverse.iter().flatten().all(|c| c.is_finite()))
}

/// World points `[X, Y]` of the plane `Z = z` seen at `samples` by `samples` points spread evenly over the square aperture
/// of a pixel, row by row; `None` if [`unproject_with_jacobian`] finds none for its centre.
///
/// The centre is unprojected and the other points follow from the derivatives there: exact for a camera whose Jacobian is
/// constant on the plane; for others, the error is of second order in the size of the pixel.
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

/// The point seen at a pixel and the inverse of the Jacobian of the projection on the plane.
fn newton<C: Camera + ?Sized>(camera: &C, pixel: [f64; 2], z: f64) -> Option<([f64; 3], Jacobian2)> {
    let [x, y, z] = camera.unproject_linear(pixel, z);
    let map = |[x, y]: [f64; 2]| {
        let (image, j) = camera.project_with_jacobian([x, y, z]);
        (image, [[j[0][0], j[0][1]], [j[1][0], j[1][1]]])
    };
    let rounding = TOLERANCE_PX.max(ROUNDING * pixel[0].abs().max(pixel[1].abs()).max(1e3));
    let mut smallest = f64::INFINITY;
    let judge = |error: f64| {
        let stalled = error >= smallest;
        smallest = error.min(smallest);
        match error {
            _ if !error.is_finite() => Verdict::Fail,
            _ if error <= TOLERANCE_PX || (stalled && error <= rounding) => Verdict::Accept,
            _ => Verdict::Iterate,
        }
    };
    let Root { point: [x, y], inverse } = solve(pixel, [x, y], map, judge)?;
    (!camera.is_beyond_fold([x, y, z])).then_some(([x, y, z], inverse))
}
