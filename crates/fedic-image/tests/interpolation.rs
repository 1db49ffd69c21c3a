//! What every interpolation must satisfy, seen from outside.

#![allow(clippy::unwrap_used)]

mod common;

use common::{image_of, noise};
use fedic_image::{Image, Interpolation, Interpolator};
use proptest::prelude::*;

fn value_at(interpolator: &Interpolator, u: f64, v: f64) -> f64 {
    let mut value = [0.0];
    interpolator.values(&[u], &[v], &mut value);
    f64::from(value[0])
}

fn gradient_at(interpolator: &Interpolator, u: f64, v: f64) -> [f64; 3] {
    let (mut value, mut du, mut dv) = ([0.0], [0.0], [0.0]);
    interpolator.values_and_gradients(&[u], &[v], &mut value, &mut du, &mut dv);
    [value[0], du[0], dv[0]].map(f64::from)
}

#[test]
fn pixels_are_reproduced() {
    let image = noise(43, 150);
    let u: Vec<f64> = (0..43 * 150).map(|index| (index % 43) as f64).collect();
    let v: Vec<f64> = (0..43 * 150).map(|index| (index / 43) as f64).collect();
    let mut values = vec![0.0; u.len()];
    for kind in Interpolation::ALL {
        Interpolator::new(image.view(), kind).values(&u, &v, &mut values);
        for (value, level) in values.iter().zip(image.pixels()) {
            assert!((value - level).abs() < 1e-3, "{kind}: {value} instead of {level}");
        }
    }
}

/// `scipy.ndimage.map_coordinates(image, [v, u], order=3 and 5, mode="mirror")` of SciPy 1.17.1, rounded to four decimals.
#[test]
fn splines_agree_with_scipy() {
    let image = image_of(7, 6, |u, v| ((37 * u + 91 * v + 13 * u * v) % 256) as f64);
    let u = [0.0, 1.25, -0.4, 6.3, 3.5, 2.75];
    let v = [0.0, 2.5, 0.3, 5.4, -0.5, 4.1];
    let cases = [
        (Interpolation::Bspline3, [0.0, 152.4464, 18.2169, 75.7637, 132.8465, 80.6784]),
        (Interpolation::Bspline5, [0.0, 143.8826, 15.9641, 73.5714, 132.9523, 71.1312]),
    ];
    for (kind, expected) in cases {
        let mut values = [0.0; 6];
        Interpolator::new(image.view(), kind).values(&u, &v, &mut values);
        for (value, expected) in values.into_iter().zip(expected) {
            assert!((f64::from(value) - expected).abs() < 2e-4, "{kind}: {value} instead of {expected}");
        }
    }
}

/// Largest errors of the value and of the gradient, near the centre, for `((u - 32) / 8)^degree` along both directions.
fn error_on_monomials(kind: Interpolation, degree: i32) -> (f64, f64) {
    let power = |x: f64| ((x - 32.0) / 8.0).powi(degree);
    let slope = |x: f64| f64::from(degree) / 8.0 * ((x - 32.0) / 8.0).powi(degree - 1);
    let interpolator = Interpolator::new(image_of(65, 65, |u, v| power(u as f64) + power(v as f64)).view(), kind);
    let mut errors = (0.0_f64, 0.0_f64);
    for step in 0..=80 {
        let (u, v) = (28.0 + 0.1 * f64::from(step), 35.5 - 0.09 * f64::from(step));
        let [value, du, dv] = gradient_at(&interpolator, u, v);
        errors.0 = errors.0.max((value - power(u) - power(v)).abs());
        errors.1 = errors.1.max((du - slope(u)).abs()).max((dv - slope(v)).abs());
    }
    errors
}

#[test]
fn polynomials_are_reproduced_up_to_the_order_of_the_kernel() {
    for (kind, degree) in [
        (Interpolation::Bilinear, 1),
        (Interpolation::Bicubic, 2),
        (Interpolation::Bspline3, 3),
        (Interpolation::Bspline5, 5),
    ] {
        for degree in 1..=degree {
            let (value, slope) = error_on_monomials(kind, degree);
            assert!(value < 2e-6, "{kind}, degree {degree}: value off by {value}");
            assert!(slope < 4e-6, "{kind}, degree {degree}: slope off by {slope}");
        }
    }
}

