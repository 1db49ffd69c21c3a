//! Errors name the option, the pixel or the iteration at fault.

#![allow(clippy::unwrap_used, clippy::panic)]

use fedic_camera::{BrownDistortion, ImageFrame, Pinhole, rotation_from_vector};
use fedic_synthetic::{Plane, Render, RigidMotion, Sensor, Speckle, SyntheticError};

fn horizontal() -> Plane {
    Plane::horizontal(0.0).unwrap()
}

fn flat(_: [f64; 2]) -> f64 {
    0.5
}

#[test]
fn speckle_parameters_out_of_range_are_refused() {
    for (size, coverage, text) in [
        (0.0, 0.5, "size must be a positive length, got 0"),
        (f64::NAN, 0.5, "size must be a positive length, got NaN"),
        (4.0, 0.05, "coverage must be between 0.1 and 0.7, got 0.05"),
        (4.0, f64::NAN, "coverage must be between 0.1 and 0.7, got NaN"),
    ] {
        assert_eq!(Speckle::new(size, coverage, 1).unwrap_err().to_string(), text);
    }
}

#[test]
fn render_options_out_of_range_are_refused() {
    for (render, text) in [
        (Render::new(&ImageFrame, [0, 5]), "width must be at least 1, got 0"),
        (Render::new(&ImageFrame, [5, 0]), "height must be at least 1, got 0"),
        (Render::new(&ImageFrame, [5, 5]).with_samples(0), "samples must be at least 1, got 0"),
    ] {
        assert_eq!(render.plane(&horizontal(), &flat).unwrap_err().to_string(), text);
    }
    let huge = Render::new(&ImageFrame, [1 << 31, 1]).with_samples(1 << 20);
    assert!(matches!(huge.plane(&horizontal(), &flat), Err(SyntheticError::TooLarge { .. })));
}

#[test]
fn sensor_options_out_of_range_are_refused() {
    let rendering = Render::new(&ImageFrame, [5, 5]).plane(&horizontal(), &flat).unwrap();
    let text = |sensor: Sensor| sensor.expose(&rendering).unwrap_err().to_string();
    assert_eq!(text(Sensor::default().with_noise(-1.0, 0)), "noise must be finite and at least 0, got -1");
    assert_eq!(text(Sensor::default().with_noise(f64::NAN, 0)), "noise must be finite and at least 0, got NaN");
    assert_eq!(text(Sensor::default().with_bits(17)), "bits must be between 1 and 16, got 17");
    let infinite = text(Sensor::default().with_levels([0.0, f64::INFINITY]));
    assert_eq!(infinite, "the grey level of pixel (u = 0, v = 0) is not a finite number");
}

#[test]
fn degenerate_planes_and_motions_are_refused() {
    let origin = [1.0, 2.0, 3.0];
    for axes in
        [[[1.0, 0.0, 0.0], [-2.0, 0.0, 0.0]], [[1.0, 0.0, 0.0], [0.0; 3]], [[1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0]]]
    {
        assert!(matches!(Plane::new(origin, axes), Err(SyntheticError::InvalidPlane { .. })), "{axes:?}");
    }
    assert!(Plane::horizontal(f64::NAN).is_err());
    let error = RigidMotion::new([0.0; 3], [0.0, f64::INFINITY, 0.0], [0.0; 3]).unwrap_err();
    assert_eq!(error.to_string(), "centre must be three finite numbers, got [0.0, inf, 0.0]");
}

#[test]
fn pixels_that_do_not_see_the_plane_are_located() {
    let facing = rotation_from_vector([std::f64::consts::PI, 0.0, 0.0]);
    let camera = Pinhole::new([1000.0; 2], [499.5; 2], facing, [0.0, 0.0, 100.0]).unwrap();
    let folded = camera.clone().with_distortion(BrownDistortion::new([-1.0, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap());
    let error = Render::new(&folded, [1000, 10]).plane(&horizontal(), &flat).unwrap_err();
    let SyntheticError::NotVisible { pixel, count, total, rows } = error else { panic!("{error}") };
    assert_eq!((pixel, total, rows), ([0, 0], 10_000, [0, 10]));
    assert!(0 < count && count <= total);
    // A plane along the optical axis, above it: the rays of the lower half of the image miss it.
    let receding = Plane::new([0.0, 5.0, 0.0], [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]).unwrap();
    let error = Render::new(&camera, [8, 1000]).plane(&receding, &flat).unwrap_err();
    let SyntheticError::NotVisible { pixel, count, .. } = error else { panic!("{error}") };
    assert_eq!((pixel, count), ([0, 500], 8 * 500));
    let text = "4000 of the 8000 pixels in rows 0 to 999 see no point of the plane, the first at (u = 0, v = 500): their rays \
                miss it, or the lens model folds there";
    assert_eq!(error.to_string(), text);
}

#[test]
fn displacements_that_cannot_be_inverted_are_refused() {
    let render = Render::new(&ImageFrame, [20, 20]);
    let folding = |[x, y, _]: [f64; 3]| [1.5 * x, -2.0 * y, 0.0];
    let error = render.displaced_plane(&horizontal(), &flat, &folding).unwrap_err();
    assert!(matches!(error, SyntheticError::NotInvertible { iterations: 60, step, .. } if step > 1.0), "{error}");
    let undefined = |_: [f64; 3]| [f64::NAN, 0.0, 0.0];
    let error = render.displaced_plane(&horizontal(), &flat, &undefined).unwrap_err();
    assert!(matches!(error, SyntheticError::NotInvertible { step, .. } if step.is_nan()), "{error}");
}

#[test]
fn rendering_stops_when_the_caller_says_so() {
    let stop = |fraction: f64| fraction < 0.5;
    let error = Render::new(&ImageFrame, [400, 400]).with_progress(&stop).plane(&horizontal(), &flat).unwrap_err();
    assert!(matches!(error, SyntheticError::Cancelled), "{error}");
}
