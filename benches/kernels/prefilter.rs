//! Preparation of an image of 5 megapixels for interpolation, and Gaussian smoothing, per pixel.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fedic::{Interpolation, Interpolator, gaussian_filter};
use fedic_benches::{Picture, SENSOR, criterion, pool};

fn prefilter(c: &mut Criterion) {
    let picture = Picture::new(SENSOR, [0.0; 2]);
    let mut group = c.benchmark_group("prefilter");
    group.throughput(Throughput::Elements(picture.len()));
    for threads in [1, 2] {
        let pool = pool(threads);
        for interpolation in [Interpolation::Bspline3, Interpolation::Bspline5] {
            group.bench_function(format!("{interpolation}/{threads}"), |b| {
                pool.install(|| b.iter(|| Interpolator::new(picture.view(), interpolation)));
            });
        }
        group.bench_function(format!("gaussian/{threads}"), |b| {
            pool.install(|| b.iter(|| gaussian_filter(picture.view(), 0.8).unwrap()));
        });
        group.bench_function(format!("smoothed/{threads}"), |b| {
            pool.install(|| b.iter(|| Interpolator::smoothed(picture.view(), Interpolation::Bspline5, 0.8).unwrap()));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = criterion(); targets = prefilter }
criterion_main!(benches);
