//! Options: ranges, names, values of a type known at run time, and the errors for each.

#![allow(clippy::unwrap_used, missing_docs)]

use std::sync::Arc;

use fedic::{
    Brightness, CellType, Correlator, Error, Gradient, Hessian, Image, ImageError, ImageFrame, Interpolation,
    OptionError, OptionKind, OptionValue, Options, Quadrature, Robust, Rule, SelfCalibrationOptions, rectangle_mesh,
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
        cases.push((Options::default().quadrature(mesh_rule(density)), text));
    }
    for smoothing in [-0.5, f64::NAN, f64::INFINITY] {
        let text = format!("smoothing must be zero or a positive standard deviation in pixels, got {smoothing}");
        cases.push((Options::default().smoothing(smoothing), text));
    }
    for length in [0.0, -10.0, f64::NAN, f64::INFINITY] {
        let text = format!("regularization_length must be a positive wavelength in pixels, got {length}");
        cases.push((Options::default().regularization_length(Some(length)), text));
    }
    for tolerance in [0.0, -1e-3, 1.5, 1e308, f64::NAN, f64::INFINITY] {
        let text = format!("tolerance must be a positive number of pixels of at most 1, got {tolerance}");
        cases.push((Options::default().tolerance(tolerance), text));
    }
    let text = "max_iterations must be an integer of at least 1, got 0".to_owned();
    cases.push((Options::default().max_iterations(0), text));
    for threads in [0, 1025] {
        let text = format!("num_threads must be an integer between 1 and 1024, got {threads}");
        cases.push((Options::default().num_threads(Some(threads)), text));
    }
    for (options, text) in cases {
        let error = prepare(options).unwrap_err();
        assert!(matches!(error, Error::Option(OptionError::Invalid { .. })), "{error:?}");
        assert_eq!(error.to_string(), text);
    }
}

#[test]
fn options_at_the_ends_of_their_range_are_accepted() {
    for options in [
        Options::default().quadrature(Quadrature::Mesh { rule: Rule::Edges, density: 10_000.0 }),
        Options::default().smoothing(0.0).max_iterations(1).num_threads(Some(1)),
        Options::default().regularization_length(Some(1e-3)).tolerance(f64::MIN_POSITIVE),
    ] {
        assert_eq!(prepare(options), Ok(()));
    }
}

#[test]
fn a_smoothing_wider_than_the_image_is_refused() {
    let error = prepare(Options::default().smoothing(31.0)).unwrap_err();
    assert_eq!(error, Error::Image(ImageError::InvalidSmoothing { smoothing: 31.0, largest: 30 }));
}

#[test]
fn enumerated_options_parse_from_their_names() {
    assert_eq!("analytic".parse(), Ok(Gradient::Analytic));
    assert_eq!("finite-difference".parse(), Ok(Gradient::FiniteDifference));
    assert_eq!("none".parse(), Ok(Brightness::None));
    assert_eq!("global".parse(), Ok(Brightness::Global));
    assert_eq!("element".parse(), Ok(Brightness::Element));
    assert_eq!("field".parse(), Ok(Brightness::Field));
    assert_eq!("tukey".parse(), Ok(Robust::Tukey));
    assert_eq!("initial".parse(), Ok(Hessian::Initial));
    assert_eq!("updated".parse(), Ok(Hessian::Updated));
    for (error, text) in [
        ("x".parse::<Gradient>().unwrap_err(), "gradient must be \"analytic\" or \"finite-difference\", got \"x\""),
        (
            "Global".parse::<Brightness>().unwrap_err(),
            "brightness must be \"auto\", \"global\", \"element\", \"field\" or \"none\", got \"Global\"",
        ),
        ("".parse::<Hessian>().unwrap_err(), "hessian must be \"initial\" or \"updated\", got \"\""),
    ] {
        assert_eq!(error.to_string(), text);
    }
}

