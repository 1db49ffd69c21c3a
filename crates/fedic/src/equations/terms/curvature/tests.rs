//! Penalty on the second derivatives: affine fields cost nothing, and waves of the stated length lose half of their amplitude.

#![allow(clippy::unwrap_used)]

use std::f64::consts::TAU;

use fedic_camera::ImageFrame;
use fedic_mesh::{CellType, Mesh, Subdivision, jacobian, map, rectangle_mesh, shape_values};
use fedic_sparse::{Cholesky, Factor, SpdFactor, SpdSolver, SymmetricMatrix};
use nalgebra::{DMatrix, Rotation3, Vector3};

use super::*;
use crate::PLANE;

const SIDE: f64 = 12.0;

/// A mesh of cells of length one, with random moves of the nodes by at most `shake` times their distance.
fn square(cell_type: CellType, side: f64, shake: f64) -> Mesh {
    let mesh = rectangle_mesh([0.0, 0.0, side, side], 1.0, cell_type).unwrap();
    let shake = shake / cell_type.data().grid_intervals as f64;
    let mut state = 7_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        shake * ((state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    };
    let points = mesh.points().iter().map(|&[x, y, z]| [x + random(), y + random(), z]).collect();
    with_points(&mesh, points)
}

fn with_points(mesh: &Mesh, points: Vec<[f64; 3]>) -> Mesh {
    let cells = mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node))).collect();
    Mesh::new(points, &[(mesh.cell(0).cell_type, cells)]).unwrap()
}

fn curvature<const D: usize>(dofs: &Dofs<D>, length: f64) -> Curvature {
    Curvature::new(dofs, &ImageFrame, length, &()).unwrap()
}

/// Largest entry of `R U` beside the largest that a displacement of this size can have.
fn relative_gradient<const D: usize>(mesh: &Mesh, displacement: impl Fn([f64; 3]) -> [f64; D]) -> f64 {
    let dofs = Dofs::<D>::with_patches(mesh).unwrap();
    let field: Vec<f64> = dofs.mesh.points().iter().flat_map(|&point| displacement(point)).collect();
    let matrix = curvature(&dofs, 5.0).matrix;
    let gradient = matrix.multiply(&dofs.pattern, &field);
    let largest = |values: &[f64]| values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    largest(&gradient) / (largest(matrix.values()) * largest(&field))
}

#[test]
fn affine_fields_and_rotations_of_any_size_have_no_gradient() {
    let affine = |[x, y, _]: [f64; 3]| [3.0 + 0.02 * x - 0.4 * y, -50.0 + 0.3 * x + 0.01 * y];
    let rotation = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        move |[x, y, _]: [f64; 3]| [cos * x - sin * y - x, sin * x + cos * y - y]
    };
    for cell_type in CellType::ALL {
        let mesh = square(cell_type, SIDE, 0.1);
        // A mesh with a step in its outline, a hole and two cells that hold by a node alone.
        let kept = (0..mesh.num_cells()).filter(|cell| ![0, 1, 7, 40, 41, 42, 60, 73].contains(cell));
        let cells = kept.flat_map(|cell| mesh.cell(cell).nodes.iter().map(|&node| i64::from(node))).collect();
        let holed = Mesh::new(mesh.points().to_vec(), &[(cell_type, cells)]).unwrap();
        for mesh in [&mesh, &holed] {
            let found = relative_gradient(mesh, affine);
            assert!(found < 1e-13, "{cell_type:?}: {found:e}");
            for degrees in [5.0, 90.0, 170.0] {
                assert!(relative_gradient(mesh, rotation(degrees)) < 1e-13, "{cell_type:?}, {degrees} degrees");
            }
        }
        let bent = |[x, y, _]: [f64; 3]| [0.1 * x * y, 0.1 * x * x];
        assert!(relative_gradient(&mesh, bent) > 1e-5, "{cell_type:?}");
    }
}