#[test]
fn polynomials_beyond_the_order_are_not() {
    for (kind, degree) in [(Interpolation::Bilinear, 2), (Interpolation::Bicubic, 3), (Interpolation::Bspline3, 4)] {
        let (value, _) = error_on_monomials(kind, degree);
        assert!(value > 4e-6, "{kind}, degree {degree}: value off by only {value}");
    }
}

#[test]
fn the_domain_is_the_extent_of_the_pixels() {
    let image = noise(9, 7);
    let inside = [(-0.5, -0.5), (8.5, 6.5), (0.0, 6.5), (3.2, 4.1)];
    let outside = [
        (-0.5_f64.next_up(), 2.0),
        (8.5_f64.next_up(), 2.0),
        (2.0, -0.500_001),
        (2.0, 6.5_f64.next_up()),
        (f64::NAN, 2.0),
        (2.0, f64::NAN),
        (f64::INFINITY, 2.0),
        (2.0, f64::NEG_INFINITY),
        (1e300, -1e300),
    ];
    for kind in Interpolation::ALL {
        let interpolator = Interpolator::new(image.view(), kind);
        for (u, v) in inside {
            assert!(interpolator.contains(u, v));
            assert!(value_at(&interpolator, u, v).is_finite(), "{kind} at ({u}, {v})");
            assert!(gradient_at(&interpolator, u, v).iter().all(|x| x.is_finite()), "{kind} at ({u}, {v})");
        }
        for (u, v) in outside {
            assert!(!interpolator.contains(u, v), "({u}, {v})");
            assert!(value_at(&interpolator, u, v).is_nan(), "{kind} at ({u}, {v})");
            assert!(gradient_at(&interpolator, u, v).iter().all(|x| x.is_nan()), "{kind} at ({u}, {v})");
        }
    }
}

#[test]
fn points_do_not_depend_on_their_neighbours() {
    let image = noise(20, 20);
    let u: Vec<f64> = (0..101).map(|i| if i % 7 == 3 { f64::NAN } else { f64::from(i) * 0.19 }).collect();
    let v: Vec<f64> = (0..101).map(|i| 19.0 - f64::from(i) * 0.18).collect();
    for kind in Interpolation::ALL {
        let interpolator = Interpolator::new(image.view(), kind);
        let (mut values, mut same, mut du, mut dv) = (vec![0.0; 101], vec![0.0; 101], vec![0.0; 101], vec![0.0; 101]);
        interpolator.values(&u, &v, &mut values);
        interpolator.values_and_gradients(&u, &v, &mut same, &mut du, &mut dv);
        for i in 0..101 {
            let alone = gradient_at(&interpolator, u[i], v[i]).map(|x| (x as f32).to_bits());
            assert_eq!([same[i], du[i], dv[i]].map(f32::to_bits), alone, "{kind}, point {i}");
            assert_eq!(values[i].to_bits(), same[i].to_bits(), "{kind}, point {i}");
        }
    }
}

#[test]
fn anything_may_be_asked_for_in_advance() {
    let interpolator = Interpolator::new(noise(40, 30).view(), Interpolation::Bspline5);
    let before = value_at(&interpolator, 20.3, 10.6);
    let ends = [f64::NEG_INFINITY, -1e300, -5.0, 0.0, 12.5, 39.5, 1e5, 1e300, f64::INFINITY, f64::NAN];
    for low in ends {
        for high in ends {
            interpolator.prefetch([low, high], [high, low]);
            interpolator.prefetch([low, 3.0], [high, 8.0]);
        }
    }
    assert_eq!(value_at(&interpolator, 20.3, 10.6), before);
}

#[test]
#[should_panic(expected = "one u, one v and one of each reading for each point")]
fn lengths_must_agree() {
    let image = noise(8, 8);
    Interpolator::new(image.view(), Interpolation::Bilinear).values(&[1.0, 2.0], &[1.0, 2.0], &mut [0.0]);
}

fn textures() -> (Image, Image) {
    (noise(30, 24), image_of(30, 24, |u, v| 128.0 + 100.0 * (0.9 * u as f64).sin() * (0.7 * v as f64).cos()))
}

