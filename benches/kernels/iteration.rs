//! Correlating a pair of 5 megapixels, per quadrature point and iteration: 20 px quads, cubic B-spline, pinhole with one
//! radial coefficient.
//!
//! `correlate/1` is a whole measurement of one iteration: coefficients of the deformed image, residual, right-hand side,
//! solution. In `correlate/5` the coefficients are shared by five iterations; a start so near is left as it is. `stream` only
//! reads what an iteration reads from memory, and nothing else: no iteration can be faster.

#![allow(clippy::unwrap_used, missing_docs)]

use std::hint::black_box;
use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fedic::{CellType, Correlator, Interpolation, Options, Start};
use fedic_benches::{DISTANCE, FOCAL, Picture, SENSOR, criterion, lens, pinhole, pool, world_mesh};
use rayon::prelude::*;

/// How far the texture moved, in pixels.
const SHIFT: [f64; 2] = [1.3, -0.7];
/// What is kept of a quadrature point: grey level and, in half as many bytes each, gradient of the reference image.
const FLOATS_PER_POINT: usize = 2;
/// Numbers read by one task of the stream.
const CHUNK: usize = 1 << 14;

fn iteration(c: &mut Criterion) {
    let (reference, deformed) = (Arc::new(Picture::new(SENSOR, [0.0; 2])), Picture::new(SENSOR, SHIFT));
    let mesh = world_mesh(SENSOR, CellType::Quad);
    let unit = DISTANCE / FOCAL;
    let field = vec![[SHIFT[0] * unit, -SHIFT[1] * unit]; mesh.num_nodes()];
    let mut group = c.benchmark_group("iteration");
    for threads in [1, 2] {
        let mut num_points = 0;
        for iterations in [1, 5] {
            let options = Options::default()
                .interpolation(Interpolation::Bspline3)
                .smoothing(0.0)
                .num_threads(Some(threads))
                .max_iterations(iterations)
                .tolerance(f64::MIN_POSITIVE);
            let camera = Arc::new(pinhole(SENSOR).with_distortion(lens()));
            let correlator = Correlator::new(reference.clone(), &mesh, camera, options).unwrap();
            let correlate = || correlator.correlate(deformed.view(), Start::Field(&field)).unwrap();
            assert_eq!(correlate().iterations, iterations);
            num_points = correlator.num_points();
            group.throughput(Throughput::Elements((num_points * iterations) as u64));
            group.bench_function(format!("correlate/{iterations}/{threads}"), |b| b.iter(correlate));
        }
        let points = vec![1.0_f32; FLOATS_PER_POINT * num_points];
        let coefficients = vec![1.0_f32; deformed.len() as usize];
        let pool = pool(threads);
        group.throughput(Throughput::Elements(num_points as u64));
        group.bench_function(format!("stream/{threads}"), |b| {
            pool.install(|| b.iter(|| total(black_box(&points)) + total(black_box(&coefficients))));
        });
    }
    group.finish();
}

fn total(numbers: &[f32]) -> f32 {
    numbers.par_chunks(CHUNK).map(lane_total).sum()
}

/// The sum in sixteen interleaved parts, that the processor adds side by side.
fn lane_total(numbers: &[f32]) -> f32 {
    let mut lanes = [0.0; 16];
    for block in numbers.as_chunks().0 {
        let block: &[f32; 16] = block;
        lanes.iter_mut().zip(block).for_each(|(lane, number)| *lane += number);
    }
    lanes.iter().sum()
}

criterion_group! { name = benches; config = criterion(); targets = iteration }
criterion_main!(benches);
