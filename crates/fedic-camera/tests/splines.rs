//! Spline fields against their definition, and the two spline lenses against each other.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{any_brown, any_field, distance};
use fedic_camera::{
    BrownDistortion, Camera, CameraError, InverseSplineDistortion, Lens, Parameter, Parametric, Pinhole,
    SplineDistortion, SplineField, rotation_from_vector,
};
use proptest::prelude::*;

const DOMAIN: [f64; 4] = [-0.3, -0.2, 0.4, 0.25];

/// The cubic B-spline centred at 0, by its definition.
fn cubic(t: f64) -> f64 {
    let t = t.abs();
    if t < 1.0 { 2.0 / 3.0 - t * t + 0.5 * t * t * t } else { (2.0 - t).max(0.0).powi(3) / 6.0 }
}

fn field_of(intervals: [usize; 2], value: impl Fn([f64; 2]) -> [f64; 2]) -> SplineField {
    SplineField::fit(DOMAIN, intervals, |at| Some(value(at))).unwrap().unwrap()
}

proptest! {
    #[test]
    fn a_field_is_the_sum_of_its_basis_functions(field in any_field(), x in -0.35..0.3, y in -0.2..0.25) {
        let ([x0, y0, x1, y1], [nx, ny]) = (field.domain(), field.intervals());
        let (s, t) = ((x - x0) / (x1 - x0) * nx as f64, (y - y0) / (y1 - y0) * ny as f64);
        let mut sum = [0.0; 2];
        let [mut basis, mut by_x, mut by_y] = [(); 3].map(|()| vec![0.0; field.coefficients().len()]);
        field.add_basis([x, y], [&mut basis, &mut by_x, &mut by_y]);
        for (k, c) in field.coefficients().iter().enumerate() {
            let (i, j) = ((k % (nx + 3)) as f64 - 1.0, (k / (nx + 3)) as f64 - 1.0);
            let weight = cubic(s - i) * cubic(t - j);
            prop_assert!((basis[k] - weight).abs() < 1e-13);
            (0..2).for_each(|d| sum[d] += weight * c[d]);
        }
        let (value, jacobian) = field.value_with_jacobian([x, y]);
        prop_assert!(distance(value, sum) < 1e-14);
        for d in 0..2 {
            let slope = |basis: &[f64]| basis.iter().zip(field.coefficients()).map(|(b, c)| b * c[d]).sum::<f64>();
            prop_assert!(distance(jacobian[d], [slope(&by_x), slope(&by_y)]) < 1e-13);
        }
    }

    #[test]
    fn the_jacobian_of_a_field_is_its_derivative(field in any_field(), x in -0.8..0.8, y in -0.8..0.8) {
        let (value, jacobian) = field.value_with_jacobian([x, y]);
        prop_assert_eq!(value, field.value([x, y]));
        let step = 1e-5;
        for (axis, [dx, dy]) in [[step, 0.0], [0.0, step]].into_iter().enumerate() {
            let (after, before) = (field.value([x + dx, y + dy]), field.value([x - dx, y - dy]));
            for d in 0..2 {
                let slope = (after[d] - before[d]) / (2.0 * step);
                prop_assert!((jacobian[d][axis] - slope).abs() < 1e-4, "{} instead of {}", jacobian[d][axis], slope);
            }
        }
    }

    #[test]
    fn the_slope_bound_holds_in_the_domain(field in any_field(), x in -0.35..0.3, y in -0.2..0.25) {
        let (_, [[a, b], [c, d]]) = field.value_with_jacobian([x, y]);
        prop_assert!(a.hypot(b).hypot(c.hypot(d)) <= field.slope_bound() + 1e-12);
    }

    #[test]
    fn a_field_reproduces_cubic_polynomials(coefficients in [-1.0..1.0, -1.0..1.0, -1.0..1.0], x in -0.3..0.4, y in -0.2..0.25) {
        let [a, b, c] = coefficients;
        let cubic = |[x, y]: [f64; 2]| [a + b * x - c * y * y, x * x * x * a + b * x * x * y + c * x * y.powi(3)];
        prop_assert!(distance(field_of([3, 2], cubic).value([x, y]), cubic([x, y])) < 1e-13);
    }

    #[test]
    fn an_extended_field_continues_its_polynomials(
        coefficients in [-1.0..1.0, -1.0..1.0], field in any_field(), x in -0.35..0.3, y in -0.2..0.25,
    ) {
        prop_assert!(distance(field.extended(3).value([x, y]), field.value([x, y])) < 1e-14);
        let cubic = |[x, y]: [f64; 2]| [coefficients[0] * x * x * y.powi(3), coefficients[1] * x.powi(3)];
        let beyond = [1.5 * x, 1.5 * y];
        prop_assert!(distance(field_of([5, 4], cubic).extended(3).value(beyond), cubic(beyond)) < 1e-11);
    }

    #[test]
    fn the_spline_lenses_approximate_each_other(lens in any_brown(), x in -0.28..0.38, y in -0.19..0.24) {
        let brown = lens;
        let direct = SplineDistortion::from_lens(&brown, DOMAIN, 1e-8).unwrap();
        let seen = [direct.distort([DOMAIN[0], DOMAIN[1]]), direct.distort([DOMAIN[2], DOMAIN[3]])];
        let domain = [seen[0][0] - 0.02, seen[0][1] - 0.02, seen[1][0] + 0.02, seen[1][1] + 0.02];
        let inverse = InverseSplineDistortion::from_lens(&direct, domain, 1e-8).unwrap();
        prop_assert!(distance(direct.distort([x, y]), inverse.distort([x, y])) < 2e-8);
        // The tolerance holds at samples; between them the difference may be a little larger.
        prop_assert!(distance(direct.distort([x, y]), brown.distort([x, y])) < 1.3e-8);
        let back = SplineDistortion::from_lens(&inverse, DOMAIN, 1e-8).unwrap();
        prop_assert!(distance(direct.distort([x, y]), back.distort([x, y])) < 3e-8);
    }
}

