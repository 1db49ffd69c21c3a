//! Derivatives by the camera's parameters against differences.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::str::FromStr;

use common::{any_brown_pinhole, any_point};
use fedic_camera::{Camera, CameraError, Parameter, Pinhole};
use proptest::prelude::*;

/// Steps of the differences: a fixed small part of what each parameter may be.
fn step(parameter: Parameter) -> f64 {
    match parameter {
        Parameter::Fx | Parameter::Fy | Parameter::Cx | Parameter::Cy => 1.0,
        _ => 1e-3,
    }
}

proptest! {
    #[test]
    fn the_parameter_jacobian_is_the_derivative(camera in any_brown_pinhole(), point in any_point()) {
        let mut columns = [[0.0; 2]; Parameter::ALL.len()];
        camera.parameter_jacobian(point, &Parameter::ALL, &mut columns);
        let largest = columns.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
        for (parameter, column) in Parameter::ALL.into_iter().zip(columns) {
            let step = step(parameter);
            let at = |k: f64| camera.moved_by(&[parameter], &[k * step]).unwrap().project(point);
            let [far_back, back, forward, far] = [-2.0, -1.0, 1.0, 2.0].map(at);
            for row in 0..2 {
                let numeric = (8.0 * (forward[row] - back[row]) - (far[row] - far_back[row])) / (12.0 * step);
                let error = (column[row] - numeric).abs() / largest;
                prop_assert!(error < 1e-9, "{parameter}, row {row}: {} against {numeric}", column[row]);
            }
        }
    }

    #[test]
    fn any_choice_gives_its_own_columns(
        camera in any_brown_pinhole(),
        point in any_point(),
        chosen in proptest::sample::subsequence(Parameter::ALL.to_vec(), 0..=Parameter::ALL.len()),
    ) {
        let (mut all, mut some) = ([[0.0; 2]; 17], vec![[0.0; 2]; chosen.len()]);
        camera.parameter_jacobian(point, &Parameter::ALL, &mut all);
        camera.parameter_jacobian(point, &chosen, &mut some);
        for (parameter, column) in chosen.iter().zip(some) {
            prop_assert_eq!(column, all[Parameter::ALL.iter().position(|p| p == parameter).unwrap()]);
        }
    }

    #[test]
    fn no_step_leaves_the_camera_where_it_is(camera in any_brown_pinhole(), point in any_point()) {
        let same = camera.moved_by(&Parameter::ALL, &[0.0; 17]).unwrap();
        prop_assert_eq!(same.project(point), camera.project(point));
        prop_assert_eq!(camera.moved_by(&[Parameter::Cx], &[0.0]).unwrap(), camera);
    }
}

#[test]
fn names_are_read_back() {
    for parameter in Parameter::ALL {
        assert_eq!(Parameter::from_str(parameter.name()), Ok(parameter));
    }
    let error = Parameter::from_str("k9").unwrap_err();
    assert_eq!(error, CameraError::UnknownParameter { name: "k9".to_owned() });
    assert!(error.to_string().contains("\"k9\"") && error.to_string().contains("k1, k2, k3"));
}

#[test]
fn steps_to_no_camera_are_refused() {
    let camera =
        Pinhole::new([10.0; 2], [0.0; 2], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
    assert!(matches!(camera.moved_by(&[Parameter::Fx], &[-10.0]), Err(CameraError::NotPositive { .. })));
    assert!(matches!(camera.moved_by(&[Parameter::K1], &[f64::NAN]), Err(CameraError::NonFinite { .. })));
}
