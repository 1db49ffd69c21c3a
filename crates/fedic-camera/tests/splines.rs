//! Lenses made of splines: the field against its definition and its derivatives, the two forms against each other.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{any_distortion, any_field, any_lens};
use fedic_camera::{
    BrownDistortion, Camera, CameraError, Distortion, InverseSplineDistortion, Parameter, Pinhole, SplineDistortion,
    SplineField, rotation_from_vector,
};
use proptest::prelude::*;

const DOMAIN: [f64; 4] = [-0.3, -0.2, 0.4, 0.25];

/// The cubic B-spline centred at 0, by its definition.
fn cubic(t: f64) -> f64 {
    let t = t.abs();
    if t < 1.0 { 2.0 / 3.0 - t * t + 0.5 * t * t * t } else { (2.0 - t).max(0.0).powi(3) / 6.0 }
}

fn distance([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    (a - c).hypot(b - d)
}

fn field_of(intervals: [usize; 2], value: impl Fn([f64; 2]) -> [f64; 2]) -> SplineField {
    SplineField::approximating(DOMAIN, intervals, |at| Some(value(at))).unwrap().unwrap()
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
    fn no_slope_within_the_domain_is_above_the_bound(field in any_field(), x in -0.35..0.3, y in -0.2..0.25) {
        let (_, [[a, b], [c, d]]) = field.value_with_jacobian([x, y]);
        prop_assert!(a.hypot(b).hypot(c.hypot(d)) <= field.steepest() + 1e-12);
    }

    #[test]
    fn a_field_takes_any_cubic_as_it_is(coefficients in [-1.0..1.0, -1.0..1.0, -1.0..1.0], x in -0.3..0.4, y in -0.2..0.25) {
        let [a, b, c] = coefficients;
        let cubic = |[x, y]: [f64; 2]| [a + b * x - c * y * y, x * x * x * a + b * x * x * y + c * x * y.powi(3)];
        prop_assert!(distance(field_of([3, 2], cubic).value([x, y]), cubic([x, y])) < 1e-13);
    }

    #[test]
    fn an_extended_field_is_the_same_and_goes_on_as_it_was(
        coefficients in [-1.0..1.0, -1.0..1.0], field in any_field(), x in -0.35..0.3, y in -0.2..0.25,
    ) {
        prop_assert!(distance(field.extended(3).value([x, y]), field.value([x, y])) < 1e-14);
        let cubic = |[x, y]: [f64; 2]| [coefficients[0] * x * x * y.powi(3), coefficients[1] * x.powi(3)];
        let beyond = [1.5 * x, 1.5 * y];
        prop_assert!(distance(field_of([5, 4], cubic).extended(3).value(beyond), cubic(beyond)) < 1e-11);
    }

    #[test]
    fn what_a_lens_shows_is_taken_back(lens in any_distortion(), x in -0.3..0.3, y in -0.2..0.2) {
        let (seen, _) = lens.distort_with_jacobian([x, y]);
        prop_assert!(distance(seen, lens.distort([x, y])) < 1e-14);
        prop_assert!(distance(lens.undistort(seen).unwrap(), [x, y]) < 1e-13);
    }

    #[test]
    fn direct_and_inverse_agree(lens in any_lens(), x in -0.28..0.38, y in -0.19..0.24) {
        let brown = Distortion::from(lens);
        let direct = SplineDistortion::approximating(&brown, DOMAIN, 1e-8).unwrap();
        let seen = [direct.distort([DOMAIN[0], DOMAIN[1]]), direct.distort([DOMAIN[2], DOMAIN[3]])];
        let domain = [seen[0][0] - 0.02, seen[0][1] - 0.02, seen[1][0] + 0.02, seen[1][1] + 0.02];
        let inverse = InverseSplineDistortion::approximating(&direct.clone().into(), domain, 1e-8).unwrap();
        prop_assert!(distance(direct.distort([x, y]), inverse.distort([x, y])) < 2e-8);
        // The tolerance holds at samples; between them the difference may be a little larger.
        prop_assert!(distance(direct.distort([x, y]), brown.distort([x, y])) < 1.3e-8);
        let back = SplineDistortion::approximating(&inverse.into(), DOMAIN, 1e-8).unwrap();
        prop_assert!(distance(direct.distort([x, y]), back.distort([x, y])) < 3e-8);
    }
}

fn pinhole() -> Pinhole {
    Pinhole::new([1000.0; 2], [500.0; 2], rotation_from_vector([0.0; 3]), [0.0, 0.0, 2.0]).unwrap()
}

#[test]
fn beyond_its_domain_a_lens_goes_on_linearly_and_is_not_known() {
    let field = field_of([6, 4], |[x, y]| [0.1 * x * x, -0.05 * x * y]);
    let lens = SplineDistortion::new(field.clone());
    let camera = pinhole().with_distortion(lens.clone());
    let [a, b, c] = [0.45, 0.55, 0.65].map(|x| field.value([x, 0.1]));
    assert!((a[0] + c[0] - 2.0 * b[0]).abs() < 1e-14, "a straight line");
    assert!((b[0] - (0.1 * 0.16 + 0.08 * 0.15)).abs() < 1e-12, "with the slope of the border");
    assert!(camera.covers([0.79, 0.1, 0.0]) && !camera.covers([0.81, 0.1, 0.0]));
    let inverse = InverseSplineDistortion::new(field);
    let camera = pinhole().with_distortion(inverse.clone());
    let edge = inverse.undistort([0.4, 0.1]);
    assert!(camera.covers([2.0 * (edge[0] - 1e-9), 2.0 * edge[1], 0.0]));
    assert!(!camera.covers([2.0 * (edge[0] + 1e-9), 2.0 * edge[1], 0.0]));
}

#[test]
fn a_lens_that_folds_is_refused_and_says_so() {
    let folded = Distortion::from(BrownDistortion::new([-5.0, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap());
    let out_of_reach = Err(CameraError::LensOutOfReach { domain: DOMAIN });
    assert_eq!(SplineDistortion::approximating(&folded, DOMAIN, 1e-8), out_of_reach.clone());
    let out_of_reach = Err(CameraError::LensOutOfReach { domain: DOMAIN });
    assert_eq!(InverseSplineDistortion::approximating(&folded, DOMAIN, 1e-8), out_of_reach);
    let steep = field_of([8, 8], |[x, _]| [-6.0 * x * x * x, 0.0]);
    let lens = Distortion::from(SplineDistortion::new(steep.clone()));
    assert!(!lens.folds_within([0.2, 0.0]) && lens.folds_within([0.3, 0.1]));
    assert_eq!(lens.undistort([0.2, 0.0]), None, "x - 6 x^3 stays below 0.16");
    let inverse = Distortion::from(InverseSplineDistortion::new(steep));
    assert!(inverse.distort([0.5, 0.0]).iter().all(|c| c.is_nan()) || inverse.folds_within([0.5, 0.0]));
}

#[test]
fn a_spline_that_is_none_is_refused() {
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
    assert!(SplineField::approximating(DOMAIN, [0, 2], |_| Some([0.0; 2])).is_err());
    let rough = Distortion::from(SplineDistortion::new(field_of([200, 150], |[x, y]| {
        [1e-3 * (300.0 * x).sin(), 1e-3 * (280.0 * y).cos()]
    })));
    let error = SplineDistortion::approximating(&rough, DOMAIN, 1e-12).unwrap_err();
    assert!(matches!(error, CameraError::TooRough { error, .. } if error > 1e-12), "{error}");
}

#[test]
fn a_camera_keeps_its_spline_where_other_parameters_move() {
    let lens = SplineDistortion::new(field_of([4, 4], |[x, y]| [0.01 * x * y, 0.0]));
    let camera = pinhole().with_distortion(lens.clone());
    let moved = camera.moved_by(&[Parameter::Cx, Parameter::Tz], &[2.0, 0.1]).unwrap();
    assert_eq!(moved.distortion(), Some(&lens.into()));
    let error = camera.moved_by(&[Parameter::Cx, Parameter::K1], &[0.0, 0.1]).unwrap_err();
    assert_eq!(error, CameraError::NotOfThisLens { name: "k1" });
}
