//! Large displacements: the pyramid start converges, the zero start does not.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::sync::Arc;

use common::{Motion, largest_error, mixed_mesh, render};
use fedic::{Correlator, ImageFrame, Options, Start};
use fedic_synthetic::Speckle;

#[test]
fn the_pyramid_converges_where_the_zero_start_fails() {
    let motion = Motion { gradient: [[1.02, 0.0], [0.0, 0.994]], shift: [13.0, -7.5], centre: [120.0; 2] };
    let images = render(&ImageFrame, [240, 240], Speckle::new(5.0, 0.5, 8).unwrap(), motion);
    let mesh = mixed_mesh([32.4, 33.1], 8, 21.0);
    let correlator =
        Correlator::new(Arc::new(images[0].clone()), &mesh, Arc::new(ImageFrame), Options::default()).unwrap();

    let coarse_to_fine = correlator.correlate(images[1].view(), Start::Pyramid).unwrap();
    assert!(coarse_to_fine.converged);
    let error = largest_error(&mesh, &coarse_to_fine.displacement, motion);
    assert!(error < 1e-2, "{error:e}");
    let levels: Vec<usize> = coarse_to_fine.history.iter().map(|i| i.level).collect();
    assert!(levels.is_sorted_by(|a, b| a >= b) && levels[0] > 1 && levels.ends_with(&[0]), "{levels:?}");
    // Corrections are in pixels of the full resolution: the largest is most of the motion.
    let largest = coarse_to_fine.history.iter().map(|i| i.correction).fold(0.0, f64::max);
    assert!((6.0..30.0).contains(&largest), "{largest}");
    assert_eq!(coarse_to_fine.iterations, levels.iter().filter(|&&level| level == 0).count());

    let from_zero = correlator.correlate(images[1].view(), Start::Zero).unwrap();
    assert!(!from_zero.converged);
    assert!(largest_error(&mesh, &from_zero.unchecked_displacement, motion) > 1.0);
    assert!(from_zero.residual_rms > 5.0 * coarse_to_fine.residual_rms);

    // A start close to the solution converges on the finest level.
    let near: Vec<[f64; 2]> = mesh.points().iter().map(|p| motion.displacement([p[0] + 1.0, p[1]])).collect();
    let from_field = correlator.correlate(images[1].view(), Start::Field(&near)).unwrap();
    assert!(from_field.converged && largest_error(&mesh, &from_field.displacement, motion) < 1e-2);
    assert!(from_field.history.iter().all(|i| i.level == 0));
}

#[test]
fn a_mesh_too_small_for_a_pyramid_starts_from_zero() {
    let motion = Motion::translation([0.4, 0.3]);
    let images = render(&ImageFrame, [80, 80], Speckle::new(5.0, 0.5, 8).unwrap(), motion);
    let mesh = mixed_mesh([30.2, 30.4], 1, 11.0);
    let correlator =
        Correlator::new(Arc::new(images[0].clone()), &mesh, Arc::new(ImageFrame), Options::default()).unwrap();
    let start = |start| correlator.correlate(images[1].view(), start).unwrap();
    assert_eq!(start(Start::Pyramid), start(Start::Zero));
}
