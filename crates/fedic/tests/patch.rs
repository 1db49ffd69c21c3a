//! Patch tests: affine displacements are measured exactly with every cell type, quadrature rule and camera.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::sync::Arc;

use common::{Motion, largest_error, render, warped_mesh};
use fedic::{
    BrownDistortion, Camera, CellType, Correlator, FrontParallel, Hessian, Image, ImageFrame, Mesh, Options, Pinhole,
    Quadrature, Rule, Solution, Start, rotation_from_vector,
};
use fedic_synthetic::Speckle;

const QUADRATURES: [Quadrature; 4] = [
    Quadrature::Mesh { rule: Rule::Rotated, density: 1.0 },
    Quadrature::Mesh { rule: Rule::Edges, density: 1.0 },
    Quadrature::Mesh { rule: Rule::Diameter, density: 1.0 },
    Quadrature::Pixel,
];

const MOST_ITERATIONS: usize = 7;

fn options(quadrature: Quadrature) -> Options {
    // No smoothing: the filter of the deformed image does not deform with the material.
    Options::default().quadrature(quadrature).smoothing(0.0).tolerance(1e-5)
}

fn measure(images: &[Image; 2], mesh: &Mesh, camera: &Arc<dyn Camera>, options: Options) -> Solution {
    let correlator = Correlator::new(Arc::new(images[0].clone()), mesh, Arc::clone(camera), options).unwrap();
    let solution = correlator.correlate(images[1].view(), Start::Zero).unwrap();
    assert!(solution.converged, "{:?}", solution.history);
    // A wrong gradient would converge too, but slowly.
    assert!(solution.iterations <= MOST_ITERATIONS, "{:?}", solution.history);
    assert!(solution.outside_cells.is_empty());
    solution
}

/// Accepted nodal error in pixels, about twice the measured one. It comes from the interpolation and is largest at
/// nodes on the boundary, which the fewest points determine.
fn accepted(cell: CellType) -> f64 {
    match cell {
        CellType::Quad => 2e-3,
        CellType::Triangle => 5e-3,
        CellType::Quad8 => 8e-3,
        CellType::Triangle6 | CellType::Quad9 => 1e-2,
    }
}

fn check_in_image_frame(motion: Motion) {
    let camera: Arc<dyn Camera> = Arc::new(ImageFrame);
    let images = render(camera.as_ref(), [150, 130], Speckle::new(5.5, 0.5, 11).unwrap(), motion);
    for cell in CellType::ALL {
        let mesh = warped_mesh([14.3, 15.6, 133.7, 114.2], 20.0, cell, 2.0);
        for quadrature in QUADRATURES {
            let solution = measure(&images, &mesh, &camera, options(quadrature));
            let error = largest_error(&mesh, &solution.displacement, motion);
            assert!(error < accepted(cell), "{cell}, {quadrature:?}: {error:e} px");
            for (u, in_pixels) in solution.displacement.iter().zip(&solution.pixel_displacement) {
                assert!((u[0] - in_pixels[0]).hypot(u[1] - in_pixels[1]) < 1e-12, "{u:?} {in_pixels:?}");
            }
        }
    }
}

#[test]
fn a_translation_is_measured() {
    check_in_image_frame(Motion::translation([0.37, -0.21]));
}

#[test]
fn a_rotation_is_measured() {
    let (sin, cos) = 0.01_f64.sin_cos();
    check_in_image_frame(Motion { gradient: [[cos, -sin], [sin, cos]], shift: [0.2, 0.1], centre: [75.0, 65.0] });
}

#[test]
fn a_uniform_strain_is_measured() {
    let gradient = [[1.012, 0.004], [-0.002, 0.993]];
    check_in_image_frame(Motion { gradient, shift: [-0.3, 0.15], centre: [75.0, 65.0] });
}

const PIXELS_PER_MILLIMETRE: f64 = 10.0;

/// A motion in millimetres about the origin, and a speckle.
fn millimetres() -> (Motion, Speckle) {
    let gradient = [[1.006, 0.003], [-0.004, 0.995]];
    (Motion { gradient, shift: [0.025, -0.018], centre: [0.0, 0.0] }, Speckle::new(0.55, 0.5, 5).unwrap())
}

fn check_in_millimetres(camera: Arc<dyn Camera>, hessian: Hessian) {
    let (motion, speckle) = millimetres();
    let images = render(camera.as_ref(), [160, 140], speckle, motion);
    for cell in CellType::ALL {
        let mesh = warped_mesh([-5.03, -4.21, 5.17, 4.33], 2.0, cell, 0.2);
        for quadrature in QUADRATURES {
            let solution = measure(&images, &mesh, &camera, options(quadrature).hessian(hessian));
            let error = largest_error(&mesh, &solution.displacement, motion);
            assert!(error < accepted(cell) / PIXELS_PER_MILLIMETRE, "{cell}, {quadrature:?}: {error:e} mm");
            for ((point, u), in_pixels) in
                mesh.points().iter().zip(&solution.displacement).zip(&solution.pixel_displacement)
            {
                let [x, y, z] = *point;
                let (from, to) = (camera.project([x, y, z]), camera.project([x + u[0], y + u[1], z]));
                assert_eq!(*in_pixels, [to[0] - from[0], to[1] - from[1]]);
            }
        }
    }
}

#[test]
fn a_uniform_strain_is_measured_in_millimetres() {
    check_in_millimetres(Arc::new(FrontParallel::new(PIXELS_PER_MILLIMETRE, [79.3, 70.8]).unwrap()), Hessian::Initial);
}

#[test]
fn a_uniform_strain_is_measured_through_a_tilted_camera_with_lens() {
    // Upright, then tilted by about 8 degrees, 60 mm away.
    let rotation = rotation_from_vector([std::f64::consts::PI + 0.12, 0.08, 0.05]);
    let lens = BrownDistortion::new([-0.3, 0.2, 0.05], [0.01, -0.008], [0.005, 0.004]).unwrap();
    let camera = Pinhole::new([600.0, 610.0], [80.2, 69.1], rotation, [0.1, -0.2, 60.0]).unwrap();
    let camera = camera.with_skew_angle(1.55).unwrap().with_distortion(lens);
    for hessian in [Hessian::Initial, Hessian::Updated] {
        check_in_millimetres(Arc::new(camera.clone()), hessian);
    }
}
