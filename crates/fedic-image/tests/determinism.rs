//! The number of threads leaves no trace in any result.

#![allow(clippy::unwrap_used)]

mod common;

use common::noise;
use fedic_image::{Interpolation, Interpolator, central_differences, downsample, gaussian_filter};
use rayon::ThreadPoolBuilder;

/// Bits of everything this crate computes in parallel, for an image of several bands.
fn everything() -> Vec<u64> {
    let image = noise(157, 401);
    let view = image.view();
    let (mean, deviation) = view.statistics();
    let mut bits = vec![mean.to_bits(), deviation.to_bits()];
    let (du, dv) = central_differences(view);
    for image in [gaussian_filter(view, 1.7).unwrap(), downsample(view).unwrap(), du, dv] {
        bits.extend(image.pixels().iter().map(|level| u64::from(level.to_bits())));
    }
    let u: Vec<f64> = (0..157 * 401).map(|index| (index % 157) as f64 + 0.3).collect();
    let v: Vec<f64> = (0..157 * 401).map(|index| (index / 157) as f64 - 0.4).collect();
    let mut values = vec![0.0; u.len()];
    for kind in Interpolation::ALL {
        Interpolator::new(view, kind).values(&u, &v, &mut values);
        bits.extend(values.iter().map(|level| u64::from(level.to_bits())));
    }
    bits
}

#[test]
fn same_bits_with_any_number_of_threads() {
    let on = |threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(everything);
    let alone = on(1);
    for threads in [2, 3, 4] {
        assert!(on(threads) == alone, "{threads} threads give other bits than one");
    }
}
