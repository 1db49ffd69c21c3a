//! The properties that every interpolation of [`Interpolation::ALL`] must have.

#![allow(clippy::unwrap_used)]

mod common;

use common::{gradient_at, image_of, noise, value_at};
use fedic_image::{Image, Interpolation, Interpolator};
use proptest::prelude::*;

#[test]
fn pixels_are_reproduced() {
    let image = noise(43, 150);
    let u: Vec<f64> = (0..43 * 150).map(|index| (index % 43) as f64).collect();
    let v: Vec<f64> = (0..43 * 150).map(|index| (index / 43) as f64).collect();
    let mut values = vec![0.0; u.len()];
    for interpolation in Interpolation::ALL {
        Interpolator::new(image.view(), interpolation).values(&u, &v, &mut values);
        for (value, level) in values.iter().zip(image.pixels()) {
            assert!((value - level).abs() < 1e-3, "{interpolation}: {value} instead of {level}");
        }
    }
}

/// Values and derivatives of an interpolation at [`POINTS`].
struct Reference {
    name: &'static str,
    values: [f64; 6],
    du: [f64; 6],
    dv: [f64; 6],
}

/// Coordinates `(u, v)` in the image of 7 x 6 pixels `(37 u + 91 v + 13 u v) mod 256`.
const POINTS: [[f64; 6]; 2] = [[4.6, 1.25, -0.4, 6.3, 3.5, 2.75], [1.3, 2.5, 0.3, 5.4, -0.5, 4.1]];

/// `scipy.ndimage.map_coordinates(image, [v, u], order=1, 3 and 5, mode="mirror")` of SciPy 1.17.1 and its central
/// differences with a step of 1e-4; for `bicubic`, Keys' kernel summed by NumPy over `numpy.pad(image, 4, "reflect")`.
/// Rounded to four decimals.
const REFERENCES: [Reference; 4] = [
    Reference {
        name: "bilinear",
        values: [110.24, 154.375, 43.66, 94.84, 133.75, 109.425],
        du: [53.9, -58.5, -40.9, 56.8, -84.5, 90.3],
        dv: [150.8, -84.75, 96.2, 14.1, -8.5, 126.75],
    },
    Reference {
        name: "bicubic",
        values: [95.1903, 160.375, 23.5171, 80.2101, 132.6875, 94.8698],
        du: [90.4594, -66.5, -42.3774, 88.4693, -118.125, 128.625],
        dv: [223.4323, -134.75, 85.6975, 27.5986, -10.625, 80.6175],
    },
    Reference {
        name: "bspline3",
        values: [88.154, 152.4464, 18.2169, 75.7637, 132.8465, 80.6784],
        du: [87.3697, -59.7461, -38.1083, 98.57, -108.1345, 159.7015],
        dv: [241.1516, -130.9205, 63.0343, 15.3297, -9.908, 100.5201],
    },
    Reference {
        name: "bspline5",
        values: [80.3731, 143.8826, 15.9641, 73.5714, 132.9523, 71.1312],
        du: [85.555, -56.8572, -36.8886, 105.0478, -107.8065, 188.5365],
        dv: [239.3107, -140.0434, 54.3004, 15.671, -8.199, 112.0747],
    },
];

#[test]
fn values_and_gradients_agree_with_scipy() {
    let image = image_of(7, 6, |u, v| ((37 * u + 91 * v + 13 * u * v) % 256) as f64);
    assert_eq!(REFERENCES.map(|reference| reference.name), Interpolation::NAMES, "one reference per interpolation");
    for (interpolation, reference) in Interpolation::ALL.into_iter().zip(REFERENCES) {
        let (mut values, mut du, mut dv) = ([0.0; 6], [0.0; 6], [0.0; 6]);
        let interpolator = Interpolator::new(image.view(), interpolation);
        interpolator.values_and_gradients(&POINTS[0], &POINTS[1], &mut values, &mut du, &mut dv);
        for (found, expected) in [(values, reference.values), (du, reference.du), (dv, reference.dv)] {
            for (found, expected) in found.into_iter().zip(expected) {
                let error = (f64::from(found) - expected).abs();
                assert!(error < 4e-4, "{interpolation}: {found} instead of {expected}");
            }
        }
    }
}

