//! Options out of their range, and the words they are refused in.

#![allow(clippy::unwrap_used, missing_docs)]

use std::sync::Arc;

use fedic::{
    Brightness, CellType, Correlator, Error, Gradient, Hessian, Image, ImageError, ImageFrame, Options, Quadrature,
    Rule, SolveError, rectangle_mesh,
};

fn prepare(options: Options) -> Result<(), Error> {
    let greys = (0..900).map(|k| ((k * 37) % 251) as f32).collect();
    let image = Image::new(30, 30, greys).unwrap();
    let mesh = rectangle_mesh([5.0, 5.0, 25.0, 25.0], 10.0, CellType::Quad).unwrap();
    Correlator::new(Arc::new(image.clone()), &mesh, Arc::new(ImageFrame), options).map(|_| ())
}

#[test]
fn options_out_of_their_range_are_refused() {
    let mesh_rule = |density| Quadrature::Mesh { rule: Rule::Edges, density };
    let mut cases = Vec::new();
    for density in [0.0, -1.0, 10_001.0, f64::NAN, f64::INFINITY] {
        let text = format!("density must be a positive number of at most 10000, got {density}");
        cases.push((Options { quadrature: mesh_rule(density), ..Options::default() }, text));
    }
    for smoothing in [-0.5, f64::NAN, f64::INFINITY] {
        let text = format!("smoothing must be zero or a positive standard deviation in pixels, got {smoothing}");
        cases.push((Options { smoothing, ..Options::default() }, text));
    }
    for length in [0.0, -10.0, f64::NAN, f64::INFINITY] {
        let text = format!("regularization_length must be a positive wavelength in pixels, got {length}");
        cases.push((Options { regularization_length: Some(length), ..Options::default() }, text));
    }
    for tolerance in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        let text = format!("tolerance must be a positive number of pixels, got {tolerance}");
        cases.push((Options { tolerance, ..Options::default() }, text));
    }
    let text = "max_iterations must be at least 1, got 0".to_owned();
    cases.push((Options { max_iterations: 0, ..Options::default() }, text));
    for threads in [0, 1025] {
        let text = format!("num_threads must be between 1 and 1024, got {threads}");
        cases.push((Options { num_threads: Some(threads), ..Options::default() }, text));
    }
    for (options, text) in cases {
        let error = prepare(options).unwrap_err();
        assert!(matches!(error, Error::Solve(SolveError::InvalidOption { .. })), "{error:?}");
        assert_eq!(error.to_string(), text);
    }
}

#[test]
fn options_at_the_ends_of_their_range_are_accepted() {
    for options in [
        Options { quadrature: Quadrature::Mesh { rule: Rule::Edges, density: 10_000.0 }, ..Options::default() },
        Options { smoothing: 0.0, max_iterations: 1, num_threads: Some(1), ..Options::default() },
        Options { regularization_length: Some(1e-3), tolerance: f64::MIN_POSITIVE, ..Options::default() },
    ] {
        assert_eq!(prepare(options), Ok(()));
    }
}

#[test]
fn a_smoothing_wider_than_the_image_is_refused() {
    let error = prepare(Options { smoothing: 31.0, ..Options::default() }).unwrap_err();
    assert_eq!(error, Error::Image(ImageError::InvalidSmoothing { smoothing: 31.0, largest: 30 }));
}

#[test]
fn enumerated_options_parse_from_their_names() {
    assert_eq!("analytic".parse(), Ok(Gradient::Analytic));
    assert_eq!("finite-difference".parse(), Ok(Gradient::FiniteDifference));
    assert_eq!("none".parse(), Ok(Brightness::None));
    assert_eq!("global".parse(), Ok(Brightness::Global));
    assert_eq!("element".parse(), Ok(Brightness::Element));
    assert_eq!("initial".parse(), Ok(Hessian::Initial));
    assert_eq!("updated".parse(), Ok(Hessian::Updated));
    for (error, text) in [
        ("x".parse::<Gradient>().unwrap_err(), "gradient must be \"analytic\" or \"finite-difference\", got \"x\""),
        (
            "Global".parse::<Brightness>().unwrap_err(),
            "brightness must be \"global\", \"element\" or None, got \"Global\"",
        ),
        ("".parse::<Hessian>().unwrap_err(), "hessian must be \"initial\" or \"updated\", got \"\""),
    ] {
        assert_eq!(error.to_string(), text);
    }
}
