//! Singular matrices: every undetermined degree of freedom is named.

#![allow(clippy::panic, clippy::unwrap_used, missing_docs)]

mod common;

use common::{Generator, Mesh, free_body, hexahedra, perforated_grid, quads, random_cell, rigid_modes, solution_error};
use fedic_sparse::{Cholesky, Pattern, SparseError, SpdFactor, SpdSolver, SymmetricMatrix};

/// Large enough for several tasks and for fronts divided into tiles.
const SIDE: usize = 170;

fn undetermined(cholesky: &Cholesky, matrix: &SymmetricMatrix) -> Vec<usize> {
    let errors = [cholesky.factorize(matrix).unwrap_err(), cholesky.factorize_compact(matrix).unwrap_err()];
    assert_eq!(errors[0], errors[1]);
    match &errors[0] {
        SparseError::Singular { dofs } => dofs.clone(),
        other => panic!("{other}"),
    }
}

/// A mesh with a cell of one node for each of `fixed`, which are last.
fn with_supports(mut mesh: Mesh, fixed: &[u32]) -> Mesh {
    mesh.cells.extend(fixed.iter().map(|&node| vec![node]));
    mesh
}

/// Free body whose nodes `fixed` are tied to the ground in some components.
fn supported(mesh: &Mesh, pattern: &Pattern, supports: usize, components: &[usize]) -> SymmetricMatrix {
    let block = pattern.block();
    let num_cells = mesh.cells.len() - supports;
    let body = Mesh { points: mesh.points.clone(), cells: mesh.cells[..num_cells].to_vec() };
    let mut matrix = free_body(&body, pattern);
    for cell in num_cells..mesh.cells.len() {
        let mut dense = vec![0.0; block * block];
        components.iter().for_each(|&c| dense[c * block + c] = 1.0);
        matrix.add_cell(pattern, cell, &dense);
    }
    matrix
}

#[test]
fn each_rigid_motion_of_a_free_body_leaves_one_undetermined_dof() {
    for (mesh, block, motions) in
        [(quads(12, 9), 2, 3), (quads(60, 50), 2, 3), (hexahedra(4), 3, 6), (hexahedra(7), 3, 6)]
    {
        let pattern = mesh.pattern(block);
        let mut matrix = free_body(&mesh, &pattern);
        for mode in rigid_modes(&mesh.points, block) {
            assert!(matrix.quadratic_form(&pattern, &mode).abs() < 1e-8, "a rigid motion has no energy");
        }
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        let dofs = undetermined(&cholesky, &matrix);
        assert_eq!(dofs.len(), motions, "{block} components: {dofs:?}");
        // Tying the named degrees of freedom to the ground determines the system.
        let nodes: Vec<u32> = dofs.iter().map(|dof| (dof / block) as u32).collect();
        let tied = with_supports(mesh, &nodes);
        let pattern = tied.pattern(block);
        matrix = supported(&tied, &pattern, nodes.len(), &[]);
        for (support, dof) in dofs.iter().enumerate() {
            let mut dense = vec![0.0; block * block];
            dense[(dof % block) * (block + 1)] = 1.0;
            matrix.add_cell(&pattern, tied.cells.len() - nodes.len() + support, &dense);
        }
        let factor = Cholesky::new(&pattern, &tied.points).unwrap().factorize(&matrix).unwrap();
        assert!(solution_error(&factor, &matrix, &pattern) < 1e-6);
    }
}

#[test]
fn an_undetermined_rotation_is_named() {
    for (mesh, block, rotations) in [(quads(70, 70), 2, 1), (hexahedra(5), 3, 3)] {
        let mesh = with_supports(mesh, &[0]);
        let pattern = mesh.pattern(block);
        let matrix = supported(&mesh, &pattern, 1, &[0, 1, 2][..block]);
        let dofs = undetermined(&Cholesky::new(&pattern, &mesh.points).unwrap(), &matrix);
        assert_eq!(dofs.len(), rotations, "{block} components: {dofs:?}");
        // The supported node itself is determined.
        assert!(dofs.iter().all(|&dof| dof >= block), "{dofs:?}");
    }
}

