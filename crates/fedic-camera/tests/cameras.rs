//! Properties of every camera model, with lenses of every model.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::sync::Arc;

use common::{PIECEWISE, SMOOTH, any_front_parallel, any_pinhole, any_point, derivative};
use fedic_camera::{
    Camera, CameraError, ImageFrame, Parameter, Parametric, Scaled, unproject, unproject_with_jacobian,
};
use proptest::prelude::*;
use proptest::strategy::Union;

/// A camera of any model.
fn any_camera() -> impl Strategy<Value = Arc<dyn Camera>> {
    let unscaled = || {
        Union::new([
            Just(Arc::new(ImageFrame) as Arc<dyn Camera>).boxed(),
            any_front_parallel().prop_map(|camera| Arc::new(camera) as Arc<dyn Camera>).boxed(),
            any_pinhole().prop_map(|camera| Arc::new(camera) as Arc<dyn Camera>).boxed(),
            any_pinhole().prop_map(|camera| Arc::new(camera) as Arc<dyn Camera>).boxed(),
        ])
    };
    let scaled = (unscaled(), 0.01..4.0).prop_map(|(camera, factor)| Arc::new(Scaled::new(camera, factor)) as _);
    Union::new([unscaled().boxed(), scaled.boxed()])
}

proptest! {
    #[test]
    fn the_jacobian_is_the_derivative_of_the_projection(camera in any_camera(), point in any_point()) {
        let (pixel, jacobian) = camera.project_with_jacobian(point);
        prop_assert_eq!(pixel, camera.project(point));
        let largest = jacobian.iter().flatten().fold(0.0_f64, |m, j| m.max(j.abs()));
        let (step, tolerance) = if camera.is_piecewise() { PIECEWISE } else { SMOOTH };
        for axis in 0..3 {
            let numeric = derivative(step, |step| {
                let mut moved = point;
                moved[axis] += step;
                camera.project(moved)
            });
            for row in 0..2 {
                let error = (jacobian[row][axis] - numeric[row]).abs() / largest;
                prop_assert!(error < tolerance, "row {}, axis {}: {:e}", row, axis, error);
            }
        }
        prop_assert_eq!(camera.constant_jacobian().unwrap_or(jacobian), jacobian);
    }

    #[test]
    fn a_batch_gives_the_same_bits_as_its_points(
        camera in any_camera(),
        points in proptest::collection::vec(any_point(), 0..20),
    ) {
        let n = points.len();
        let [x, y, z]: [Vec<f64>; 3] = [0, 1, 2].map(|d| points.iter().map(|p| p[d]).collect());
        let (mut u, mut v) = (vec![0.0; n], vec![0.0; n]);
        camera.project_batch(&x, &y, &z, &mut u, &mut v);
        let (mut uj, mut vj) = (vec![0.0; n], vec![0.0; n]);
        let mut entries: [[Vec<f64>; 3]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| vec![0.0; n]));
        let mut slices = entries.each_mut().map(|row| row.each_mut().map(Vec::as_mut_slice));
        camera.project_with_jacobian_batch(&x, &y, &z, &mut uj, &mut vj, &mut slices);
        for (k, &point) in points.iter().enumerate() {
            prop_assert_eq!([u[k], v[k]].map(f64::to_bits), camera.project(point).map(f64::to_bits));
            let (pixel, jacobian) = camera.project_with_jacobian(point);
            prop_assert_eq!([uj[k], vj[k]].map(f64::to_bits), pixel.map(f64::to_bits));
            for (row, exact) in entries.iter().zip(jacobian) {
                for (entry, exact) in row.iter().zip(exact) {
                    prop_assert_eq!(entry[k].to_bits(), exact.to_bits());
                }
            }
        }
    }

    #[test]
    fn unprojecting_a_pixel_gives_a_point_that_projects_to_it(camera in any_camera(), point in any_point()) {
        let pixel = camera.project(point);
        let (found, _) = unproject_with_jacobian(&*camera, pixel, point[2]).unwrap();
        prop_assert_eq!(Some(found), unproject(&*camera, pixel, point[2]));
        prop_assert_eq!(found[2], point[2]);
        let image = camera.project(found);
        let error = (image[0] - pixel[0]).abs().max((image[1] - pixel[1]).abs());
        prop_assert!(error < 1e-10, "{:e}", error);
    }

    #[test]
    fn a_scaled_camera_scales_pixels_and_forwards_the_rest(
        camera in any_camera(),
        point in any_point(),
        factor in 0.01..4.0,
    ) {
        let scaled = Scaled::new(Arc::clone(&camera), factor);
        prop_assert_eq!(scaled.project(point), camera.project(point).map(|c| c * factor));
        prop_assert_eq!(scaled.constant_jacobian().is_some(), camera.constant_jacobian().is_some());
        prop_assert_eq!(scaled.is_piecewise(), camera.is_piecewise());
        prop_assert_eq!(scaled.covers(point), camera.covers(point));
        prop_assert_eq!(scaled.is_beyond_fold(point), camera.is_beyond_fold(point));
    }

    #[test]
    fn the_parameter_jacobian_of_a_pinhole_is_its_derivative(camera in any_pinhole(), point in any_point()) {
        check_parameter_jacobian(&camera, point)?;
    }

    #[test]
    fn the_parameter_jacobian_of_a_front_parallel_view_is_its_derivative(
        camera in any_front_parallel(),
        point in any_point(),
    ) {
        check_parameter_jacobian(&camera, point)?;
    }

    #[test]
    fn each_parameter_has_its_column_in_any_selection(
        camera in any_pinhole(),
        point in any_point(),
        selector in proptest::collection::vec(any::<bool>(), 32),
    ) {
        let all = camera.parameters();
        let selected: Vec<Parameter> = all.iter().zip(selector).filter_map(|(&p, chosen)| chosen.then_some(p)).collect();
        let (mut columns, mut some) = (vec![[0.0; 2]; all.len()], vec![[0.0; 2]; selected.len()]);
        camera.parameter_jacobian(point, &all, &mut columns);
        camera.parameter_jacobian(point, &selected, &mut some);
        for (parameter, column) in selected.iter().zip(some) {
            prop_assert_eq!(column, columns[all.iter().position(|p| p == parameter).unwrap()]);
        }
    }

    #[test]
    fn zero_steps_do_not_change_a_camera(camera in any_pinhole(), view in any_front_parallel(), point in any_point()) {
        let steps: Vec<_> = camera.parameters().into_iter().map(|parameter| (parameter, 0.0)).collect();
        prop_assert_eq!(camera.perturbed(steps).unwrap().project(point), camera.project(point));
        prop_assert_eq!(camera.perturbed([(Parameter::Cx, 0.0)]).unwrap(), camera);
        let steps: Vec<_> = view.parameters().into_iter().map(|parameter| (parameter, 0.0)).collect();
        prop_assert_eq!(view.perturbed(steps).unwrap(), view);
    }
}

