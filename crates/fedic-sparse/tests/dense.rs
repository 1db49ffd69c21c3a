//! Assembly, products and solutions compared with dense linear algebra.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{Generator, Mesh, assembled, dense_solution, quads, random_cell, random_mesh, solution_error};
use fedic_sparse::{Cholesky, Pattern, SparseError, SpdFactor, SpdSolver, SymmetricMatrix};
use proptest::prelude::*;

/// A random matrix in sparse and dense form; each cell has this rank.
fn sparse_and_dense(mesh: &Mesh, block: usize, rank: usize) -> (Pattern, SymmetricMatrix, Vec<f64>) {
    let pattern = mesh.pattern(block);
    let mut matrix = SymmetricMatrix::zeros(&pattern);
    let n = pattern.num_dofs();
    let mut dense = vec![0.0; n * n];
    let mut random = Generator(7);
    for (index, cell) in mesh.cells.iter().enumerate() {
        let width = cell.len() * block;
        let local = random_cell(width, rank, &mut random);
        matrix.add_cell(&pattern, index, &local);
        let dof = |k: usize| cell[k / block] as usize * block + k % block;
        for i in 0..width {
            for j in 0..width {
                dense[dof(i) * n + dof(j)] += local[i * width + j];
            }
        }
    }
    (pattern, matrix, dense)
}

fn dense_product(dense: &[f64], x: &[f64]) -> Vec<f64> {
    dense.chunks_exact(x.len()).map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum()).collect()
}

proptest! {
    #[test]
    fn products_and_solutions_equal_dense_ones(
        columns in 1_usize..7,
        rows in 1_usize..7,
        block in 1_usize..5,
        shift: u32,
    ) {
        let mut mesh = quads(columns, rows);
        let nodes = mesh.num_nodes();
        // Any numbering of the nodes is allowed.
        for node in mesh.cells.iter_mut().flatten() {
            *node = (*node + shift % nodes as u32) % nodes as u32;
        }
        let (pattern, matrix, dense) = sparse_and_dense(&mesh, block, 40);
        let x: Vec<f64> = (0..nodes * block).map(|k| (k as f64 * 0.7).sin()).collect();
        let b = dense_product(&dense, &x);
        for (sparse, dense) in matrix.multiply(&pattern, &x).iter().zip(&b) {
            prop_assert!((sparse - dense).abs() < 1e-12 * dense.abs().max(1.0));
        }
        for k in 0..x.len() {
            let mut unit = vec![0.0; x.len()];
            unit[k] = 1.0;
            for (sparse, dense) in matrix.multiply(&pattern, &unit).iter().zip(&dense[k * x.len()..]) {
                prop_assert!((sparse - dense).abs() < 1e-12);
            }
        }
        let form: f64 = x.iter().zip(&b).map(|(x, b)| x * b).sum();
        prop_assert!((matrix.quadratic_form(&pattern, &x) - form).abs() < 1e-12 * form.max(1.0));
        let reversed: Vec<f64> = x.iter().rev().copied().collect();
        let mut solved = [x.clone(), reversed.clone()].concat();
        Cholesky::new(&pattern, &mesh.points).unwrap().factorize(&matrix).unwrap().solve(&mut solved);
        let expected = dense_solution(dense, [x, reversed].concat());
        for (sparse, dense) in solved.iter().zip(&expected) {
            prop_assert!((sparse - dense).abs() < 1e-9 * dense.abs().max(1.0));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_mesh_and_block_size_is_solved(nodes in 1_usize..90, block in 1_usize..5, seed: u64, flat: bool) {
        let mesh = random_mesh(nodes, seed, flat);
        let pattern = mesh.pattern(block);
        let matrix = assembled(&pattern, 0.5);
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        prop_assert!(solution_error(&cholesky.factorize(&matrix).unwrap(), &matrix, &pattern) < 1e-11);
        prop_assert!(solution_error(&cholesky.factorize_compact(&matrix).unwrap(), &matrix, &pattern) < 1e-4);
        // The coordinates determine the ordering alone.
        let coincident = Cholesky::new(&pattern, &vec![[1.0, 2.0, 3.0]; nodes]).unwrap();
        prop_assert!(solution_error(&coincident.factorize(&matrix).unwrap(), &matrix, &pattern) < 1e-11);
    }
}

#[test]
fn the_symbolic_factorization_is_reused_for_another_matrix() {
    let mesh = quads(5, 5);
    for block in [2, 3] {
        let (pattern, first, _) = sparse_and_dense(&mesh, block, 40);
        let mut second = first.clone();
        second.add_scaled(1.0, &first);
        let cholesky = Cholesky::new(&pattern, &mesh.points).unwrap();
        let solve = |matrix: &SymmetricMatrix| {
            let mut x = vec![1.0; 36 * block];
            cholesky.factorize(matrix).unwrap().solve(&mut x);
            x
        };
        for (a, b) in solve(&first).iter().zip(&solve(&second)) {
            assert!((a - 2.0 * b).abs() < 1e-9 * a.abs().max(1.0));
        }
    }
}

#[test]
fn the_lower_triangle_lists_the_entries_by_columns() {
    for block in [2, 3] {
        let (pattern, matrix, dense) = sparse_and_dense(&quads(3, 2), block, 40);
        let n = pattern.num_dofs();
        let (starts, rows) = pattern.lower_triangle();
        let mut found = vec![0.0; n * n];
        for column in 0..n {
            for at in starts[column]..starts[column + 1] {
                found[rows[at] * n + column] = matrix.values()[at];
            }
        }
        for i in 0..n {
            for j in 0..n {
                let expected = if i >= j { dense[i * n + j] } else { 0.0 };
                assert!((found[i * n + j] - expected).abs() < 1e-12, "block {block}: row {i}, column {j}");
            }
        }
    }
}

#[test]
fn a_matrix_with_nan_is_refused() {
    let mesh = Mesh { points: vec![[0.0; 3]; 3], cells: vec![vec![0, 1, 2]] };
    let pattern = mesh.pattern(1);
    let mut matrix = SymmetricMatrix::zeros(&pattern);
    matrix.add_cell(&pattern, 0, &[f64::NAN; 9]);
    let error = Cholesky::new(&pattern, &mesh.points).unwrap().factorize(&matrix).unwrap_err();
    assert_eq!(error, SparseError::NonFinite);
}
