//! Names of parameters, and invalid parameters.

#![allow(clippy::unwrap_used, missing_docs)]

use std::str::FromStr;

use fedic_camera::{CameraError, Distortion, FrontParallel, Parameter, Parametric, Pinhole};

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn pinhole() -> Pinhole {
    Pinhole::new([10.0; 2], [0.0; 2], IDENTITY, [0.0; 3]).unwrap()
}

#[test]
fn every_parameter_is_parsed_from_its_name() {
    let view = FrontParallel::new(1.0, [0.0; 2]).unwrap();
    let coefficients = Distortion::MODELS.iter().flat_map(|model| model.groups).flat_map(|group| group.coefficients);
    let lens = coefficients.map(|name| Parameter::Lens(name));
    for parameter in pinhole().parameters().into_iter().chain(view.parameters()).chain(lens) {
        assert!(!parameter.name().is_empty());
        assert_eq!(Parameter::from_str(parameter.name()), Ok(parameter));
        assert_eq!(parameter.to_string(), parameter.name());
    }
}

#[test]
fn an_unknown_name_is_refused_with_the_known_ones() {
    let error = Parameter::from_str("k9").unwrap_err();
    assert!(matches!(&error, CameraError::UnknownParameter { name, .. } if name == "k9"));
    let text = error.to_string();
    assert!(text.starts_with("no camera has a parameter \"k9\": choose among fx, fy, cx, cy, rx"), "{text}");
    assert!(text.contains("scale, k1, k2, k3, d1, d2, p1, p2"), "{text}");
}

#[test]
fn steps_to_an_invalid_camera_are_refused() {
    let not_positive = pinhole().perturbed([(Parameter::Fx, -10.0)]);
    assert!(matches!(not_positive, Err(CameraError::NotPositive { .. })));
    let not_finite = pinhole().perturbed([(Parameter::Lens("k1"), f64::NAN)]);
    assert_eq!(not_finite, Err(CameraError::NonFinite { parameter: "k1" }));
}
