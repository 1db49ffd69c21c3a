//! Fields in equilibrium are returned as they are.

use fedic_mesh::{CellType, Mesh};
use nalgebra::{DMatrix, DVector, Matrix3};

use super::super::stiffness::CellStiffness;
use super::scene::{Field, System, field_of, free_nodes, isotropic, rectangle, sides};
use crate::{PLANE, PlaneStress};

const WIDTH: f64 = 8.0;
const HEIGHT: f64 = 12.0;
const LENGTH: f64 = 8.0;
const TOLERANCE: f64 = 1e-11;

fn uniaxial([x, y, _]: [f64; 3]) -> [f64; PLANE] {
    [3.0 - 0.3 * 0.01 * x, 0.01 * y - 2.0]
}

/// Pure bending of a beam along `y`: the stress is proportional to `x`.
fn bending([x, y, _]: [f64; 3]) -> [f64; PLANE] {
    let (x, y) = (x - WIDTH / 2.0, y - HEIGHT / 2.0);
    [-0.01 * (0.5 * y * y + 0.15 * x * x), 0.01 * x * y]
}

#[test]
fn uniaxial_tension_with_free_sides_is_left_alone() {
    for (cell_type, shake) in CellType::ALL.into_iter().flat_map(|cell_type| [(cell_type, 0.0), (cell_type, 0.1)]) {
        let mesh = rectangle([WIDTH, HEIGHT], cell_type, shake);
        let system = System::gap(&mesh, isotropic(), sides(&mesh, HEIGHT), LENGTH);
        let error = system.relative_error(&field_of(&mesh, uniaxial));
        assert!(error < TOLERANCE, "{cell_type:?}, shaken by {shake}: {error:e}");
    }
}

#[test]
fn any_uniform_strain_is_left_alone_inside() {
    for (cell_type, shake) in CellType::ALL.into_iter().flat_map(|cell_type| [(cell_type, 0.0), (cell_type, 0.1)]) {
        let mesh = rectangle([WIDTH, HEIGHT], cell_type, shake);
        let system = System::gap(&mesh, isotropic(), Vec::new(), LENGTH);
        let sheared = |[x, y, _]: [f64; 3]| [0.02 * y + 0.01 * x, 0.02 * x - 0.03 * y + 1.0];
        let error = system.relative_error(&field_of(&mesh, sheared));
        assert!(error < TOLERANCE, "{cell_type:?}, shaken by {shake}: {error:e}");
    }
}

#[test]
fn bending_with_free_sides_is_left_alone() {
    for cell_type in CellType::ALL {
        let mesh = rectangle([WIDTH, HEIGHT], cell_type, 0.0);
        let system = System::gap(&mesh, isotropic(), sides(&mesh, HEIGHT), LENGTH);
        let error = system.relative_error(&field_of(&mesh, bending));
        // Linear triangles with alternating diagonals bend with forces: the error is that of interpolation, an eighth of the second
        // derivative.
        let limit = if cell_type == CellType::Triangle { 0.01 } else { TOLERANCE };
        assert!(error < limit, "{cell_type:?}: {error:e}");
    }
}

/// Stiffness matrix of a mesh, dense.
fn dense_stiffness(mesh: &Mesh, law: &Matrix3<f64>) -> DMatrix<f64> {
    let size = PLANE * mesh.num_nodes();
    let mut dense = DMatrix::zeros(size, size);
    for (index, cell) in mesh.cells().enumerate() {
        let matrix = CellStiffness::new(mesh, index, law).unwrap().matrix;
        let dof = |k: usize| PLANE * cell.nodes[k / PLANE] as usize + k % PLANE;
        for a in 0..matrix.nrows() {
            (0..matrix.nrows()).for_each(|b| dense[(dof(a), dof(b))] += matrix[(a, b)]);
        }
    }
    dense
}

/// The elastic field with given displacements of some nodes and no load on the others.
fn elastic(mesh: &Mesh, law: &PlaneStress, given: impl Fn(usize) -> Option<[f64; PLANE]>) -> Field {
    let stiffness = dense_stiffness(mesh, law.stiffness());
    let (mut field, mut unknown) = (vec![[0.0; PLANE]; mesh.num_nodes()], Vec::new());
    for node in 0..mesh.num_nodes() {
        match given(node) {
            Some(u) => field[node] = u,
            None => unknown.extend([PLANE * node, PLANE * node + 1]),
        }
    }
    let forces = &stiffness * DVector::from_column_slice(field.as_flattened());
    let inner = DMatrix::from_fn(unknown.len(), unknown.len(), |a, b| stiffness[(unknown[a], unknown[b])]);
    let right = DVector::from_fn(unknown.len(), |a, _| -forces[unknown[a]]);
    let solution = inner.cholesky().unwrap().solve(&right);
    unknown.iter().zip(solution.iter()).for_each(|(&dof, &u)| field[dof / PLANE][dof % PLANE] = u);
    field
}