#[test]
fn an_option_can_be_set_by_its_name() {
    let name = |name: &str| OptionValue::Name(name.to_owned());
    let mut options = Options::default();
    for (option, value) in [
        ("quadrature", OptionValue::Scaled("edges".to_owned(), 2.0)),
        ("interpolation", name("bilinear")),
        ("gradient", name("finite-difference")),
        ("smoothing", OptionValue::Integer(1)),
        ("brightness", OptionValue::None),
        ("hessian", name("updated")),
        ("regularization_length", OptionValue::Number(40.0)),
        ("tolerance", OptionValue::Number(1e-4)),
        ("max_iterations", OptionValue::Integer(7)),
        ("num_threads", OptionValue::Integer(2)),
    ] {
        options.set(option, &value).unwrap();
    }
    let expected = Options::default()
        .quadrature(Quadrature::Mesh { rule: Rule::Edges, density: 2.0 })
        .interpolation(Interpolation::Bilinear)
        .gradient(Gradient::FiniteDifference)
        .smoothing(1.0)
        .brightness(Brightness::None)
        .hessian(Hessian::Updated)
        .regularization_length(Some(40.0))
        .tolerance(1e-4)
        .max_iterations(7)
        .num_threads(Some(2));
    assert_eq!(options, expected);
    options.set("quadrature", &name("pixel")).unwrap();
    assert_eq!(options.quadrature, Quadrature::Pixel);
    options.set("regularization_length", &OptionValue::None).unwrap();
    assert_eq!(options.regularization_length, None);
}

#[test]
fn a_value_of_the_wrong_type_or_range_is_refused_and_changes_nothing() {
    let mut options = Options::default();
    for (option, value, text) in [
        (
            "smoothing",
            OptionValue::Name("wide".to_owned()),
            "zero or a positive standard deviation in pixels, got \"wide\"",
        ),
        ("smoothing", OptionValue::Number(-1.0), "zero or a positive standard deviation in pixels, got -1"),
        ("tolerance", OptionValue::None, "a positive number of pixels of at most 1, got none"),
        ("max_iterations", OptionValue::Number(5.0), "an integer of at least 1, got 5"),
        ("max_iterations", OptionValue::Integer(-3), "an integer of at least 1, got -3"),
        ("max_iterations", OptionValue::Flag(true), "an integer of at least 1, got true"),
        ("hessian", OptionValue::None, "\"initial\" or \"updated\", got none"),
        (
            "quadrature",
            OptionValue::Name("gauss".to_owned()),
            "\"rotated\", \"edges\", \"diameter\" or \"pixel\", got \"gauss\"",
        ),
    ] {
        let error = options.set(option, &value).unwrap_err();
        assert_eq!(error.to_string(), format!("{option} must be {text}"));
    }
    let error = options.set("quadrature", &OptionValue::Scaled("edges".to_owned(), 0.0)).unwrap_err();
    assert_eq!(error.to_string(), "density must be a positive number of at most 10000, got 0");
    let mut specimen = SelfCalibrationOptions::default();
    let error = specimen.set("known_translations", &OptionValue::Integer(1)).unwrap_err();
    assert_eq!(error.to_string(), "known_translations must be true or false, got 1");
    assert_eq!((options, specimen), (Options::default(), SelfCalibrationOptions::default()));
}

#[test]
fn an_unknown_option_is_refused_with_the_known_ones() {
    let error = Options::default().set("smoothin", &OptionValue::Number(0.8)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "there is no option \"smoothin\"; the options are quadrature, interpolation, gradient, smoothing, brightness, \
         robust, hessian, regularization_length, tolerance, noise, max_iterations, num_threads"
    );
}

#[test]
fn the_table_describes_every_option() {
    for info in Options::info().into_iter().chain(SelfCalibrationOptions::info()) {
        assert!(info.doc.trim_end().ends_with('.'), "{info:?}");
        assert_eq!(info.choices.is_empty(), !matches!(info.kind, OptionKind::Choice | OptionKind::Quadrature));
    }
    let mut options = Options::default().smoothing(0.1).max_iterations(3).brightness(Brightness::None);
    for info in Options::info() {
        options.set(info.name, &info.default).unwrap();
    }
    assert_eq!(options, Options::default());
    let names: Vec<&str> = SelfCalibrationOptions::info().iter().map(|info| info.name).collect();
    let expected = "motion known_translations density interpolation smoothing gain_and_offset noise tolerance max_iterations num_threads";
    assert_eq!(names.join(" "), expected);
}
