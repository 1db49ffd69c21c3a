//! Properties of every lens model in the list.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashSet;

use common::{PIECEWISE, SMOOTH, any_distortion, derivative, distance, lens_models};
use fedic_camera::lens::{LensVisitor, Plane};
use fedic_camera::{CameraError, Distortion, InverseSplineDistortion, Lens, SplineDistortion};
use proptest::prelude::*;
use proptest::test_runner::TestRunner;

/// Cases per lens model.
const CASES: u32 = 64;

fn any_point() -> impl Strategy<Value = [f64; 2]> {
    [-0.4..0.4, -0.4..0.4]
}

/// Runs a check with random lenses of each model and random points.
fn for_each_model(check: impl Fn(&Distortion, [f64; 2]) -> Result<(), TestCaseError>) {
    let models = lens_models();
    assert_eq!(models.len(), Distortion::MODELS.len());
    for (model, lenses) in models {
        let mut runner =
            TestRunner::new(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(CASES) });
        let result = runner.run(&(lenses, any_point()), |(lens, point)| check(&lens, point));
        assert!(result.is_ok(), "{model}: {}", result.unwrap_err());
    }
}

#[test]
fn the_jacobian_is_the_derivative_of_the_distortion() {
    for_each_model(|lens, point| {
        let (distorted, jacobian) = lens.distort_with_jacobian(point);
        prop_assert!(distance(distorted, lens.distort(point)) < 1e-14);
        let (step, tolerance) = if lens.is_piecewise() { PIECEWISE } else { SMOOTH };
        for axis in 0..2 {
            let numeric = derivative(step, |step| {
                let mut moved = point;
                moved[axis] += step;
                lens.distort(moved)
            });
            for row in 0..2 {
                let error = (jacobian[row][axis] - numeric[row]).abs();
                prop_assert!(error < tolerance, "row {}, axis {}: {:e}", row, axis, error);
            }
        }
        Ok(())
    });
}

#[test]
fn coefficient_derivatives_are_the_derivatives_of_the_distortion() {
    for_each_model(|lens, point| {
        let count = lens.coefficient_names().count();
        for index in 0..count {
            let numeric = derivative(1e-3, |step| {
                let mut coefficients = lens.coefficients().to_vec();
                coefficients[index] += step;
                lens.with_coefficients(&coefficients).unwrap().distort(point)
            });
            let found = lens.coefficient_derivative(point, index);
            prop_assert!(distance(found, numeric) < 1e-10, "coefficient {}: {:?} {:?}", index, found, numeric);
        }
        prop_assert!(lens.coefficient_derivative(point, count).iter().all(|c| c.is_nan()));
        Ok(())
    });
}

#[test]
fn undistorting_a_distorted_point_gives_the_point() {
    for_each_model(|lens, point| {
        prop_assert!(distance(lens.undistort(lens.distort(point)).unwrap(), point) < 1e-13);
        prop_assert_eq!(lens.undistort([f64::NAN, 0.0]), None);
        Ok(())
    });
}

#[test]
fn a_fold_is_a_sign_change_of_the_jacobian() {
    for_each_model(|lens, point| {
        // Further out, where polynomials fold.
        let end = if lens.is_piecewise() { point } else { point.map(|c| 6.0 * c) };
        let determinants = (0..=1000).map(|k| {
            let [[a, b], [c, d]] = lens.distort_with_jacobian(end.map(|x| x * f64::from(k) / 1000.0)).1;
            a * d - b * c
        });
        let smallest = determinants.fold(f64::INFINITY, f64::min);
        // A narrow fold between two samples of the search may be missed.
        if smallest > 0.0 && !lens.is_piecewise() {
            prop_assert!(!lens.folds_within(end));
        } else if smallest < -0.1 {
            prop_assert!(lens.folds_within(end), "{}", smallest);
        }
        Ok(())
    });
}