#[test]
fn affine_fields_on_surfaces_in_space_have_no_gradient() {
    for cell_type in CellType::ALL {
        let flat = square(cell_type, SIDE, 0.1);
        // A plane in any orientation: displacements that are affine in space.
        let turn = Rotation3::from_euler_angles(0.9, -0.7, 2.0);
        let tilted = flat.points().iter().map(|&point| (turn * Vector3::from(point)).into()).collect();
        let tilted = with_points(&flat, tilted);
        let in_space = |[x, y, z]: [f64; 3]| [0.1 * x - y + 2.0 * z, 3.0 * y - 1.0, 0.3 * x + 0.2 * y - 7.0 * z];
        assert!(relative_gradient(&tilted, in_space) < 1e-13, "{cell_type:?}");
        // A cylinder: displacements in the plane that are affine there.
        let bent = flat.points().iter().map(|&[x, y, _]| [8.0 * (x / 8.0).sin(), y, 8.0 * (x / 8.0).cos()]).collect();
        let bent = with_points(&flat, bent);
        assert!(relative_gradient(&bent, |[x, y, _]| [0.1 * x - y, 3.0 * y + x]) < 1e-13, "{cell_type:?}");
    }
}

fn dense<const D: usize>(dofs: &Dofs<D>, matrix: &SymmetricMatrix) -> DMatrix<f64> {
    let (starts, rows) = dofs.pattern.lower_triangle();
    let mut dense = DMatrix::zeros(dofs.pattern.num_dofs(), dofs.pattern.num_dofs());
    for column in 0..dofs.pattern.num_dofs() {
        for k in starts[column]..starts[column + 1] {
            dense[(rows[k], column)] = matrix.values()[k];
            dense[(column, rows[k])] = matrix.values()[k];
        }
    }
    dense
}

#[test]
fn fields_that_are_not_affine_cost_something() {
    for cell_type in CellType::ALL {
        let mesh = square(cell_type, 4.0, 0.1);
        // Two parts, 20 apart.
        let (count, shift) = (mesh.num_nodes() as i64, |&[x, y, z]: &[f64; 3]| [x + 20.0, y, z]);
        let points = mesh.points().iter().copied().chain(mesh.points().iter().map(shift)).collect();
        let nodes = || mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node)));
        let cells = nodes().chain(nodes().map(|node| node + count)).collect();
        let two = Mesh::new(points, &[(cell_type, cells)]).unwrap();
        for (mesh, parts) in [(&mesh, 1), (&two, 2)] {
            let dofs = Dofs::<PLANE>::with_patches(mesh).unwrap();
            let mut eigenvalues: Vec<f64> =
                dense(&dofs, &curvature(&dofs, 5.0).matrix).symmetric_eigenvalues().iter().copied().collect();
            eigenvalues.sort_by(f64::total_cmp);
            let (affine, others) = eigenvalues.split_at(3 * PLANE * parts);
            let largest = others[others.len() - 1];
            assert!(affine.iter().all(|value| value.abs() < 1e-12 * largest), "{cell_type:?}: {affine:?}");
            assert!(others[0] > 1e-5 * largest, "{cell_type:?}: {:e} of {largest:e}", others[0]);
        }
    }
}

/// Mean Hessian of an image: the integral of `N_i N_j`, the same for each component. And the integral of `N_i` times a field.
fn image_term(dofs: &Dofs<1>, field: impl Fn([f64; 2]) -> f64) -> (SymmetricMatrix, Vec<f64>) {
    let mut matrix = SymmetricMatrix::zeros(&dofs.pattern);
    let mut right_hand_side = vec![0.0; dofs.mesh.num_nodes()];
    for (index, cell) in dofs.mesh.cells().enumerate() {
        let nodes: Vec<[f64; 2]> = dofs.mesh.cell_points(index).iter().map(|&[x, y, _]| [x, y]).collect();
        let subdivision = Subdivision::uniform(cell.cell_type, 8);
        let mut entries = vec![0.0; nodes.len() * nodes.len()];
        for at in subdivision.all_points() {
            let [[a, b], [c, d]] = jacobian(cell.cell_type, &nodes, at);
            let weight = subdivision.subcell_area() * (a * d - b * c).abs();
            let shape = shape_values(cell.cell_type, at);
            for (k, entry) in entries.iter_mut().enumerate() {
                *entry += weight * shape[k / nodes.len()] * shape[k % nodes.len()];
            }
            let value = field(map(cell.cell_type, &nodes, at));
            cell.nodes.iter().zip(shape).for_each(|(&node, n)| right_hand_side[node as usize] += weight * n * value);
        }
        matrix.add_cell(&dofs.pattern, index, &entries);
    }
    (matrix, right_hand_side)
}

