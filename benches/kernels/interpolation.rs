//! Interpolation at the points of a raster scan with jitter, per point.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fedic::{Interpolation, Interpolator};
use fedic_benches::{Picture, SENSOR, criterion, jitter};

/// Columns and rows of the scan.
const SCAN: [usize; 2] = [1000, 100];
const ORIGIN: f64 = 500.0;
/// The pixel from which relative coordinates count.
const PIXEL: [isize; 2] = [1000, 550];
/// Points evaluated at once, as many as a cell has.
const CELL: usize = 400;

fn interpolation(c: &mut Criterion) {
    let picture = Picture::new(SENSOR, [0.0; 2]);
    let count = SCAN[0] * SCAN[1];
    let noise: Vec<f64> = jitter(2 * count).collect();
    let scan = |place: fn(usize) -> usize, noise: &[f64]| -> Vec<f64> {
        noise.iter().enumerate().map(|(index, noise)| ORIGIN + place(index) as f64 + noise).collect()
    };
    let u = scan(|index| index % SCAN[0], &noise[..count]);
    let v = scan(|index| index / SCAN[0], &noise[count..]);
    let near = |place: &[f64], pixel: isize| -> Vec<f32> { place.iter().map(|x| (x - pixel as f64) as f32).collect() };
    let (near_u, near_v) = (near(&u, PIXEL[0]), near(&v, PIXEL[1]));
    let (mut value, mut du, mut dv) = (vec![0.0; count], vec![0.0; count], vec![0.0; count]);

    let mut group = c.benchmark_group("interpolation");
    group.throughput(Throughput::Elements(count as u64));
    for interpolation in Interpolation::ALL {
        let interpolator = Interpolator::new(picture.view(), interpolation);
        group.bench_function(format!("values/{interpolation}"), |b| b.iter(|| interpolator.values(&u, &v, &mut value)));
        group.bench_function(format!("values_near/{interpolation}"), |b| {
            b.iter(|| {
                for (index, value) in value.chunks_mut(CELL).enumerate() {
                    let points = index * CELL..index * CELL + value.len();
                    interpolator.values_near(PIXEL, &near_u[points.clone()], &near_v[points], value);
                }
            });
        });
        group.bench_function(format!("values_and_gradients_near/{interpolation}"), |b| {
            b.iter(|| interpolator.values_and_gradients_near(PIXEL, &near_u, &near_v, &mut value, &mut du, &mut dv));
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = criterion(); targets = interpolation }
criterion_main!(benches);
