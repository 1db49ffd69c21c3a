//! Projecting points into the image, with and without the Jacobian, per point.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fedic::{BrownDistortion, Camera, FrontParallel, ImageFrame};
use fedic_benches::{DISTANCE, FOCAL, SENSOR, criterion, jitter, lens, pinhole};

/// Points per call: few enough to stay in cache, as in a correlation.
const COUNT: usize = 256;

fn projection(c: &mut Criterion) {
    let brown = BrownDistortion::new([-0.03, 0.01, 0.002], [1e-4, -2e-4], [3e-4, 1e-4]).unwrap();
    let cameras: [(&str, Box<dyn Camera>); 5] = [
        ("image_frame", Box::new(ImageFrame)),
        ("front_parallel", Box::new(FrontParallel::new(FOCAL / DISTANCE, [1224.0, 1024.0]).unwrap())),
        ("pinhole", Box::new(pinhole(SENSOR))),
        ("pinhole_radial", Box::new(pinhole(SENSOR).with_distortion(lens()))),
        ("pinhole_brown", Box::new(pinhole(SENSOR).with_distortion(brown))),
    ];
    let x: Vec<f64> = jitter(COUNT).map(|noise| 400.0 * noise).collect();
    let y: Vec<f64> = x.iter().rev().copied().collect();
    let z = vec![0.0; COUNT];
    let (mut u, mut v) = (vec![0.0; COUNT], vec![0.0; COUNT]);
    let mut entries = vec![0.0; 6 * COUNT];

    let mut group = c.benchmark_group("projection");
    group.throughput(Throughput::Elements(COUNT as u64));
    for (name, camera) in &cameras {
        group.bench_function(format!("points/{name}"), |b| {
            b.iter(|| camera.project_batch(&x, &y, &z, &mut u, &mut v));
        });
        let mut slices = entries.chunks_mut(COUNT);
        let mut jacobian = [(); 2].map(|()| [(); 3].map(|()| slices.next().unwrap()));
        group.bench_function(format!("with_jacobian/{name}"), |b| {
            b.iter(|| camera.project_with_jacobian_batch(&x, &y, &z, &mut u, &mut v, &mut jacobian));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = criterion(); targets = projection }
criterion_main!(benches);
