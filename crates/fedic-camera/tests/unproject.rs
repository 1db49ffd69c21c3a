//! Unprojection: derivatives, apertures, and pixels that see no point of the plane.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::f64::consts::PI;
use std::sync::Arc;

use common::{any_pinhole, any_undistorted_pinhole};
use fedic_camera::{
    BrownDistortion, Camera, Pinhole, Scaled, rotation_from_vector, unproject, unproject_aperture,
    unproject_with_jacobian,
};
use proptest::prelude::*;

proptest! {
    #[test]
    fn unprojecting_without_distortion_is_exact(
        camera in any_undistorted_pinhole(),
        x in -0.4..0.4,
        y in -0.4..0.4,
        z in -0.3..0.3,
    ) {
        let found = camera.unproject_linear(camera.project([x, y, z]), z);
        prop_assert!((found[0] - x).abs() < 1e-12 && (found[1] - y).abs() < 1e-12 && found[2] == z, "{:?}", found);
    }
}

proptest! {
    #[test]
    fn the_jacobian_of_unprojection_is_its_derivative(
        camera in any_pinhole(),
        x in -0.4..0.4,
        y in -0.4..0.4,
        z in -0.3..0.3,
    ) {
        let pixel = camera.project([x, y, z]);
        let (point, jacobian) = unproject_with_jacobian(&camera, pixel, z).unwrap();
        prop_assert_eq!(Some(point), unproject(&camera, pixel, z));
        let step = 0.01;
        for (axis, [du, dv]) in [[step, 0.0], [0.0, step]].into_iter().enumerate() {
            let after = unproject(&camera, [pixel[0] + du, pixel[1] + dv], z).unwrap();
            let before = unproject(&camera, [pixel[0] - du, pixel[1] - dv], z).unwrap();
            for d in 0..2 {
                let slope = (after[d] - before[d]) / (2.0 * step);
                prop_assert!((jacobian[d][axis] - slope).abs() < 1e-9, "{} instead of {}", jacobian[d][axis], slope);
            }
        }
    }

    #[test]
    fn aperture_points_project_to_the_samples_of_the_pixel(
        camera in any_pinhole(),
        x in -0.4..0.4,
        y in -0.4..0.4,
        z in -0.3..0.3,
        samples in 1_u32..5,
    ) {
        let pixel = camera.project([x, y, z]);
        let points: Vec<[f64; 2]> = unproject_aperture(&camera, pixel, z, samples).unwrap().collect();
        prop_assert_eq!(points.len(), (samples * samples) as usize);
        let offset = |k: usize| (k as f64 + 0.5) / f64::from(samples) - 0.5;
        for (k, &[x, y]) in points.iter().enumerate() {
            let (column, row) = (k % samples as usize, k / samples as usize);
            let [u, v] = camera.project([x, y, z]);
            let error = (u - pixel[0] - offset(column)).abs().max((v - pixel[1] - offset(row)).abs());
            prop_assert!(error < 1e-2, "sample {} is seen {:e} pixels away", k, error);
        }
    }
}

fn camera(rotation: [f64; 3], depth: f64) -> Pinhole {
    Pinhole::new([1000.0; 2], [500.0; 2], rotation_from_vector(rotation), [0.0, 0.0, depth]).unwrap()
}

#[test]
fn rays_parallel_to_the_plane_see_no_point() {
    // The camera looks along Y, its rows parallel to the plane.
    let rotation = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
    let along = Pinhole::new([1000.0; 2], [500.0; 2], rotation, [0.0, 0.0, 2.0]).unwrap();
    assert_eq!(unproject(&along, [500.0, 500.0], 0.5), None);
    assert_eq!(unproject(&along, [100.0, 500.0], -0.5), None);
    assert!(unproject(&along, [100.0, 600.0], -0.5).is_some());
    assert_eq!(unproject(&along, [100.0, 400.0], -0.5), None);
    assert!(unproject_aperture(&along, [100.0, 500.0], -0.5, 3).is_none());
}

#[test]
fn a_plane_behind_the_camera_is_not_visible() {
    let upright = camera([PI, 0.0, 0.0], 2.0);
    assert!(unproject(&upright, [510.0, 480.0], 1.9).is_some());
    assert_eq!(unproject(&upright, [510.0, 480.0], 2.1), None);
    assert_eq!(unproject(&upright, [f64::NAN, 480.0], 0.0), None);
    assert_eq!(unproject(&upright, [f64::INFINITY, 480.0], 0.0), None);
}

#[test]
fn pixels_beyond_the_fold_see_no_point() {
    // r - r^3 grows up to 0.385 at r = 0.577 and falls from there on: beyond 385 pixels from the centre nothing is seen.
    let lens = BrownDistortion::new([-1.0, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap();
    let folded = camera([0.0; 3], 2.0).with_distortion(lens);
    for offset in [390.0, 400.0, 450.0, 499.0, 600.0, 800.0] {
        for (du, dv) in [(1.0, 0.0), (0.6, 0.8), (0.0, -1.0)] {
            let pixel = [500.0 + offset * du, 500.0 + offset * dv];
            assert_eq!(unproject(&folded, pixel, 0.0), None, "{pixel:?}");
            let half = Scaled::new(Arc::new(folded.clone()), 0.5);
            assert_eq!(unproject(&half, pixel.map(|c| 0.5 * c), 0.0), None, "{pixel:?} of the reduced image");
        }
    }
    for offset in [0.0, 100.0, 300.0, 380.0] {
        let point = unproject(&folded, [500.0 + offset, 500.0], 0.0).unwrap();
        assert!((0.0..2.0 * 0.578).contains(&point[0]), "{offset}: {point:?}");
    }
}
