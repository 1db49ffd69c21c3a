//! Positions of the samples within the pixels.

#![allow(clippy::unwrap_used)]

use std::sync::Mutex;

use fedic_camera::{BrownDistortion, Camera, FrontParallel, ImageFrame, Pinhole, rotation_from_vector};
use fedic_synthetic::{Plane, Render, Texture};

/// A texture that records the points it is evaluated at.
#[derive(Default)]
struct Recorder(Mutex<Vec<[f64; 2]>>);

impl Texture for Recorder {
    fn values(&self, points: &[[f64; 2]]) -> Vec<f64> {
        self.0.lock().unwrap().extend_from_slice(points);
        vec![0.0; points.len()]
    }
}

/// Largest distance in pixels between the samples of an image of `size` and the images of their points.
fn largest_error(camera: &dyn Camera, size: [usize; 2], samples: u32, z: f64) -> f64 {
    let recorder = Recorder::default();
    Render::new(camera, size).with_samples(samples).plane(&Plane::horizontal(z).unwrap(), &recorder).unwrap();
    let points = recorder.0.into_inner().unwrap();
    let samples = samples as usize;
    assert_eq!(points.len(), size[0] * size[1] * samples * samples);
    let error = |(index, &[x, y]): (usize, &[f64; 2])| {
        let (pixel, sample) = (index / (samples * samples), index % (samples * samples));
        let offset = |k: usize| (k as f64 + 0.5) / samples as f64 - 0.5;
        let expected =
            [(pixel % size[0]) as f64 + offset(sample % samples), (pixel / size[0]) as f64 + offset(sample / samples)];
        let found = camera.project([x, y, z]);
        (found[0] - expected[0]).abs().max((found[1] - expected[1]).abs())
    };
    points.iter().enumerate().map(error).fold(0.0, f64::max)
}

/// A camera 1630 units above the plane, whose optical axis is tilted.
fn pinhole(focal: f64, principal_point: [f64; 2], radial: f64, tilt: f64) -> Pinhole {
    let rotation = rotation_from_vector([std::f64::consts::PI + tilt, 0.0, 0.0]);
    let lens = BrownDistortion::new([radial, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap();
    Pinhole::new([focal; 2], principal_point, rotation, [0.0, 0.0, 1630.0]).unwrap().with_distortion(lens)
}

/// The corners of the image, where the distortion is largest, are in the first rows.
#[test]
fn samples_project_into_the_pixel_through_a_lens() {
    let long = pinhole(8381.24, [700.0, 500.0], -0.032_125_3, 0.0);
    assert!(largest_error(&long, [1388, 4], 3, 0.0) < 3e-7);
    let wide = pinhole(1400.0, [700.0, 500.0], -0.2, 0.0);
    assert!(largest_error(&wide, [1400, 4], 3, 0.0) < 1e-4);
    assert!(largest_error(&wide, [1400, 4], 1, 0.0) < 1e-10);
    let tilted = pinhole(1400.0, [700.0, 500.0], 0.0, 0.5);
    assert!(largest_error(&tilted, [1400, 4], 3, 0.0) < 1e-4);
}

#[test]
fn the_error_of_the_samples_is_of_second_order_in_the_size_of_the_pixel() {
    let [large, small] = [500.0, 2000.0]
        .map(|focal| largest_error(&pinhole(focal, [0.7 * focal, 0.5 * focal], -0.2, 0.0), [3, 1], 3, 0.0));
    // A quarter of the size; the errors are in pixels.
    assert!((large / small - 4.0).abs() < 0.2, "{large} {small}");
}

#[test]
fn samples_are_exact_for_cameras_with_a_constant_jacobian() {
    let front = FrontParallel::new(5.14, [3.0, 40.0]).unwrap();
    for camera in [&ImageFrame as &dyn Camera, &front] {
        assert!(largest_error(camera, [7, 9], 3, 0.5) < 1e-12);
    }
}
