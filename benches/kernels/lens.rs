//! What a lens costs: correlating a pair of 5 megapixels, five iterations, one thread, per quadrature point and iteration,
//! behind a lens of one radial coefficient and behind the same with waves of half a pixel, as a spline and as its inverse.
//!
//! 20 px quads, cubic B-spline, as in `iteration`.

#![allow(clippy::unwrap_used, missing_docs)]

use std::sync::Arc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use fedic::{
    CellType, Correlator, Distortion, Interpolation, InverseSplineDistortion, Lens, Options, SplineDistortion,
    SplineField, Start,
};
use fedic_benches::{DISTANCE, FOCAL, Picture, SENSOR, criterion, lens, pinhole, world_mesh};

/// How far the texture moved, in pixels.
const SHIFT: [f64; 2] = [1.3, -0.7];
const ITERATIONS: usize = 5;
/// Wavelength and amplitude, in pixels.
const WAVE: [f64; 2] = [500.0, 0.5];
/// Of the spline: as many as a calibration takes.
const INTERVALS: [usize; 2] = [16, 13];

/// The image in normalised coordinates.
fn domain() -> [f64; 4] {
    let [x, y] = SENSOR.map(|pixels| 0.5 * pixels as f64 / FOCAL);
    [-x, -y, x, y]
}

/// The radial lens and waves.
fn wavy() -> SplineDistortion {
    let (wave, amplitude) = (std::f64::consts::TAU * FOCAL / WAVE[0], WAVE[1] / FOCAL);
    let displacement = |[x, y]: [f64; 2]| {
        let [u, v] = lens().distort([x, y]);
        Some([u - x + amplitude * (wave * x).sin(), v - y + amplitude * (wave * y).cos()])
    };
    let field = SplineField::fit(domain(), INTERVALS, displacement);
    SplineDistortion::new(field.unwrap().unwrap())
}

fn lenses(c: &mut Criterion) {
    let (reference, deformed) = (Arc::new(Picture::new(SENSOR, [0.0; 2])), Picture::new(SENSOR, SHIFT));
    let mesh = world_mesh(SENSOR, CellType::Quad);
    let unit = DISTANCE / FOCAL;
    let field = vec![[SHIFT[0] * unit, -SHIFT[1] * unit]; mesh.num_nodes()];
    let spline = wavy();
    let inverse = InverseSplineDistortion::from_lens(&spline, domain(), 1e-6).unwrap();
    let lenses: [(&str, Distortion); 3] =
        [("radial", lens().into()), ("spline", spline.into()), ("inverse_spline", inverse.into())];
    let mut group = c.benchmark_group("lens");
    for (name, lens) in lenses {
        let options = Options::default()
            .interpolation(Interpolation::Bspline3)
            .smoothing(0.0)
            .num_threads(Some(1))
            .max_iterations(ITERATIONS)
            .tolerance(f64::MIN_POSITIVE);
        let camera = Arc::new(pinhole(SENSOR).with_distortion(lens));
        let correlator = Correlator::new(reference.clone(), &mesh, camera, options).unwrap();
        group.throughput(Throughput::Elements((correlator.num_points() * ITERATIONS) as u64));
        group.bench_function(name, |b| {
            b.iter(|| correlator.correlate(deformed.view(), Start::Field(&field)).unwrap());
        });
    }
    group.finish();
}

criterion_group! { name = benches; config = criterion(); targets = lenses }
criterion_main!(benches);
