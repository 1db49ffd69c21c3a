//! Interpolators apart from the interpolation: independent points, smoothing, reuse of memory, prefetching.

#![allow(clippy::unwrap_used)]

mod common;

use common::{gradient_at, noise, value_at};
use fedic_image::{Interpolation, Interpolator};

#[test]
fn points_are_evaluated_independently_of_each_other() {
    let image = noise(20, 20);
    let u: Vec<f64> = (0..101).map(|i| if i % 7 == 3 { f64::NAN } else { f64::from(i) * 0.19 }).collect();
    let v: Vec<f64> = (0..101).map(|i| 19.0 - f64::from(i) * 0.18).collect();
    for interpolation in Interpolation::ALL {
        let interpolator = Interpolator::new(image.view(), interpolation);
        let (mut values, mut same, mut du, mut dv) = (vec![0.0; 101], vec![0.0; 101], vec![0.0; 101], vec![0.0; 101]);
        interpolator.values(&u, &v, &mut values);
        interpolator.values_and_gradients(&u, &v, &mut same, &mut du, &mut dv);
        for i in 0..101 {
            let single = gradient_at(&interpolator, u[i], v[i]).map(|x| (x as f32).to_bits());
            assert_eq!([same[i], du[i], dv[i]].map(f32::to_bits), single, "{interpolation}, point {i}");
            assert_eq!(values[i].to_bits(), same[i].to_bits(), "{interpolation}, point {i}");
        }
    }
}

#[test]
fn any_region_may_be_prefetched() {
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
#[should_panic(expected = "u, v and each output must have one element per point")]
fn slices_of_different_lengths_panic() {
    let image = noise(8, 8);
    Interpolator::new(image.view(), Interpolation::Bilinear).values(&[1.0, 2.0], &[1.0, 2.0], &mut [0.0]);
}

#[test]
fn preparation_with_smoothing_equals_smoothing_first() {
    for (width, height) in [(5, 300), (43, 150), (157, 6)] {
        let image = noise(width, height);
        let u: Vec<f64> = (0..width * height).map(|index| (index % width) as f64 + 0.3).collect();
        let v: Vec<f64> = (0..width * height).map(|index| (index / width) as f64 - 0.4).collect();
        let (mut combined, mut separate) = (vec![0.0; u.len()], vec![0.0; u.len()]);
        for interpolation in Interpolation::ALL {
            for smoothing in [0.0, 0.8, 2.1] {
                Interpolator::smoothed(image.view(), interpolation, smoothing).unwrap().values(&u, &v, &mut combined);
                let smooth = fedic_image::gaussian_filter(image.view(), smoothing).unwrap();
                Interpolator::new(smooth.view(), interpolation).values(&u, &v, &mut separate);
                for (a, b) in combined.iter().zip(&separate) {
                    assert!((a - b).abs() < 1e-3, "{interpolation}, {smoothing}, {width} x {height}: {a} {b}");
                }
            }
        }
    }
}

#[test]
fn a_renewed_interpolator_equals_a_new_one() {
    let u: Vec<f64> = (0..300).map(|index| f64::from(index % 40) - 0.4).collect();
    let v: Vec<f64> = (0..300).map(|index| f64::from(index / 12) + 0.1).collect();
    let evaluate = |interpolator: &Interpolator| {
        let mut values = vec![0.0; u.len()];
        interpolator.values(&u, &v, &mut values);
        values.into_iter().map(f32::to_bits).collect::<Vec<_>>()
    };
    let next = noise(43, 30);
    for interpolation in Interpolation::ALL {
        for (width, height) in [(43, 30), (60, 50), (12, 9)] {
            let before = Interpolator::smoothed(noise(width, height).view(), interpolation, 0.0).unwrap();
            let renewed = before.renewed(next.view(), 0.8).unwrap();
            assert_eq!(
                evaluate(&renewed),
                evaluate(&Interpolator::smoothed(next.view(), interpolation, 0.8).unwrap()),
                "{interpolation}"
            );
            assert!(renewed.renewed(next.view(), -1.0).is_err());
        }
    }
}