#[test]
fn a_node_without_stiffness_is_named() {
    for (size, block) in [(3, 2), (40, 2), (3, 3), (40, 3)] {
        let mesh = quads(size, size);
        let pattern = mesh.pattern(block);
        let mut matrix = SymmetricMatrix::zeros(&pattern);
        let mut random = Generator(3);
        let corner = 0;
        for (index, cell) in mesh.cells.iter().enumerate() {
            let width = 4 * block;
            let mut local = random_cell(width, 2 * width, &mut random);
            for k in (0..width).filter(|k| cell[k / block] == corner) {
                for other in 0..width {
                    local[k * width + other] = 0.0;
                    local[other * width + k] = 0.0;
                }
            }
            matrix.add_cell(&pattern, index, &local);
        }
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        assert_eq!(undetermined(&cholesky, &matrix), (0..block).collect::<Vec<_>>(), "grid of {size}");
    }
}

#[test]
fn a_single_component_without_stiffness_is_named_in_a_large_mesh() {
    for block in [2, 3] {
        let mesh = perforated_grid(SIDE).with_node_cells();
        let pattern = mesh.pattern(block);
        let node = 4321;
        let component = block - 1;
        let mut matrix = SymmetricMatrix::zeros(&pattern);
        let mut random = Generator(11);
        for (index, cell) in mesh.cells.iter().enumerate() {
            let size = block * cell.len();
            let mut dense = random_cell(size, 1, &mut random);
            (0..size).for_each(|k| dense[k * size + k] += 0.5);
            if let Some(at) = cell.iter().position(|&other| other == node) {
                let own = block * at + component;
                for (k, value) in dense.iter_mut().enumerate() {
                    if k / size == own || k % size == own {
                        *value = 0.0;
                    }
                }
            }
            matrix.add_cell(&pattern, index, &dense);
        }
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        assert_eq!(undetermined(&cholesky, &matrix), [block * node as usize + component]);
    }
}

#[test]
fn nodes_of_no_cell_are_named() {
    let mesh = perforated_grid(SIDE);
    let pattern = mesh.pattern(2);
    let mut used = vec![false; mesh.num_nodes()];
    mesh.cells.iter().flatten().for_each(|&node| used[node as usize] = true);
    let expected: Vec<usize> = (0..pattern.num_dofs()).filter(|dof| !used[dof / 2]).collect();
    assert!(!expected.is_empty());
    let matrix = common::assembled(&pattern, 0.5);
    assert_eq!(undetermined(&Cholesky::new(&pattern, &mesh.points).unwrap(), &matrix), expected);
}

#[test]
fn a_rank_deficient_matrix_is_singular() {
    let mesh = quads(6, 5);
    let pattern = mesh.pattern(2);
    let mut matrix = SymmetricMatrix::zeros(&pattern);
    let mut random = Generator(7);
    for cell in 0..mesh.cells.len() {
        matrix.add_cell(&pattern, cell, &random_cell(8, 1, &mut random));
    }
    // 30 cells of rank one leave at least 84 - 30 degrees of freedom undetermined.
    assert!(undetermined(&Cholesky::new(&pattern, &mesh.points).unwrap(), &matrix).len() >= 54);
}

#[test]
fn a_zero_matrix_determines_nothing() {
    let mesh = quads(2, 2);
    let pattern = mesh.pattern(3);
    let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
    let error = cholesky.factorize(&SymmetricMatrix::zeros(&pattern)).unwrap_err();
    assert_eq!(error, SparseError::Singular { dofs: (0..27).collect() });
    assert_eq!(
        error.to_string(),
        "the system matrix is singular: 27 of its degrees of freedom are undetermined, the first of them 0"
    );
}

#[test]
fn a_badly_scaled_but_regular_matrix_is_not_called_singular() {
    let mesh = quads(30, 30);
    let pattern = mesh.pattern(3);
    let mut matrix = SymmetricMatrix::zeros(&pattern);
    let mut random = Generator(5);
    for cell in 0..mesh.cells.len() {
        let scale = 10_f64.powi(cell as i32 % 7 - 6);
        let dense: Vec<f64> = random_cell(12, 24, &mut random).into_iter().map(|value| scale * value).collect();
        matrix.add_cell(&pattern, cell, &dense);
    }
    let factor = Cholesky::new(&pattern, &mesh.points).unwrap().factorize(&matrix).unwrap();
    assert!(!factor.is_compact());
    assert!(solution_error(&factor, &matrix, &pattern) < 1e-6);
}