/// Largest errors of the value and of the gradient of `((u - 64) / 2)^degree + ((v - 64) / 2)^degree` within two pixels of
/// the centre.
fn error_on_monomials(interpolation: Interpolation, degree: u32) -> (f64, f64) {
    let power = |x: f64| ((x - 64.0) / 2.0).powi(degree as i32);
    let derivative = |x: f64| f64::from(degree) / 2.0 * ((x - 64.0) / 2.0).powi(degree as i32 - 1);
    let image = image_of(129, 129, |u, v| power(u as f64) + power(v as f64));
    let interpolator = Interpolator::new(image.view(), interpolation);
    let mut errors = (0.0_f64, 0.0_f64);
    for step in 0..=80 {
        let (u, v) = (62.0 + 0.049 * f64::from(step), 66.0 - 0.047 * f64::from(step));
        let [value, du, dv] = gradient_at(&interpolator, u, v);
        errors.0 = errors.0.max((value - power(u) - power(v)).abs());
        errors.1 = errors.1.max((du - derivative(u)).abs()).max((dv - derivative(v)).abs());
    }
    errors
}

#[test]
fn polynomials_are_reproduced_up_to_the_exact_degree() {
    for interpolation in Interpolation::ALL {
        for degree in 1..=interpolation.exact_degree() {
            let (value, derivative) = error_on_monomials(interpolation, degree);
            assert!(value < 2e-5, "{interpolation}, degree {degree}: error of the value {value}");
            assert!(derivative < 4e-5, "{interpolation}, degree {degree}: error of the derivative {derivative}");
        }
        let (value, _) = error_on_monomials(interpolation, interpolation.exact_degree() + 1);
        assert!(value > 1e-4, "{interpolation}, degree {}: error {value}", interpolation.exact_degree() + 1);
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
    for interpolation in Interpolation::ALL {
        let interpolator = Interpolator::new(image.view(), interpolation);
        for (u, v) in inside {
            assert!(interpolator.contains(u, v));
            assert!(value_at(&interpolator, u, v).is_finite(), "{interpolation} at ({u}, {v})");
            let finite = gradient_at(&interpolator, u, v).iter().all(|x| x.is_finite());
            assert!(finite, "{interpolation} at ({u}, {v})");
        }
        for (u, v) in outside {
            assert!(!interpolator.contains(u, v), "({u}, {v})");
            assert!(value_at(&interpolator, u, v).is_nan(), "{interpolation} at ({u}, {v})");
            assert!(gradient_at(&interpolator, u, v).iter().all(|x| x.is_nan()), "{interpolation} at ({u}, {v})");
        }
    }
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
            for interpolation in Interpolation::ALL {
                let interpolator = Interpolator::new(image.view(), interpolation);
                let [value, du, dv] = gradient_at(&interpolator, u, v);
                let difference = |plus: f64, minus: f64| (plus - minus) / (2.0 * step);
                let along_u = difference(value_at(&interpolator, u + step, v), value_at(&interpolator, u - step, v));
                let along_v = difference(value_at(&interpolator, u, v + step), value_at(&interpolator, u, v - step));
                prop_assert_eq!(value, value_at(&interpolator, u, v));
                prop_assert!((du - along_u).abs() < tolerance, "{} at ({}, {}): {} {}", interpolation, u, v, du, along_u);
                prop_assert!((dv - along_v).abs() < tolerance, "{} at ({}, {}): {} {}", interpolation, u, v, dv, along_v);
            }
        }
    }

    #[test]
    fn the_border_is_mirrored(distance in 0.001..0.5_f64, along in 0.0..20.0_f64) {
        let image = noise(30, 24);
        for interpolation in Interpolation::ALL {
            let interpolator = Interpolator::new(image.view(), interpolation);
            for (edge, sign) in [(0.0, 1.0), (29.0, -1.0)] {
                let [outer, du_outer, dv_outer] = gradient_at(&interpolator, edge - sign * distance, along);
                let [inner, du_inner, dv_inner] = gradient_at(&interpolator, edge + sign * distance, along);
                prop_assert!((outer - inner).abs() < 1e-3, "{}", interpolation);
                prop_assert!((du_outer + du_inner).abs() < 2e-3, "{}: {} {}", interpolation, du_outer, du_inner);
                prop_assert!((dv_outer - dv_inner).abs() < 2e-3, "{}", interpolation);
            }
            for (edge, sign) in [(0.0, 1.0), (23.0, -1.0)] {
                let [outer, _, dv_outer] = gradient_at(&interpolator, along, edge - sign * distance);
                let [inner, _, dv_inner] = gradient_at(&interpolator, along, edge + sign * distance);
                prop_assert!((outer - inner).abs() < 1e-3, "{}", interpolation);
                prop_assert!((dv_outer + dv_inner).abs() < 2e-3, "{}: {} {}", interpolation, dv_outer, dv_inner);
            }
        }
    }
}