proptest! {
    #[test]
    fn gradients_are_the_derivatives_of_the_values(
        (column, row) in (0..29_u8, 0..23_u8),
        (fraction_u, fraction_v) in (0.02..0.98_f64, 0.02..0.98_f64),
    ) {
        let (u, v) = (f64::from(column) + fraction_u, f64::from(row) + fraction_v);
        let step = 0.01;
        let (rough, smooth) = textures();
        for (image, tolerance) in [(rough, 0.2), (smooth, 0.03)] {
            for kind in Interpolation::ALL {
                let interpolator = Interpolator::new(image.view(), kind);
                let [value, du, dv] = gradient_at(&interpolator, u, v);
                let difference = |plus: f64, minus: f64| (plus - minus) / (2.0 * step);
                let across = difference(value_at(&interpolator, u + step, v), value_at(&interpolator, u - step, v));
                let down = difference(value_at(&interpolator, u, v + step), value_at(&interpolator, u, v - step));
                prop_assert_eq!(value, value_at(&interpolator, u, v));
                prop_assert!((du - across).abs() < tolerance, "{} at ({}, {}): {} {}", kind, u, v, du, across);
                prop_assert!((dv - down).abs() < tolerance, "{} at ({}, {}): {} {}", kind, u, v, dv, down);
            }
        }
    }

    #[test]
    fn the_border_is_a_mirror(distance in 0.001..0.5_f64, along in 0.0..20.0_f64) {
        let image = noise(30, 24);
        for kind in Interpolation::ALL {
            let interpolator = Interpolator::new(image.view(), kind);
            for (edge, sign) in [(0.0, 1.0), (29.0, -1.0)] {
                let [outer, du_outer, dv_outer] = gradient_at(&interpolator, edge - sign * distance, along);
                let [inner, du_inner, dv_inner] = gradient_at(&interpolator, edge + sign * distance, along);
                prop_assert!((outer - inner).abs() < 1e-3, "{}", kind);
                prop_assert!((du_outer + du_inner).abs() < 2e-3, "{}: {} {}", kind, du_outer, du_inner);
                prop_assert!((dv_outer - dv_inner).abs() < 2e-3, "{}", kind);
            }
            for (edge, sign) in [(0.0, 1.0), (23.0, -1.0)] {
                let [outer, _, dv_outer] = gradient_at(&interpolator, along, edge - sign * distance);
                let [inner, _, dv_inner] = gradient_at(&interpolator, along, edge + sign * distance);
                prop_assert!((outer - inner).abs() < 1e-3, "{}", kind);
                prop_assert!((dv_outer + dv_inner).abs() < 2e-3, "{}: {} {}", kind, dv_outer, dv_inner);
            }
        }
    }
}

#[test]
fn smoothing_on_the_way_is_smoothing_first() {
    for (width, height) in [(5, 300), (43, 150), (157, 6)] {
        let image = noise(width, height);
        let u: Vec<f64> = (0..width * height).map(|index| (index % width) as f64 + 0.3).collect();
        let v: Vec<f64> = (0..width * height).map(|index| (index / width) as f64 - 0.4).collect();
        let (mut on_the_way, mut first) = (vec![0.0; u.len()], vec![0.0; u.len()]);
        for kind in Interpolation::ALL {
            for sigma in [0.0, 0.8, 2.1] {
                Interpolator::smoothed(image.view(), kind, sigma).unwrap().values(&u, &v, &mut on_the_way);
                let smooth = fedic_image::gaussian_filter(image.view(), sigma).unwrap();
                Interpolator::new(smooth.view(), kind).values(&u, &v, &mut first);
                for (a, b) in on_the_way.iter().zip(&first) {
                    assert!((a - b).abs() < 1e-3, "{kind}, {sigma}, {width} x {height}: {a} {b}");
                }
            }
        }
    }
}

#[test]
fn the_next_image_is_read_as_if_nothing_had_been_there() {
    let u: Vec<f64> = (0..300).map(|index| f64::from(index % 40) - 0.4).collect();
    let v: Vec<f64> = (0..300).map(|index| f64::from(index / 12) + 0.1).collect();
    let read = |interpolator: &Interpolator| {
        let mut values = vec![0.0; u.len()];
        interpolator.values(&u, &v, &mut values);
        values.into_iter().map(f32::to_bits).collect::<Vec<_>>()
    };
    let next = noise(43, 30);
    for kind in Interpolation::ALL {
        for (width, height) in [(43, 30), (60, 50), (12, 9)] {
            let before = Interpolator::smoothed(noise(width, height).view(), kind, 0.0).unwrap();
            let renewed = before.renewed(next.view(), 0.8).unwrap();
            assert_eq!(read(&renewed), read(&Interpolator::smoothed(next.view(), kind, 0.8).unwrap()), "{kind}");
            assert!(renewed.renewed(next.view(), -1.0).is_err());
        }
    }
}
