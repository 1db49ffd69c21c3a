//! Rendered pixels against the texture at the points that the camera sees there.

#![allow(clippy::unwrap_used)]

use fedic_camera::{BrownDistortion, Camera, FrontParallel, Pinhole, rotation_from_vector};
use fedic_synthetic::{Plane, Render, RigidMotion, Sensor, Speckle};
use rayon::ThreadPoolBuilder;

const SIZE: [usize; 2] = [60, 40];

/// A camera that sees the origin at the centre of the image, turned by `angle` about the vertical axis.
fn pinhole(angle: f64, radial: f64) -> Pinhole {
    let facing = rotation_from_vector([std::f64::consts::PI, 0.0, 0.0]);
    let turn = rotation_from_vector([0.0, angle, 0.0]);
    let rotation = turn.map(|row| [0, 1, 2].map(|c| (0..3).map(|k| row[k] * facing[k][c]).sum()));
    let lens = BrownDistortion::new([radial, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap();
    Pinhole::new([600.0; 2], [29.5, 19.5], rotation, [0.0, 0.0, 300.0]).unwrap().with_distortion(lens)
}

fn tilted() -> Plane {
    let axes = rotation_from_vector([0.2, -0.35, 0.4]);
    Plane::new([0.4, -0.3, 1.5], [0, 1].map(|c| axes.map(|row| row[c]))).unwrap()
}

/// A texture that tells the two coordinates of a point: rendered with one sample per pixel, it gives the material point.
fn coordinate(c: usize) -> impl Fn([f64; 2]) -> f64 + Sync {
    move |point: [f64; 2]| point[c]
}

/// Largest distance, in pixels, between a pixel's centre and the image of the material point rendered there, whose position
/// now is `position(plane coordinates)`.
fn largest_error(
    camera: &dyn Camera,
    render: impl Fn(&Render<'_>, &dyn fedic_synthetic::Texture) -> Vec<f64>,
    position: impl Fn([f64; 2]) -> [f64; 3],
) -> f64 {
    let single = Render::new(camera, SIZE).with_samples(1);
    let (a, b) = (render(&single, &coordinate(0)), render(&single, &coordinate(1)));
    let error = |index: usize| {
        let [u, v] = camera.project(position([a[index], b[index]]));
        (u - (index % SIZE[0]) as f64).hypot(v - (index / SIZE[0]) as f64)
    };
    (0..a.len()).map(error).fold(0.0, f64::max)
}

#[test]
fn pixels_show_the_points_of_a_tilted_plane_that_the_camera_sees_there() {
    let plane = tilted();
    let front = FrontParallel::new(2.0, [30.0, 20.0]).unwrap();
    let cameras: [&dyn Camera; 4] = [&pinhole(0.0, 0.0), &pinhole(0.35, -0.3), &pinhole(-1.2, 0.1), &front];
    for (index, camera) in cameras.into_iter().enumerate() {
        let error = largest_error(
            camera,
            |render, texture| render.plane(&plane, texture).unwrap().into_values(),
            |point| plane.point(point),
        );
        assert!(error < 1e-9, "camera {index}: {error}");
    }
}

/// The camera looks along `Y`: its rays lie in planes of constant `Z` in the middle row.
#[test]
fn a_camera_may_look_along_the_world_plane() {
    let rotation = [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]];
    let camera = Pinhole::new([600.0; 2], [29.5, 20.0], rotation, [0.0, 0.0, 300.0]).unwrap();
    let plane = Plane::new([0.0, 4.0, 0.0], [[1.0, 0.2, 0.0], [0.0, 0.1, 1.0]]).unwrap();
    let error = largest_error(
        &camera,
        |render, texture| render.plane(&plane, texture).unwrap().into_values(),
        |point| plane.point(point),
    );
    assert!(error < 1e-9, "{error}");
}

#[test]
fn material_points_follow_a_rigid_motion() {
    let (plane, camera) = (tilted(), pinhole(0.3, -0.2));
    let motion = RigidMotion::new([0.1, -0.5, 0.9], [1.0, 2.0, 3.0], [0.5, 0.25, -4.0]).unwrap();
    let error = largest_error(
        &camera,
        |render, texture| render.plane(&plane.moved(&motion), texture).unwrap().into_values(),
        |point| motion.apply(plane.point(point)),
    );
    assert!(error < 1e-9, "{error}");
}

/// In and out of the plane, of gradient up to 0.3.
fn waves([x, y, z]: [f64; 3]) -> [f64; 3] {
    [0.5 * (0.4 * y).sin() + 0.1, 0.4 * (0.5 * x + 0.1 * z).cos(), 2.0 + 0.6 * (0.5 * x + 0.2 * y).sin()]
}

#[test]
fn material_points_follow_a_displacement_in_space() {
    let plane = tilted();
    let front = FrontParallel::new(2.0, [30.0, 20.0]).unwrap();
    let cameras: [&dyn Camera; 3] = [&pinhole(0.0, -0.2), &pinhole(0.6, 0.1), &front];
    for (index, camera) in cameras.into_iter().enumerate() {
        let error = largest_error(
            camera,
            |render, texture| render.displaced_plane(&plane, texture, &waves).unwrap().into_values(),
            |point| {
                let (point, displacement) = (plane.point(point), waves(plane.point(point)));
                [0, 1, 2].map(|c| point[c] + displacement[c])
            },
        );
        assert!(error < 1e-8, "camera {index}: {error}");
    }
}

#[test]
fn a_rigid_motion_given_as_a_displacement_gives_the_same_image() {
    let (plane, camera, speckle) = (tilted(), pinhole(0.3, -0.2), Speckle::new(2.0, 0.5, 3).unwrap());
    let motion = RigidMotion::new([0.02, -0.03, 0.05], [0.0; 3], [0.5, 0.25, -1.0]).unwrap();
    let displacement = |point: [f64; 3]| {
        let moved = motion.apply(point);
        [0, 1, 2].map(|c| moved[c] - point[c])
    };
    let render = Render::new(&camera, SIZE);
    let moved = render.plane(&plane.moved(&motion), &speckle).unwrap();
    let displaced = render.displaced_plane(&plane, &speckle, &displacement).unwrap();
    let error = moved.values().iter().zip(displaced.values()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    // The rays of a pixel are taken as parallel; its aperture then has the size of the plane at rest.
    assert!(error < 1e-3, "{error}");
    assert_ne!(moved, render.plane(&plane, &speckle).unwrap());
}

#[test]
fn a_pixel_is_the_mean_over_its_aperture() {
    let camera = FrontParallel::new(4.0, [10.0, 12.0]).unwrap();
    let speckle = Speckle::new(1.4, 0.5, 9).unwrap();
    for samples in [1, 2, 3, 5, 12] {
        let render = Render::new(&camera, [20, 15]).with_samples(samples);
        let found = render.plane(&Plane::horizontal(0.0).unwrap(), &speckle).unwrap();
        assert_eq!((found.width(), found.height()), (20, 15));
        for (index, value) in found.values().iter().enumerate() {
            let offset = |k: u32| (f64::from(k) + 0.5) / f64::from(samples) - 0.5;
            let (u, v) = ((index % 20) as f64, (index / 20) as f64);
            let sum: f64 = (0..samples * samples)
                .map(|k| [u + offset(k % samples), v + offset(k / samples)])
                .map(|[u, v]| speckle.value([(u - 10.0) / 4.0, (12.0 - v) / 4.0]))
                .sum();
            assert!((value - sum / f64::from(samples * samples)).abs() < 1e-13, "{samples} samples, pixel {index}");
        }
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let (plane, camera, speckle) = (tilted(), pinhole(0.3, -0.2), Speckle::new(2.0, 0.5, 3).unwrap());
    let image = || {
        let rendering = Render::new(&camera, [250, 230]).displaced_plane(&plane, &speckle, &waves).unwrap();
        Sensor::default().with_noise(3.0, 5).expose(&rendering).unwrap()
    };
    let on = |threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(image);
    // More points than one chunk.
    let expected = on(1);
    assert!(on(3) == expected);
}

#[test]
fn progress_increases_to_one() {
    let fractions = std::sync::Mutex::new(Vec::new());
    let record = |fraction| {
        fractions.lock().unwrap().push(fraction);
        true
    };
    let camera = FrontParallel::new(4.0, [10.0, 12.0]).unwrap();
    let render = Render::new(&camera, [400, 300]).with_progress(&record);
    render.plane(&Plane::horizontal(0.0).unwrap(), &|_: [f64; 2]| 0.5).unwrap();
    let fractions = fractions.into_inner().unwrap();
    assert!(fractions.len() > 1 && fractions.is_sorted() && fractions.last() == Some(&1.0), "{fractions:?}");
}

#[test]
fn the_sensor_sets_contrast_noise_and_depth() {
    let camera = FrontParallel::new(1.0, [0.0, 0.0]).unwrap();
    let ramp = |[a, _]: [f64; 2]| a / 400.0;
    let rendering = Render::new(&camera, [401, 300]).plane(&Plane::horizontal(0.0).unwrap(), &ramp).unwrap();
    let exact = Sensor::default().with_levels([10.0, 250.0]);
    let plain = exact.expose(&rendering).unwrap();
    for (index, grey) in plain.pixels().iter().enumerate() {
        let expected = 10.0 + 240.0 * (index % 401) as f64 / 400.0;
        assert!((f64::from(*grey) - expected).abs() < 2e-5);
    }
    let rounded = exact.with_bits(7).expose(&rendering).unwrap();
    for (rounded, grey) in rounded.pixels().iter().zip(plain.pixels()) {
        assert!((rounded - grey.min(127.0)).abs() <= 0.5 && rounded.fract() == 0.0, "{rounded} {grey}");
    }
    let noisy = exact.with_noise(3.0, 1).expose(&rendering).unwrap();
    let differences = noisy.pixels().iter().zip(plain.pixels()).map(|(a, b)| f64::from(a - b));
    let variance = differences.map(|d| d * d).sum::<f64>() / (401.0 * 300.0);
    assert!((variance.sqrt() - 3.0).abs() < 0.03, "{variance}");
    assert_ne!(noisy, exact.with_noise(3.0, 2).expose(&rendering).unwrap());
}
