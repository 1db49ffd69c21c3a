//! Assembly, product and Cholesky solution against dense linear algebra.

#![allow(clippy::unwrap_used, missing_docs)]

use fedic_sparse::{Cholesky, Pattern, SparseError, SymmetricMatrix};
use proptest::prelude::*;

/// A strip of quads: `columns` by `rows`, nodes numbered along x first.
fn grid(columns: usize, rows: usize) -> Vec<Vec<u32>> {
    let node = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    cells.map(|(i, j)| vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]).collect()
}

/// `sum_k v_k v_k^T` of `rank` vectors: symmetric and semi-definite.
fn random_cell(size: usize, rank: usize, seed: &mut u64) -> Vec<f64> {
    let mut next = || {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    let mut dense = vec![0.0; size * size];
    for _ in 0..rank {
        let v: Vec<f64> = (0..size).map(|_| next()).collect();
        for i in 0..size {
            for j in 0..size {
                dense[i * size + j] += v[i] * v[j];
            }
        }
    }
    dense
}

fn assembled(cells: &[Vec<u32>], nodes: usize, block: usize, rank: usize) -> (Pattern, SymmetricMatrix, Vec<f64>) {
    let pattern = Pattern::new(nodes, block, cells.iter().map(Vec::as_slice));
    let mut matrix = SymmetricMatrix::zeros(&pattern);
    let n = nodes * block;
    let mut dense = vec![0.0; n * n];
    let mut seed = 7;
    for (index, cell) in cells.iter().enumerate() {
        let width = cell.len() * block;
        let local = random_cell(width, rank, &mut seed);
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
    fn product_and_solution_equal_dense_ones(columns in 1_usize..7, rows in 1_usize..7, block in 1_usize..4, shuffle: u32) {
        let nodes = (columns + 1) * (rows + 1);
        let mut cells = grid(columns, rows);
        // Any numbering of the nodes must do.
        for node in cells.iter_mut().flatten() {
            *node = (*node + shuffle % nodes as u32) % nodes as u32;
        }
        let (pattern, matrix, dense) = assembled(&cells, nodes, block, 40);
        let x: Vec<f64> = (0..nodes * block).map(|k| (k as f64 * 0.7).sin()).collect();
        let b = dense_product(&dense, &x);
        for (ours, theirs) in matrix.multiply(&pattern, &x).iter().zip(&b) {
            prop_assert!((ours - theirs).abs() < 1e-12 * theirs.abs().max(1.0));
        }
        for k in 0..x.len() {
            let mut unit = vec![0.0; x.len()];
            unit[k] = 1.0;
            for (ours, theirs) in matrix.multiply(&pattern, &unit).iter().zip(&dense[k * x.len()..]) {
                prop_assert!((ours - theirs).abs() < 1e-12);
            }
        }
        let form: f64 = x.iter().zip(&b).map(|(x, b)| x * b).sum();
        prop_assert!((matrix.quadratic_form(&pattern, &x) - form).abs() < 1e-12 * form.max(1.0));
        let reversed: Vec<f64> = x.iter().rev().copied().collect();
        let mut solved = [b, dense_product(&dense, &reversed)].concat();
        Cholesky::new(&pattern).unwrap().factorize(&matrix).unwrap().solve(&mut solved);
        for (ours, theirs) in solved.iter().zip(x.iter().chain(&reversed)) {
            prop_assert!((ours - theirs).abs() < 1e-9);
        }
    }
}

#[test]
fn a_node_without_stiffness_is_named() {
    for size in [3_usize, 40] {
        let cells = grid(size, size);
        let nodes = (size + 1) * (size + 1);
        let pattern = Pattern::new(nodes, 2, cells.iter().map(Vec::as_slice));
        let mut matrix = SymmetricMatrix::zeros(&pattern);
        let mut seed = 3;
        let corner = 0;
        for (index, cell) in cells.iter().enumerate() {
            let mut local = random_cell(8, 12, &mut seed);
            for k in 0..8 {
                if cell[k / 2] == corner {
                    for other in 0..8 {
                        local[k * 8 + other] = 0.0;
                        local[other * 8 + k] = 0.0;
                    }
                }
            }
            matrix.add_cell(&pattern, index, &local);
        }
        let error = Cholesky::new(&pattern).unwrap().factorize(&matrix).unwrap_err();
        assert_eq!(error, SparseError::Singular { dofs: vec![0, 1] }, "grid of {size}");
    }
}

#[test]
fn a_rank_deficient_system_is_singular() {
    let cells = grid(6, 5);
    let (pattern, matrix, _) = assembled(&cells, 42, 2, 1);
    let error = Cholesky::new(&pattern).unwrap().factorize(&matrix).unwrap_err();
    // 30 cells of one vector each leave at least 84 - 30 unknowns undetermined.
    assert!(matches!(&error, SparseError::Singular { dofs } if dofs.len() >= 54), "{error:?}");
}

#[test]
fn the_symbolic_part_serves_the_next_matrix() {
    let cells = grid(5, 5);
    let (pattern, first, _) = assembled(&cells, 36, 2, 40);
    let mut second = first.clone();
    second.add_scaled(1.0, &first);
    let cholesky = Cholesky::new(&pattern).unwrap();
    let solve = |matrix: &SymmetricMatrix| {
        let mut x = vec![1.0; 72];
        cholesky.factorize(matrix).unwrap().solve(&mut x);
        x
    };
    let once = solve(&first);
    let twice = solve(&second);
    for (a, b) in once.iter().zip(&twice) {
        assert!((a - 2.0 * b).abs() < 1e-9 * a.abs().max(1.0));
    }
}

#[test]
fn a_matrix_with_nan_is_refused() {
    let pattern = Pattern::new(3, 1, [[0_u32, 1, 2].as_slice()]);
    let mut matrix = SymmetricMatrix::zeros(&pattern);
    matrix.add_cell(&pattern, 0, &[f64::NAN; 9]);
    assert_eq!(Cholesky::new(&pattern).unwrap().factorize(&matrix).unwrap_err(), SparseError::NonFinite);
}
