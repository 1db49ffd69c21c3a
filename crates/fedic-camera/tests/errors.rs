//! Invalid parameters and their error messages.

#![allow(clippy::unwrap_used, missing_docs)]

use std::f64::consts::PI;

use fedic_camera::{BrownDistortion, CameraError, FrontParallel, Pinhole};

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn refused<T: std::fmt::Debug>(result: Result<T, CameraError>, error: CameraError, text: &str) {
    assert_eq!(result.unwrap_err(), error);
    assert_eq!(error.to_string(), text);
}

fn pinhole() -> Result<Pinhole, CameraError> {
    Pinhole::new([1000.0; 2], [500.0; 2], IDENTITY, [0.0, 0.0, 1.0])
}

#[test]
fn parameters_that_are_not_finite_are_refused() {
    let not_finite = |parameter| CameraError::NonFinite { parameter };
    for bad in [f64::NAN, f64::INFINITY] {
        let mut tilted = IDENTITY;
        tilted[2][1] = bad;
        let cameras = [
            (Pinhole::new([1000.0, bad], [500.0; 2], IDENTITY, [0.0; 3]), "focal"),
            (Pinhole::new([1000.0; 2], [bad, 500.0], IDENTITY, [0.0; 3]), "principal_point"),
            (Pinhole::new([1000.0; 2], [500.0; 2], tilted, [0.0; 3]), "rotation"),
            (Pinhole::new([1000.0; 2], [500.0; 2], IDENTITY, [0.0, bad, 1.0]), "translation"),
        ];
        for (camera, parameter) in cameras {
            refused(camera, not_finite(parameter), &format!("the camera's {parameter} is not finite"));
        }
        refused(FrontParallel::new(bad, [0.0; 2]), not_finite("scale"), "the camera's scale is not finite");
        refused(FrontParallel::new(1.0, [0.0, bad]), not_finite("origin"), "the camera's origin is not finite");
        let upright = FrontParallel::new(1.0, [0.0; 2]).unwrap();
        refused(upright.with_angle(bad), not_finite("angle"), "the camera's angle is not finite");
        let lenses = [
            (BrownDistortion::new([0.0, 0.0, bad], [0.0; 2], [0.0; 2]), "k3"),
            (BrownDistortion::new([0.0; 3], [bad, 0.0], [0.0; 2]), "d1"),
            (BrownDistortion::new([0.0; 3], [0.0; 2], [0.0, bad]), "p2"),
        ];
        for (lens, parameter) in lenses {
            refused(lens, not_finite(parameter), &format!("the camera's {parameter} is not finite"));
        }
    }
}

#[test]
fn lengths_must_be_positive() {
    for value in [0.0, -12.5] {
        refused(
            FrontParallel::new(value, [0.0; 2]),
            CameraError::NotPositive { parameter: "scale (pixels per unit)", value },
            &format!("the camera's scale (pixels per unit) must be positive, got {value}"),
        );
        for focal in [[value, 1.0], [1.0, value]] {
            refused(
                Pinhole::new(focal, [500.0; 2], IDENTITY, [0.0; 3]),
                CameraError::NotPositive { parameter: "focal length (pixels)", value },
                &format!("the camera's focal length (pixels) must be positive, got {value}"),
            );
        }
    }
}

#[test]
fn the_skew_angle_must_be_between_0_and_pi() {
    for value in [0.0, -0.1, PI, 4.0, f64::NAN, f64::INFINITY] {
        let error = pinhole().unwrap().with_skew_angle(value).unwrap_err();
        assert!(matches!(error, CameraError::SkewAngle { .. }), "{error:?}");
        let text = "the camera's skew_angle is the angle between the pixel axes, in radians between 0 and pi; got";
        assert_eq!(error.to_string(), format!("{text} {value}"));
    }
    let camera = pinhole().unwrap();
    assert_eq!(camera.clone().with_skew_angle(1.2).unwrap().skew_angle(), 1.2);
    // Back at a right angle the camera is the one without skew.
    let back = camera.clone().with_skew_angle(1.2).unwrap().with_skew_angle(PI / 2.0).unwrap();
    assert_eq!(back, camera);
}

#[test]
fn a_matrix_that_is_not_a_rotation_is_refused() {
    let stretched = [[1.0, 0.0, 0.0], [0.0, 1.01, 0.0], [0.0, 0.0, 1.0]];
    let mirrored = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];
    for (matrix, expected, shown) in [(stretched, 1.01_f64.powi(2) - 1.0, "2.0e-2"), (mirrored, 2.0, "2.0e0")] {
        let error = Pinhole::new([1000.0; 2], [500.0; 2], matrix, [0.0; 3]).unwrap_err();
        assert!(
            matches!(error, CameraError::NotARotation { deviation } if (deviation - expected).abs() < 1e-12),
            "{error:?}"
        );
        assert_eq!(
            error.to_string(),
            format!(
                "the camera's rotation matrix is not a rotation: R R^T differs from the identity by {shown} or its \
                 determinant is not +1; give an orthonormal, right-handed matrix or a rotation vector"
            )
        );
    }
    // Seven digits, as in a file, are enough.
    let (sin, cos) = (0.479_425_5, 0.877_582_6);
    let rounded = [[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]];
    assert!(Pinhole::new([1000.0; 2], [500.0; 2], rounded, [0.0, 0.0, 1.0]).is_ok());
}
