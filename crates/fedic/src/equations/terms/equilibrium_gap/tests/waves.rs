//! Amplitude that is left of waves.

use std::f64::consts::TAU;

use fedic_camera::FrontParallel;
use fedic_mesh::CellType;

use super::scene::{System, at_points, isotropic, loads, rectangle, with_points};
use crate::PLANE;

const SIDE: f64 = 32.0;
/// Distance from the middle within which amplitudes are measured.
const RADIUS: f64 = 7.0;

/// Amplitude left, in the middle of the mesh, of waves of a length along an angle, whose displacement is across it or along.
fn amplitude_left(system: &System, length: f64, degrees: f64, across: bool) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let [a, b] = if across { [-sin, cos] } else { [cos, sin] };
    let (mut product, mut square) = (0.0, 0.0);
    for quarter in [0.0, 0.25] {
        let wave = |[x, y]: [f64; 2]| {
            let value = (TAU * ((x * cos + y * sin) / length + quarter)).sin();
            [a * value, b * value]
        };
        let found = system.solve(&loads(&system.dofs, wave));
        at_points(&system.dofs, |nodes, shape, x, weight| {
            if (x[0] - SIDE / 2.0).hypot(x[1] - SIDE / 2.0) < RADIUS {
                let value = wave(x);
                for c in 0..PLANE {
                    let at = nodes.iter().zip(shape).map(|(&node, n)| n * found[node as usize][c]).sum::<f64>();
                    product += weight * value[c] * at;
                    square += weight * value[c] * value[c];
                }
            }
        });
    }
    product / square
}

#[test]
fn shear_waves_are_halved_at_the_stated_length_and_longitudinal_ones_at_a_longer_one() {
    // Inside: the square of the force of a longitudinal wave is (2 / (1 - nu))^2 times that of a shear wave.
    let longer = (2.0_f64 / 0.7).sqrt();
    for (cell_type, length, shake) in CellType::ALL.into_iter().flat_map(|cell| [(cell, 5.0, 0.0), (cell, 8.0, 0.15)]) {
        let system = System::gap(&rectangle([SIDE, SIDE], cell_type, shake), isotropic(), Vec::new(), length);
        let left = |ratio: f64, across: bool| {
            let of_angle = |degrees: f64| amplitude_left(&system, ratio * length, degrees, across);
            (of_angle(0.0) + of_angle(45.0)) / 2.0
        };
        let at = format!("{cell_type:?}, {length} cells, shaken by {shake}");
        let shear = [0.98, 1.03].map(|ratio| left(ratio, true));
        assert!(shear[0] < 0.5 && shear[1] > 0.5, "{at}: {shear:?}");
        let longitudinal = [0.95, 1.05].map(|ratio| left(ratio * longer, false));
        assert!(longitudinal[0] < 0.5 && longitudinal[1] > 0.5, "{at}: {longitudinal:?}");
    }
}

#[test]
fn the_amplitude_left_falls_with_the_fourth_power_of_the_length() {
    let system = System::gap(&rectangle([SIDE, SIDE], CellType::Quad, 0.0), isotropic(), Vec::new(), 8.0);
    for wave in [5.5, 8.0, 11.0, 16.0] {
        let left = amplitude_left(&system, wave, 20.0, true);
        let expected = 1.0 / (1.0 + (8.0_f64 / wave).powi(4));
        assert!((left - expected).abs() < 0.03, "{wave}: {left}, {expected}");
    }
}

#[test]
fn the_length_is_one_in_the_image_whatever_the_unit_the_camera_and_the_size_of_the_cells() {
    // Cells of 0.2 mm seen at 50 pixels per millimetre: waves of 100 pixels are ten cells long.
    let mesh = rectangle([SIDE, SIDE], CellType::Quad, 0.0);
    let scaled = mesh.points().iter().map(|&[x, y, z]| [0.2 * x, 0.2 * y, z]).collect();
    let camera = FrontParallel::new(50.0, [0.0, 0.0]).unwrap();
    let system = System::gap_seen_by(&camera, &with_points(&mesh, scaled), isotropic(), Vec::new(), 100.0);
    let reference = System::gap(&mesh, isotropic(), Vec::new(), 10.0);
    let shape = |system: &System, scale: f64| {
        let mut spike = vec![0.0; system.dofs.pattern.num_dofs()];
        spike[PLANE * (16 * 33 + 16)] = scale;
        system.solve(&spike)
    };
    let (found, expected) = (shape(&system, 0.2 * 0.2), shape(&reference, 1.0));
    let largest = expected.as_flattened().iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((a - b).abs() < 1e-9 * largest, "{a} {b}");
    }
}

#[test]
fn the_length_is_the_same_in_fine_and_coarse_cells() {
    // Cells grow by a factor of two from left to right.
    let mesh = rectangle([SIDE, SIDE], CellType::Quad, 0.0);
    let graded = mesh.points().iter().map(|&[x, y, z]| [x * (2.0 / 3.0 + x / (3.0 * SIDE)), y, z]).collect();
    let system = System::gap(&with_points(&mesh, graded), isotropic(), Vec::new(), 8.0);
    let wave = |[_, y]: [f64; 2]| [(TAU * y / 8.0).sin(), 0.0];
    let found = system.solve(&loads(&system.dofs, wave));
    let left = |low: f64, high: f64| {
        let (mut product, mut square) = (0.0, 0.0);
        at_points(&system.dofs, |nodes, shape, x, weight| {
            if x[0] > low && x[0] < high && x[1] > 8.0 && x[1] < 24.0 {
                let at = nodes.iter().zip(shape).map(|(&node, n)| n * found[node as usize][0]).sum::<f64>();
                product += weight * wave(x)[0] * at;
                square += weight * wave(x)[0].powi(2);
            }
        });
        product / square
    };
    let (fine, coarse) = (left(5.0, 10.0), left(20.0, 26.0));
    assert!((fine - 0.5).abs() < 0.03 && (coarse - 0.5).abs() < 0.03, "{fine}, {coarse}");
}