#[test]
fn a_lens_covers_its_domain_and_nothing_else() {
    for_each_model(|lens, point| {
        let Some(domain) = lens.domain() else {
            prop_assert!(lens.covers(point.map(|c| 100.0 * c)));
            let no_domain = CameraError::NoDomain { model: lens.model() };
            prop_assert_eq!(lens.bounding_box(Plane::Undistorted), Err(no_domain));
            return Ok(());
        };
        let in_plane = if domain.plane == Plane::Distorted { lens.distort(point) } else { point };
        let [x0, y0, x1, y1] = domain.rectangle;
        prop_assert_eq!(lens.covers(point), (x0..=x1).contains(&in_plane[0]) && (y0..=y1).contains(&in_plane[1]));
        prop_assert_eq!(lens.bounding_box(domain.plane), Ok(domain.rectangle));
        if lens.covers(point) {
            // A sampled border: convex between the samples up to their distance.
            let [x0, y0, x1, y1] = lens.bounding_box(Plane::Distorted).unwrap();
            let [x, y] = lens.distort(point);
            prop_assert!((x0 - 1e-3..=x1 + 1e-3).contains(&x) && (y0 - 1e-3..=y1 + 1e-3).contains(&y));
        }
        Ok(())
    });
}

/// Approximates a lens by both spline models.
struct BothSplines {
    domain: [f64; 4],
    tolerance: f64,
}

impl LensVisitor for BothSplines {
    type Output = (SplineDistortion, InverseSplineDistortion);

    fn visit(self, lens: &impl Lens) -> Self::Output {
        let spline = SplineDistortion::from_lens(lens, self.domain, self.tolerance).unwrap();
        (spline, InverseSplineDistortion::from_lens(lens, self.domain, self.tolerance).unwrap())
    }
}

#[test]
fn splines_approximate_lenses_of_every_model() {
    for (model, lenses) in lens_models() {
        let mut runner = TestRunner::new(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(6) });
        let result = runner.run(&(lenses, any_point()), |(lens, point)| {
            let domain = [-0.25, -0.15, 0.2, 0.18];
            let point = [0.4 * point[0], 0.3 * point[1]];
            // Rough fields are not approximated closely.
            let tolerance = if lens.is_piecewise() { 1e-3 } else { 1e-8 };
            let (spline, inverse) = lens.visit(BothSplines { domain, tolerance });
            prop_assert!(distance(spline.distort(point), lens.distort(point)) < 1.5 * tolerance);
            prop_assert!(distance(inverse.distort(point), lens.distort(point)) < 3.0 * tolerance);
            Ok(())
        });
        assert!(result.is_ok(), "{model}: {}", result.unwrap_err());
    }
}

#[test]
fn names_of_models_and_their_coefficients_are_unique() {
    let models: HashSet<_> = Distortion::MODELS.iter().map(|model| model.name).collect();
    assert_eq!(models.len(), Distortion::MODELS.len());
    for model in Distortion::MODELS {
        let names: Vec<_> = model.groups.iter().flat_map(|group| group.coefficients).collect();
        assert_eq!(names.iter().collect::<HashSet<_>>().len(), names.len(), "{}", model.name);
        let groups: HashSet<_> = model.groups.iter().map(|group| group.name).collect();
        assert_eq!(groups.len(), model.groups.len(), "{}", model.name);
    }
}

proptest! {
    #[test]
    fn coefficients_are_found_by_name_and_invalid_ones_are_refused(lens in any_distortion()) {
        let values = lens.coefficients().to_vec();
        prop_assert_eq!(lens.with_coefficients(&values), Ok(lens.clone()));
        prop_assert_eq!(lens.coefficient_names().count(), values.len());
        for (index, name) in lens.coefficient_names().enumerate() {
            prop_assert_eq!(lens.coefficient(name), Some(values[index]));
            let mut invalid = values.clone();
            invalid[index] = f64::NAN;
            prop_assert_eq!(lens.with_coefficients(&invalid), Err(CameraError::NonFinite { parameter: name }));
        }
        prop_assert_eq!(lens.coefficient("no such coefficient"), None);
        let (model, expected) = (lens.model(), values.len());
        let fault = CameraError::CoefficientCount { model, expected, got: expected + 1 };
        prop_assert_eq!(lens.with_coefficients(&vec![0.0; expected + 1]), Err(fault));
    }
}