/// A plate with a hole and a crack, whose nodes are doubled, from its right side.
fn cracked_plate(cell_type: CellType) -> Mesh {
    let mesh = rectangle([WIDTH, HEIGHT], cell_type, 0.15);
    let mut points = mesh.points().to_vec();
    let on_crack = |[x, y, _]: [f64; 3]| (y - 8.0).abs() < 1e-9 && x > 5.0 + 1e-9;
    let mut twin = vec![None; points.len()];
    let straight: Vec<[f64; 3]> = rectangle([WIDTH, HEIGHT], cell_type, 0.0).points().to_vec();
    for node in (0..points.len()).filter(|&node| on_crack(straight[node])) {
        twin[node] = Some(points.len() as i64);
        points.push(points[node]);
    }
    let mut cells = Vec::new();
    for cell in mesh.cells() {
        let of =
            |c: usize| cell.nodes.iter().map(|&node| straight[node as usize][c]).sum::<f64>() / cell.nodes.len() as f64;
        let is_hole = (of(0) - 3.0).abs() < 1.0 && (of(1) - 4.0).abs() < 1.0;
        if !is_hole {
            let above = of(1) > 8.0;
            let number = |&node: &u32| twin[node as usize].filter(|_| above).unwrap_or(i64::from(node));
            cells.extend(cell.nodes.iter().map(number));
        }
    }
    Mesh::new(points, &[(cell_type, cells)]).unwrap()
}

#[test]
fn elastic_fields_of_a_plate_with_a_hole_and_a_crack_are_left_alone() {
    let laws = [isotropic(), PlaneStress::orthotropic(140.0, 10.0, 0.3, 5.0, 0.5).unwrap()];
    for (cell_type, law) in CellType::ALL.into_iter().flat_map(|cell_type| laws.map(|law| (cell_type, law))) {
        let mesh = cracked_plate(cell_type);
        let used = mesh.used_nodes();
        let given = |node: usize| {
            let [x, y, _] = mesh.points()[node];
            let end = !(1e-9..=HEIGHT - 1e-9).contains(&y);
            // An uneven pull, not affine.
            (end || !used[node]).then_some(if y < 1.0 { [0.0, 0.0] } else { [0.05 * x, 0.3 + 0.01 * x * x] })
        };
        let field = elastic(&mesh, &law, given);
        let free = sides(&mesh, HEIGHT);
        assert!(free.iter().any(|&node| node >= rectangle([WIDTH, HEIGHT], cell_type, 0.0).num_nodes()));
        let kept: Field = (0..mesh.num_nodes()).filter(|&node| used[node]).map(|node| field[node]).collect();
        let error = System::gap(&mesh, law, free.clone(), LENGTH).relative_error(&kept);
        assert!(error < TOLERANCE, "{cell_type:?}: {error:e}");
        // Another angle does not fit.
        let turned = PlaneStress::orthotropic(140.0, 10.0, 0.3, 5.0, 0.7).unwrap();
        assert!(System::gap(&mesh, turned, free, LENGTH).relative_error(&kept) > 1e-4, "{cell_type:?}");
    }
}

#[test]
fn uniaxial_tension_of_an_orthotropic_plate_couples_to_shear_and_is_left_alone() {
    let law = PlaneStress::orthotropic(140.0, 10.0, 0.3, 5.0, 0.6).unwrap();
    let compliance = law.stiffness().try_inverse().unwrap();
    let [xx, yy, xy] = [0, 1, 2].map(|row| 0.01 * compliance[(row, 1)] / compliance[(1, 1)]);
    let mesh = rectangle([WIDTH, HEIGHT], CellType::Triangle, 0.1);
    let field = field_of(&mesh, |[x, y, _]| [xx * x + xy * y, yy * y]);
    let free = sides(&mesh, HEIGHT);
    assert!(System::gap(&mesh, law, free.clone(), LENGTH).relative_error(&field) < TOLERANCE);
    assert!(System::gap(&mesh, isotropic(), free, LENGTH).relative_error(&field) > 0.01);
}

#[test]
fn the_matrix_is_the_square_of_the_forces_without_load() {
    for cell_type in CellType::ALL {
        let mesh = rectangle([4.0, 3.0], cell_type, 0.1);
        let free = free_nodes(&mesh, |[x, y, _]| x > 4.0 - 1e-9 && y > 0.5 && y < 2.5);
        let system = System::gap(&mesh, isotropic(), free.clone(), 5.0);
        let stiffness = dense_stiffness(&mesh, isotropic().stiffness());
        let mut areas = vec![0.0; mesh.num_nodes()];
        for (index, cell) in mesh.cells().enumerate() {
            let of_cell = CellStiffness::new(&mesh, index, isotropic().stiffness()).unwrap().areas;
            cell.nodes.iter().zip(of_cell).for_each(|(&node, area)| areas[node as usize] += area);
        }
        assert!((areas.iter().sum::<f64>() - 12.0).abs() < 1e-12);
        let boundary = mesh.boundary_nodes();
        let field: Vec<f64> = (0..PLANE * mesh.num_nodes()).map(|k| (1.7 * k as f64).sin()).collect();
        let forces = &stiffness * DVector::from_column_slice(&field);
        let counted = |node: usize| !boundary[node] || free.contains(&node);
        let square = |node: usize| (forces[2 * node].powi(2) + forces[2 * node + 1].powi(2)) / areas[node];
        let expected: f64 = (0..mesh.num_nodes()).filter(|&node| counted(node)).map(square).sum();
        // Up to the factor of the penalty: the ratio of two fields.
        let other: Vec<f64> = (0..field.len()).map(|k| (0.9 * k as f64).cos()).collect();
        let forces = &stiffness * DVector::from_column_slice(&other);
        let square = |node: usize| (forces[2 * node].powi(2) + forces[2 * node + 1].powi(2)) / areas[node];
        let of_other: f64 = (0..mesh.num_nodes()).filter(|&node| counted(node)).map(square).sum();
        let found = |field: &[f64]| system.penalty.quadratic_form(&system.dofs.pattern, field);
        let ratio = found(&field) / found(&other);
        assert!((ratio / (expected / of_other) - 1.0).abs() < 1e-11, "{cell_type:?}: {ratio}");
    }
}
