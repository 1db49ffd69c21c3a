//! Analytic Jacobians against differences, and the methods for many points against those for one.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::sync::Arc;

use common::{any_front_parallel, any_lens, any_pinhole, any_point};
use fedic_camera::{Camera, ImageFrame, Scaled};
use proptest::prelude::*;

/// Differences of a smooth function, and of one made of pieces: at the border of a spline's domain its second derivative jumps.
const SMOOTH: (f64, f64) = (1e-3, 3e-10);
const IN_PIECES: (f64, f64) = (1e-6, 1e-5);

/// Derivative of `f` at 0 by central differences of fourth order.
fn derivative(step: f64, f: impl Fn(f64) -> [f64; 2]) -> [f64; 2] {
    let [far_back, back, forward, far] = [-2.0, -1.0, 1.0, 2.0].map(|k| f(k * step));
    [0, 1].map(|r| (8.0 * (forward[r] - back[r]) - (far[r] - far_back[r])) / (12.0 * step))
}

fn check_jacobian(camera: &dyn Camera, point: [f64; 3]) -> Result<(), TestCaseError> {
    let (pixel, jacobian) = camera.project_with_jacobian(point);
    prop_assert_eq!(pixel, camera.project(point));
    let largest = jacobian.iter().flatten().fold(0.0_f64, |m, j| m.max(j.abs()));
    let (step, tolerance) = if camera.is_in_pieces() { IN_PIECES } else { SMOOTH };
    for axis in 0..3 {
        let numeric = derivative(step, |step| {
            let mut moved = point;
            moved[axis] += step;
            camera.project(moved)
        });
        for row in 0..2 {
            let error = (jacobian[row][axis] - numeric[row]).abs() / largest;
            prop_assert!(error < tolerance, "row {}, axis {}: {:e}", row, axis, error);
        }
    }
    if let Some(constant) = camera.constant_jacobian() {
        prop_assert_eq!(constant, jacobian);
    }
    Ok(())
}

/// The same bits from the batch as from the points.
fn check_batch(camera: &dyn Camera, points: &[[f64; 3]]) -> Result<(), TestCaseError> {
    let n = points.len();
    let [x, y, z]: [Vec<f64>; 3] = [0, 1, 2].map(|d| points.iter().map(|p| p[d]).collect());
    let (mut u, mut v) = (vec![0.0; n], vec![0.0; n]);
    camera.project_batch(&x, &y, &z, &mut u, &mut v);
    let (mut uj, mut vj) = (vec![0.0; n], vec![0.0; n]);
    let mut entries: [[Vec<f64>; 3]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; n]));
    let mut slices = entries.each_mut().map(|row| row.each_mut().map(Vec::as_mut_slice));
    camera.project_with_jacobian_batch(&x, &y, &z, &mut uj, &mut vj, &mut slices);
    for (k, &point) in points.iter().enumerate() {
        let pixel = camera.project(point).map(f64::to_bits);
        prop_assert_eq!([u[k], v[k]].map(f64::to_bits), pixel);
        let (pixel, jacobian) = camera.project_with_jacobian(point);
        prop_assert_eq!([uj[k], vj[k]].map(f64::to_bits), pixel.map(f64::to_bits));
        for (row, exact) in entries.iter().zip(jacobian) {
            for (entry, exact) in row.iter().zip(exact) {
                prop_assert_eq!(entry[k].to_bits(), exact.to_bits());
            }
        }
    }
    Ok(())
}

fn many_points() -> impl Strategy<Value = Vec<[f64; 3]>> {
    proptest::collection::vec(any_point(), 0..20)
}

proptest! {
    #[test]
    fn the_pinhole_jacobian_is_the_derivative(camera in any_pinhole(), point in any_point()) {
        check_jacobian(&camera, point)?;
        prop_assert_eq!(camera.constant_jacobian(), None);
    }

    #[test]
    fn the_jacobian_of_flat_cameras_is_the_derivative(camera in any_front_parallel(), point in any_point()) {
        prop_assert!(camera.constant_jacobian().is_some() && ImageFrame.constant_jacobian().is_some());
        check_jacobian(&camera, point)?;
        check_jacobian(&ImageFrame, point)?;
    }

    #[test]
    fn a_scaled_camera_scales_pixels_and_derivatives(
        pinhole in any_pinhole(),
        flat in any_front_parallel(),
        point in any_point(),
        factor in 0.01..4.0,
    ) {
        let cameras: [Arc<dyn Camera>; 3] = [Arc::new(pinhole), Arc::new(flat), Arc::new(ImageFrame)];
        for camera in cameras {
            let scaled = Scaled::new(Arc::clone(&camera), factor);
            check_jacobian(&scaled, point)?;
            check_batch(&scaled, &[point; 3])?;
            prop_assert_eq!(scaled.project(point), camera.project(point).map(|c| c * factor));
            prop_assert_eq!(scaled.constant_jacobian().is_some(), camera.constant_jacobian().is_some());
        }
    }

    #[test]
    fn the_lens_jacobian_is_the_derivative(lens in any_lens(), point in [-0.7..0.7, -0.7..0.7]) {
        let jacobian = lens.jacobian(point);
        for axis in 0..2 {
            let numeric = derivative(SMOOTH.0, |step| {
                let mut moved = point;
                moved[axis] += step;
                lens.distort(moved)
            });
            for row in 0..2 {
                let error = (jacobian[row][axis] - numeric[row]).abs();
                prop_assert!(error < 3e-11, "row {}, axis {}: {:e}", row, axis, error);
            }
        }
    }

    #[test]
    fn a_batch_gives_the_same_bits_as_its_points(
        pinhole in any_pinhole(),
        flat in any_front_parallel(),
        points in many_points(),
    ) {
        check_batch(&pinhole, &points)?;
        check_batch(&flat, &points)?;
        check_batch(&ImageFrame, &points)?;
    }
}
