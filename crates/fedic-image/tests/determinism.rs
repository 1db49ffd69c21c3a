//! Results are independent of the number of threads.

#![allow(clippy::unwrap_used)]

mod common;

use common::noise;
use fedic_image::{Interpolation, Interpolator, central_differences, downsample, gaussian_filter};
use rayon::ThreadPoolBuilder;

/// Bits of every result that this crate computes in parallel, for an image of several bands.
fn all_results() -> Vec<u64> {
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
    for interpolation in Interpolation::ALL {
        Interpolator::new(view, interpolation).values(&u, &v, &mut values);
        bits.extend(values.iter().map(|level| u64::from(level.to_bits())));
    }
    bits
}

#[test]
fn results_have_the_same_bits_for_any_number_of_threads() {
    let on = |threads| ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(all_results);
    let expected = on(1);
    for threads in [2, 3, 4] {
        assert!(on(threads) == expected, "{threads} threads");
    }
}
