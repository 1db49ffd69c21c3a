//! The order found from the mesh, the parallel factorisation and the compact factor.

#![allow(clippy::unwrap_used, missing_docs)]

use fedic_sparse::{Cholesky, Factor, Pattern, SparseError, SymmetricMatrix};
use proptest::prelude::*;
use rayon::ThreadPoolBuilder;

struct Generator(u64);

impl Generator {
    /// Between 0 and 1.
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Points of the plane or of space, and triangles and quads between any of them near each other.
fn random_mesh(nodes: usize, seed: u64, flat: bool) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
    let mut random = Generator(seed);
    let points: Vec<[f64; 3]> =
        (0..nodes).map(|_| [random.next(), 3.0 * random.next(), if flat { 0.0 } else { random.next() }]).collect();
    let distance = |a: usize, b: usize| (0..3).map(|d| (points[a][d] - points[b][d]).powi(2)).sum::<f64>();
    let cells = (0..nodes)
        .map(|node| {
            let mut others: Vec<usize> = (0..nodes).collect();
            others.sort_by(|&a, &b| distance(node, a).total_cmp(&distance(node, b)));
            others[..(3 + node % 2).min(nodes)].iter().map(|&other| other as u32).collect()
        })
        .collect();
    (points, cells)
}

/// A jittered grid of quads with a hole, its nodes numbered without order.
fn grid(side: usize) -> (Vec<[f64; 3]>, Vec<Vec<u32>>) {
    let mut random = Generator(5);
    let mut numbers: Vec<u32> = (0..((side + 1) * (side + 1)) as u32).collect();
    (1..numbers.len()).for_each(|k| numbers.swap(k, (random.next() * (k + 1) as f64) as usize));
    let number = |i: usize, j: usize| numbers[j * (side + 1) + i];
    let mut points = vec![[0.0; 3]; numbers.len()];
    for j in 0..=side {
        for i in 0..=side {
            points[number(i, j) as usize] = [i as f64 + 0.3 * random.next(), j as f64 + 0.3 * random.next(), 0.0];
        }
    }
    let hole = |i: usize, j: usize| i.abs_diff(side / 2).max(j.abs_diff(side / 3)) < side / 8;
    let cells = (0..side * side).map(|k| (k % side, k / side)).filter(|&(i, j)| !hole(i, j));
    let cells = cells.map(|(i, j)| vec![number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
    (points, cells.collect())
}

/// A positive definite matrix: random cells, and `diagonal` on the diagonal of each.
fn assembled(pattern: &Pattern, diagonal: f64) -> SymmetricMatrix {
    let mut random = Generator(11);
    let mut matrix = SymmetricMatrix::zeros(pattern);
    for cell in 0..pattern.num_cells() {
        let size = pattern.cell(cell).len() * pattern.block();
        let vector: Vec<f64> = (0..size).map(|_| random.next() - 0.5).collect();
        let mut dense: Vec<f64> = (0..size * size).map(|k| vector[k / size] * vector[k % size]).collect();
        (0..size).for_each(|k| dense[k * size + k] += diagonal);
        matrix.add_cell(pattern, cell, &dense);
    }
    matrix
}

fn pattern(nodes: usize, block: usize, cells: &[Vec<u32>]) -> Pattern {
    Pattern::new(nodes, block, cells.iter().map(Vec::as_slice))
}

/// Largest difference between `x` and the solution for the load of `x`, for one side and for three at once.
fn error(factor: &Factor, matrix: &SymmetricMatrix, pattern: &Pattern) -> f64 {
    let x: Vec<f64> = (0..pattern.num_dofs()).map(|k| (k as f64 * 0.7).sin()).collect();
    let load = matrix.multiply(pattern, &x);
    let mut single = load.clone();
    factor.solve(&mut single);
    let mut several = [load.clone(), load.iter().map(|b| 2.0 * b).collect(), load].concat();
    factor.solve(&mut several);
    let several = several
        .chunks_exact(x.len())
        .zip([1.0, 2.0, 1.0])
        .flat_map(|(side, factor)| side.iter().zip(&x).map(move |(found, x)| (found - factor * x).abs()));
    let several = several.fold(0.0, f64::max);
    single.iter().zip(&x).map(|(a, b)| (a - b).abs()).fold(several, f64::max)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_mesh_is_solved(nodes in 1_usize..90, block in 1_usize..4, seed: u64, flat: bool) {
        let (points, cells) = random_mesh(nodes, seed, flat);
        let pattern = pattern(nodes, block, &cells);
        let matrix = assembled(&pattern, 0.5);
        let ordered = Cholesky::of_mesh(&pattern, &points).unwrap();
        prop_assert!(error(&ordered.factorize(&matrix).unwrap(), &matrix, &pattern) < 1e-11);
        prop_assert!(error(&ordered.factorize_compact(&matrix).unwrap(), &matrix, &pattern) < 1e-4);
        // Coordinates only help to find the order: any will do.
        let anywhere = Cholesky::of_mesh(&pattern, &vec![[1.0, 2.0, 3.0]; nodes]).unwrap();
        prop_assert!(error(&anywhere.factorize(&matrix).unwrap(), &matrix, &pattern) < 1e-11);
    }
}

/// Large enough for several tasks and for fronts cut into tiles.
const SIDE: usize = 170;

#[test]
fn the_number_of_threads_changes_no_bit() {
    let (points, cells) = grid(SIDE);
    let pattern = pattern(points.len(), 2, &cells);
    // The nodes in the hole are coupled with nothing.
    let mut matrix = assembled(&pattern, 0.5);
    let used: Vec<bool> = {
        let mut used = vec![false; points.len()];
        cells.iter().flatten().for_each(|&node| used[node as usize] = true);
        used
    };
    let single = Cholesky::of_mesh(&pattern, &points).unwrap().factorize(&matrix).unwrap_err();
    let expected = (0..2 * points.len()).filter(|dof| !used[dof / 2]).collect();
    assert_eq!(single, SparseError::Singular { dofs: expected });
    let lonely: Vec<[u32; 1]> = (0..points.len() as u32).filter(|&node| !used[node as usize]).map(|n| [n]).collect();
    let pattern =
        Pattern::new(points.len(), 2, cells.iter().map(Vec::as_slice).chain(lonely.iter().map(|n| n.as_slice())));
    matrix = assembled(&pattern, 0.5);

    let bits = |threads: usize| {
        ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(|| {
            let cholesky = Cholesky::of_mesh(&pattern, &points).unwrap();
            let mut found = Vec::new();
            for factor in [cholesky.factorize(&matrix).unwrap(), cholesky.factorize_compact(&matrix).unwrap()] {
                for sides in [1, 3] {
                    let mut x: Vec<f64> = (0..sides * pattern.num_dofs()).map(|k| (k as f64).cos()).collect();
                    let mut alone = x.clone();
                    factor.solve(&mut x);
                    factor.solve_sequentially(&mut alone);
                    let [x, alone] = [x, alone].map(|x| x.into_iter().map(f64::to_bits).collect::<Vec<_>>());
                    assert!(x == alone, "{threads} threads and one alone");
                    found.extend(x);
                }
            }
            found
        })
    };
    let one = bits(1);
    for threads in [2, 3, 4] {
        assert!(bits(threads) == one, "{threads} threads");
    }
}

#[test]
fn large_meshes_are_solved_in_either_order() {
    let (points, cells) = grid(SIDE);
    let cells: Vec<Vec<u32>> = cells.into_iter().chain((0..points.len() as u32).map(|node| vec![node])).collect();
    let pattern = pattern(points.len(), 2, &cells);
    let matrix = assembled(&pattern, 0.5);
    let by_mesh = Cholesky::of_mesh(&pattern, &points).unwrap();
    let by_degree = Cholesky::new(&pattern).unwrap();
    assert!(by_mesh.work() < by_degree.work(), "{:e} {:e}", by_mesh.work(), by_degree.work());
    let double = by_mesh.factorize(&matrix).unwrap();
    assert!(error(&double, &matrix, &pattern) < 1e-11);
    assert!(error(&by_degree.factorize(&matrix).unwrap(), &matrix, &pattern) < 1e-11);
    let compact = by_mesh.factorize_compact(&matrix).unwrap();
    assert!(error(&compact, &matrix, &pattern) < 1e-5);
    assert!(compact.is_compact() && !double.is_compact());
    assert_eq!(compact.num_entries(), double.num_entries());
}

#[test]
fn an_ill_conditioned_matrix_is_kept_in_double_precision() {
    let (points, cells) = grid(20);
    let cells: Vec<Vec<u32>> = cells.into_iter().chain((0..points.len() as u32).map(|node| vec![node])).collect();
    let pattern = pattern(points.len(), 2, &cells);
    let matrix = assembled(&pattern, 1e-5);
    let compact = Cholesky::of_mesh(&pattern, &points).unwrap().factorize_compact(&matrix).unwrap();
    assert!(!compact.is_compact());
    assert!(error(&compact, &matrix, &pattern) < 1e-9);
}

#[test]
fn undetermined_unknowns_of_a_large_mesh_are_named() {
    let (points, cells) = grid(SIDE);
    let cells: Vec<Vec<u32>> = cells.into_iter().chain((0..points.len() as u32).map(|node| vec![node])).collect();
    let pattern = pattern(points.len(), 2, &cells);
    let mut matrix = assembled(&pattern, 0.5);
    let lonely = 4321;
    let touched = cells.iter().flatten().filter(|&&node| node as usize == lonely).count();
    assert!(touched > 1);
    for (index, cell) in cells.iter().enumerate() {
        let Some(at) = cell.iter().position(|&node| node as usize == lonely) else { continue };
        // Takes away all that couples the second component of this node, whatever was assembled.
        let size = 2 * cell.len();
        let mut random = matrix_of_cell(&pattern, index, size);
        random.iter_mut().enumerate().for_each(|(k, value)| {
            let own = [k / size, k % size].contains(&(2 * at + 1));
            *value = if own { -*value } else { 0.0 };
        });
        matrix.add_cell(&pattern, index, &random);
    }
    let cholesky = Cholesky::of_mesh(&pattern, &points).unwrap();
    for found in [cholesky.factorize(&matrix).err(), cholesky.factorize_compact(&matrix).err()] {
        assert_eq!(found, Some(SparseError::Singular { dofs: vec![2 * lonely + 1] }));
    }
}

/// What [`assembled`] adds for a cell.
fn matrix_of_cell(pattern: &Pattern, cell: usize, size: usize) -> Vec<f64> {
    let mut random = Generator(11);
    (0..cell).for_each(|before| (0..pattern.cell(before).len() * pattern.block()).for_each(|_| _ = random.next()));
    let vector: Vec<f64> = (0..size).map(|_| random.next() - 0.5).collect();
    let mut dense: Vec<f64> = (0..size * size).map(|k| vector[k / size] * vector[k % size]).collect();
    (0..size).for_each(|k| dense[k * size + k] += 0.5);
    dense
}

#[test]
fn a_long_strip_is_solved() {
    let nodes = 60_000_u32;
    let cells: Vec<Vec<u32>> = (0..nodes - 1).map(|node| vec![node, node + 1]).collect();
    let pattern = pattern(nodes as usize, 2, &cells);
    let matrix = assembled(&pattern, 0.5);
    // As a chain of supernodes the tree is as deep as it can be.
    let points: Vec<[f64; 3]> = (0..nodes).map(|node| [2.0_f64.powi(-(node as i32 % 1000)), 0.0, 0.0]).collect();
    for cholesky in [Cholesky::new(&pattern).unwrap(), Cholesky::of_mesh(&pattern, &points).unwrap()] {
        assert!(error(&cholesky.factorize(&matrix).unwrap(), &matrix, &pattern) < 1e-11);
    }
}