/// Factor of the mean Hessian and the penalty.
fn system(dofs: &Dofs<1>, length: f64) -> Factor {
    let (hessian, _) = image_term(dofs, |_| 0.0);
    let curvature = curvature(dofs, length);
    let cholesky = Cholesky::new(&dofs.pattern, dofs.mesh.points()).unwrap();
    let factorize = |system: &SymmetricMatrix| Ok(cholesky.factorize(system).unwrap());
    let mut system = hessian.clone();
    let factor = curvature.waves.factor(dofs, &hessian, &curvature.matrix, factorize).unwrap();
    system.add_scaled(factor, &curvature.matrix);
    cholesky.factorize(&system).unwrap()
}

/// Minimum of the integral of `(U - field)^2` and the penalty.
fn smoothed(dofs: &Dofs<1>, system: &Factor, field: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
    let (_, mut solution) = image_term(dofs, field);
    system.solve(&mut solution);
    solution
}

#[test]
fn the_system_returns_an_affine_field() {
    for cell_type in CellType::ALL {
        let dofs = Dofs::<1>::with_patches(&square(cell_type, SIDE, 0.1)).unwrap();
        let field = |[x, y]: [f64; 2]| 200.0 + 0.5 * x - 0.8 * y;
        let expected: Vec<f64> = dofs.mesh.points().iter().map(|&[x, y, _]| field([x, y])).collect();
        for length in [5.0, 20.0, 100.0] {
            let error = smoothed(&dofs, &system(&dofs, length), field)
                .iter()
                .zip(&expected)
                .fold(0.0_f64, |largest, (found, expected)| largest.max((found - expected).abs()));
            assert!(error < 1e-6, "{cell_type:?}, length {length}: {error:e}");
        }
    }
}

/// Amplitude that the system leaves of a wave in the middle of the mesh, in the direction of an angle.
fn amplitude_left(dofs: &Dofs<1>, system: &Factor, length: f64, angle: f64) -> f64 {
    let wave = |[x, y]: [f64; 2]| (TAU / length * (x * angle.cos() + y * angle.sin())).sin();
    let found = smoothed(dofs, system, wave);
    let (mut product, mut square) = (0.0, 0.0);
    for (index, cell) in dofs.mesh.cells().enumerate() {
        let nodes: Vec<[f64; 2]> = dofs.mesh.cell_points(index).iter().map(|&[x, y, _]| [x, y]).collect();
        for at in Subdivision::uniform(cell.cell_type, 4).all_points() {
            let x = map(cell.cell_type, &nodes, at);
            let shape = shape_values(cell.cell_type, at);
            let value: f64 = cell.nodes.iter().zip(shape).map(|(&node, n)| n * found[node as usize]).sum();
            if (x[0] - 18.0).hypot(x[1] - 18.0) < length.min(8.0) {
                product += wave(x) * value;
                square += wave(x).powi(2);
            }
        }
    }
    product / square
}

#[test]
fn a_wave_of_the_stated_length_keeps_half_of_its_amplitude() {
    for (cell_type, shake) in CellType::ALL.into_iter().flat_map(|cell_type| [(cell_type, 0.0), (cell_type, 0.1)]) {
        let dofs = Dofs::<1>::with_patches(&square(cell_type, 36.0, shake)).unwrap();
        for length in [5.0, 7.0, 10.0, 14.0] {
            let system = system(&dofs, length);
            for degrees in [0.0_f64, 30.0, 45.0] {
                let left = amplitude_left(&dofs, &system, length, degrees.to_radians());
                let at = format!("{cell_type:?}, shaken by {shake}, {length} cells, {degrees} degrees");
                assert!((left - 0.5).abs() < 0.025, "{at}: {left}");
            }
        }
    }
}
