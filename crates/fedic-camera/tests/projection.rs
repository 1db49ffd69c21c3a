//! Projections against the formulas of the paper written with matrices.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{any_brown, any_point, any_undistorted_pinhole};
use fedic_camera::{BrownDistortion, Camera, FrontParallel, ImageFrame, Pinhole, rotation_from_vector};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use proptest::prelude::*;

fn matrix(rows: [[f64; 3]; 3]) -> Matrix3<f64> {
    Matrix3::from_fn(|r, c| rows[r][c])
}

proptest! {
    #[test]
    fn a_pinhole_is_the_product_of_its_matrices(camera in any_undistorted_pinhole(), lens in any_brown(), point in any_point()) {
        let ([fx, fy], [cx, cy], skew) = (camera.focal(), camera.principal_point(), camera.skew_angle());
        let intrinsic = Matrix3::new(fx, fx / skew.tan(), cx, 0.0, fy / skew.sin(), cy, 0.0, 0.0, 1.0);
        let seen = matrix(camera.rotation()) * Vector3::from(point) + Vector3::from(camera.translation());
        let (x, y) = (seen.x / seen.z, seen.y / seen.z);

        let pixel = intrinsic * Vector3::new(x, y, 1.0);
        let [u, v] = camera.project(point);
        prop_assert!((u - pixel.x).abs() < 1e-10 && (v - pixel.y).abs() < 1e-10, "{u} {v} {pixel}");

        // Equations 27 to 30, the second row of 29 as Brown and Conrady have it.
        let ([k1, k2, k3], [d1, d2], [p1, p2]) = (lens.radial(), lens.decentering(), lens.prism());
        let r2 = x * x + y * y;
        let radial = k1 * r2 + k2 * r2.powi(2) + k3 * r2.powi(3);
        let distorted = Vector3::new(
            x + x * radial + 2.0 * d1 * x * y + d2 * (r2 + 2.0 * x * x) + p1 * r2,
            y + y * radial + d1 * (r2 + 2.0 * y * y) + 2.0 * d2 * x * y + p2 * r2,
            1.0,
        );
        let pixel = intrinsic * distorted;
        let [u, v] = camera.with_distortion(lens).project(point);
        prop_assert!((u - pixel.x).abs() < 1e-10 && (v - pixel.y).abs() < 1e-10, "{u} {v} {pixel}");
    }

    #[test]
    fn a_rotation_vector_turns_about_itself_by_its_length(axis in [-1.0..1.0_f64, -1.0..1.0, -1.0..1.0], angle in 0.0..3.1_f64) {
        let axis: Vector3<f64> = Vector3::from(axis);
        prop_assume!(axis.norm() > 1e-3);
        let axis = Unit::new_normalize(axis);
        let found = matrix(rotation_from_vector((axis.into_inner() * angle).into()));
        // Rodrigues: I + sin(a) K + (1 - cos(a)) K^2.
        let cross = axis.cross_matrix();
        let rodrigues = Matrix3::identity() + cross * f64::sin(angle) + cross * cross * (1.0 - f64::cos(angle));
        prop_assert!((found - rodrigues).amax() < 1e-14, "{}", found - rodrigues);
        let theirs = Rotation3::from_axis_angle(&axis, angle).into_inner();
        prop_assert!((found - theirs).amax() < 1e-14);
    }
}

#[test]
fn the_zero_vector_does_not_rotate() {
    assert_eq!(rotation_from_vector([0.0; 3]), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let tiny = rotation_from_vector([0.0, 0.0, 1e-300]);
    assert!(tiny.iter().flatten().all(|c| c.is_finite()));
}

#[test]
fn u_points_right_and_v_points_down() {
    assert_eq!(ImageFrame.project([3.0, 4.0, 9.0]), [3.0, 4.0]);
    let camera = FrontParallel::new(10.0, [100.0, 200.0]).unwrap();
    assert_eq!(camera.project([1.0, 2.0, 9.0]), [110.0, 180.0]);
    assert_eq!((camera.scale(), camera.origin()), (10.0, [100.0, 200.0]));
}

proptest! {
    #[test]
    fn a_rotated_front_parallel_view_is_a_pinhole_parallel_to_the_plane(
        scale in 1.0..1000.0_f64,
        origin in [-500.0..1500.0, -500.0..1500.0],
        angle in -4.0..4.0_f64,
        point in any_point(),
    ) {
        let camera = FrontParallel::new(scale, origin).unwrap().with_angle(angle).unwrap();
        prop_assert_eq!(camera.angle(), angle);
        // X to the right, Y upwards, Z towards the camera, turned about Z first; focal length over distance is the scale.
        let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), angle).into_inner();
        let rotation = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)) * turn;
        let rows = std::array::from_fn(|r| std::array::from_fn(|c| rotation[(r, c)]));
        let pinhole = Pinhole::new([2.0 * scale; 2], origin, rows, [0.0, 0.0, 2.0]).unwrap();
        let flat = [point[0], point[1], 0.0];
        let ([u, v], [a, b]) = (camera.project(flat), pinhole.project(flat));
        prop_assert!((u - a).abs() < 1e-10 && (v - b).abs() < 1e-10, "{u} {v} {a} {b}");
    }

    #[test]
    fn a_view_without_an_angle_is_equation_18(
        scale in 1.0..1000.0_f64,
        [u0, v0] in [-500.0..1500.0, -500.0..1500.0],
        [x, y, z] in any_point(),
    ) {
        let camera = FrontParallel::new(scale, [u0, v0]).unwrap();
        prop_assert_eq!(camera.project([x, y, z]), [u0 + scale * x, v0 - scale * y]);
        prop_assert_eq!(camera.constant_jacobian(), Some([[scale, 0.0, 0.0], [0.0, -scale, 0.0]]));
        prop_assert_eq!(camera.with_angle(0.0).unwrap(), camera);
    }
}

#[test]
fn points_behind_the_camera_are_not_visible() {
    let lens = BrownDistortion::new([0.1, 0.0, 0.0], [0.01, 0.0], [0.0, 0.01]).unwrap();
    let upright = Pinhole::new([1000.0; 2], [500.0; 2], rotation_from_vector([0.0; 3]), [0.0, 0.0, 2.0]).unwrap();
    for camera in [upright.clone(), upright.with_distortion(lens)] {
        assert!(camera.project([0.1, 0.1, -1.9]).iter().all(|c| c.is_finite()));
        for z in [-2.0, -2.1, -1e9] {
            let (pixel, jacobian) = camera.project_with_jacobian([0.1, 0.1, z]);
            assert!(camera.project([0.1, 0.1, z]).iter().chain(&pixel).all(|c| c.is_nan()), "{z}");
            assert!(jacobian.iter().flatten().all(|c| c.is_nan()), "{z}: {jacobian:?}");
        }
        assert!(camera.project([f64::NAN, 0.0, 0.0])[0].is_nan());
    }
}