fn pinhole() -> Pinhole {
    Pinhole::new([1000.0; 2], [500.0; 2], rotation_from_vector([0.0; 3]), [0.0, 0.0, 2.0]).unwrap()
}

#[test]
fn a_lens_is_linear_beyond_its_domain_and_does_not_cover_it() {
    let field = field_of([6, 4], |[x, y]| [0.1 * x * x, -0.05 * x * y]);
    let lens = SplineDistortion::new(field.clone());
    let camera = pinhole().with_distortion(lens.clone());
    let [a, b, c] = [0.45, 0.55, 0.65].map(|x| field.value([x, 0.1]));
    assert!((a[0] + c[0] - 2.0 * b[0]).abs() < 1e-14, "a straight line");
    assert!((b[0] - (0.1 * 0.16 + 0.08 * 0.15)).abs() < 1e-12, "with the slope of the border");
    assert!(camera.covers([0.79, 0.1, 0.0]) && !camera.covers([0.81, 0.1, 0.0]));
    let inverse = InverseSplineDistortion::new(field);
    let camera = pinhole().with_distortion(inverse.clone());
    let edge = inverse.undistort([0.4, 0.1]).unwrap();
    assert!(camera.covers([2.0 * (edge[0] - 1e-9), 2.0 * edge[1], 0.0]));
    assert!(!camera.covers([2.0 * (edge[0] + 1e-9), 2.0 * edge[1], 0.0]));
}

#[test]
fn approximating_a_lens_that_folds_is_an_error() {
    let folded = BrownDistortion::new([-5.0, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap();
    let out_of_reach = CameraError::LensOutOfReach { domain: DOMAIN };
    assert_eq!(SplineDistortion::from_lens(&folded, DOMAIN, 1e-8), Err(out_of_reach.clone()));
    assert_eq!(InverseSplineDistortion::from_lens(&folded, DOMAIN, 1e-8), Err(out_of_reach));
    let steep = field_of([8, 8], |[x, _]| [-6.0 * x * x * x, 0.0]);
    let lens = SplineDistortion::new(steep.clone());
    assert!(!lens.folds_within([0.2, 0.0]) && lens.folds_within([0.3, 0.1]));
    assert_eq!(lens.undistort([0.2, 0.0]), None, "x - 6 x^3 stays below 0.16");
    let inverse = InverseSplineDistortion::new(steep);
    assert!(inverse.distort([0.5, 0.0]).iter().all(|c| c.is_nan()) || inverse.folds_within([0.5, 0.0]));
}

#[test]
fn invalid_splines_are_refused() {
    let coefficients = vec![[0.0; 2]; 20];
    let made =
        |domain, intervals, coefficients: &[[f64; 2]]| SplineField::new(domain, intervals, coefficients.to_vec());
    assert!(made(DOMAIN, [2, 1], &coefficients).is_ok());
    for (result, part) in [
        (made(DOMAIN, [2, 2], &coefficients), "got 20 coefficients"),
        (made(DOMAIN, [0, 1], &coefficients[..12]), "at least one interval"),
        (made([0.0, 0.0, 0.0, 1.0], [2, 1], &coefficients), "x0 < x1"),
        (made([0.0, 0.0, f64::NAN, 1.0], [2, 1], &coefficients), "not finite"),
        (made(DOMAIN, [2, 1], &[[f64::INFINITY; 2]; 20]), "not finite"),
    ] {
        let message = result.unwrap_err().to_string();
        assert!(message.contains(part), "{message}");
    }
    assert!(SplineField::fit(DOMAIN, [0, 2], |_| Some([0.0; 2])).is_err());
    let rough =
        SplineDistortion::new(field_of([200, 150], |[x, y]| [1e-3 * (300.0 * x).sin(), 1e-3 * (280.0 * y).cos()]));
    let error = SplineDistortion::from_lens(&rough, DOMAIN, 1e-12).unwrap_err();
    assert!(matches!(error, CameraError::ToleranceNotReached { error, .. } if error > 1e-12), "{error}");
}

#[test]
fn perturbing_other_parameters_keeps_the_spline() {
    let lens = SplineDistortion::new(field_of([4, 4], |[x, y]| [0.01 * x * y, 0.0]));
    let camera = pinhole().with_distortion(lens.clone());
    let moved = camera.perturbed([(Parameter::Cx, 2.0), (Parameter::Tz, 0.1)]).unwrap();
    assert_eq!(moved.distortion(), Some(&lens.into()));
    let k1 = Parameter::Lens("k1");
    let error = camera.perturbed([(Parameter::Cx, 0.0), (k1, 0.1)]).unwrap_err();
    assert!(matches!(&error, CameraError::NotAParameter { name: "k1", known } if !known.contains(&"k1")), "{error}");
    assert_eq!(camera.check_parameters(&[k1]), Err(error));
}