/// Compares the derivative with respect to each parameter with differences.
fn check_parameter_jacobian<C: Parametric>(camera: &C, point: [f64; 3]) -> Result<(), TestCaseError> {
    let parameters = camera.parameters();
    let mut columns = vec![[f64::NAN; 2]; parameters.len()];
    prop_assert_eq!(camera.check_parameters(&parameters), Ok(()));
    camera.parameter_jacobian(point, &parameters, &mut columns);
    let largest = columns.iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()));
    for (parameter, column) in parameters.into_iter().zip(columns) {
        let (step, tolerance) = match parameter {
            Parameter::Fx | Parameter::Fy | Parameter::Cx | Parameter::Cy | Parameter::U0 | Parameter::V0 => {
                (1.0, 1e-9)
            }
            Parameter::Lens(_) | Parameter::Scale => (1e-3, 1e-9),
            _ if camera.is_piecewise() => PIECEWISE,
            _ => (1e-3, 1e-9),
        };
        let numeric = derivative(step, |step| camera.perturbed([(parameter, step)]).unwrap().project(point));
        for row in 0..2 {
            let error = (column[row] - numeric[row]).abs() / largest;
            prop_assert!(error < tolerance, "{parameter}, row {row}: {} against {}", column[row], numeric[row]);
        }
    }
    Ok(())
}

#[test]
fn parameters_a_camera_does_not_have_are_refused() {
    let view = fedic_camera::FrontParallel::new(1.0, [0.0; 2]).unwrap();
    let known = vec!["u0", "v0", "angle", "scale"];
    let error = CameraError::NotAParameter { name: "k1", known };
    let text = "the camera has no parameter \"k1\": its parameters are u0, v0, angle, scale";
    assert_eq!(error.to_string(), text);
    let k1 = Parameter::Lens("k1");
    assert_eq!(view.perturbed([(k1, 1.0)]), Err(error.clone()));
    assert_eq!(view.check_parameters(&[Parameter::U0, k1]), Err(error));
    let mut columns = [[0.0; 2]; 2];
    view.parameter_jacobian([0.0; 3], &[Parameter::U0, k1], &mut columns);
    assert!(columns[0] == [1.0, 0.0] && columns[1].iter().all(|c| c.is_nan()));
}
