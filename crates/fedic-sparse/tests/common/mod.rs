//! Meshes and matrices for the tests.

#![allow(clippy::unwrap_used, missing_docs, dead_code, unreachable_pub)]

use fedic_sparse::{Pattern, SpdFactor, SymmetricMatrix};

/// Linear congruential generator.
pub struct Generator(pub u64);

impl Generator {
    /// The next number, between 0 and 1.
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// Nodes and cells.
pub struct Mesh {
    pub points: Vec<[f64; 3]>,
    pub cells: Vec<Vec<u32>>,
}

impl Mesh {
    pub fn num_nodes(&self) -> usize {
        self.points.len()
    }

    pub fn pattern(&self, block: usize) -> Pattern {
        Pattern::new(self.num_nodes(), block, self.cells.iter().map(Vec::as_slice))
    }

    /// Adds a cell of one node for each node.
    pub fn with_node_cells(mut self) -> Self {
        self.cells.extend((0..self.num_nodes() as u32).map(|node| vec![node]));
        self
    }
}

/// A grid of quads in the plane.
pub fn quads(columns: usize, rows: usize) -> Mesh {
    let node = |i: usize, j: usize| (j * (columns + 1) + i) as u32;
    let points = (0..=rows).flat_map(|j| (0..=columns).map(move |i| [i as f64, j as f64, 0.0])).collect();
    let cells = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
    let cells = cells.map(|(i, j)| vec![node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]).collect();
    Mesh { points, cells }
}

/// A grid of hexahedra.
pub fn hexahedra(side: usize) -> Mesh {
    let node = |i: usize, j: usize, k: usize| ((k * (side + 1) + j) * (side + 1) + i) as u32;
    let triples = |n: usize| (0..n).flat_map(move |k| (0..n).flat_map(move |j| (0..n).map(move |i| [i, j, k])));
    let points = triples(side + 1).map(|at| at.map(|x| x as f64)).collect();
    let corners = |[i, j, k]: [usize; 3]| triples(2).map(|[a, b, c]| node(i + a, j + b, k + c)).collect();
    Mesh { points, cells: triples(side).map(corners).collect() }
}

/// A jittered grid of quads with a hole and a random node numbering. The nodes in the hole belong to no cell.
pub fn perforated_grid(side: usize) -> Mesh {
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
    let in_hole = |i: usize, j: usize| i.abs_diff(side / 2).max(j.abs_diff(side / 3)) < side / 8;
    let cells = (0..side * side).map(|k| (k % side, k / side)).filter(|&(i, j)| !in_hole(i, j));
    let cells = cells.map(|(i, j)| vec![number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]);
    Mesh { points, cells: cells.collect() }
}

/// Points in the plane or in space, and cells of three or four points near each other.
pub fn random_mesh(nodes: usize, seed: u64, flat: bool) -> Mesh {
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
    Mesh { points, cells }
}

/// `sum_k v_k v_k^T` of `rank` random vectors: symmetric and semi-definite.
pub fn random_cell(size: usize, rank: usize, random: &mut Generator) -> Vec<f64> {
    let mut dense = vec![0.0; size * size];
    for _ in 0..rank {
        let v: Vec<f64> = (0..size).map(|_| random.next() - 0.5).collect();
        for i in 0..size {
            for j in 0..size {
                dense[i * size + j] += v[i] * v[j];
            }
        }
    }
    dense
}

/// Random cells of rank one with `diagonal` added to the diagonal of each: positive definite.
pub fn assembled(pattern: &Pattern, diagonal: f64) -> SymmetricMatrix {
    let mut random = Generator(11);
    let mut matrix = SymmetricMatrix::zeros(pattern);
    for cell in 0..pattern.num_cells() {
        let size = pattern.cell(cell).len() * pattern.block();
        let mut dense = random_cell(size, 1, &mut random);
        (0..size).for_each(|k| dense[k * size + k] += diagonal);
        matrix.add_cell(pattern, cell, &dense);
    }
    matrix
}

/// A matrix whose null space is that of the rigid motions of the mesh, with `block` (2 or 3) displacement components.
///
/// The matrix of a cell is the projection on the complement of the cell's rigid motions.
pub fn free_body(mesh: &Mesh, pattern: &Pattern) -> SymmetricMatrix {
    let mut matrix = SymmetricMatrix::zeros(pattern);
    for (index, cell) in mesh.cells.iter().enumerate() {
        let points: Vec<[f64; 3]> = cell.iter().map(|&node| mesh.points[node as usize]).collect();
        matrix.add_cell(pattern, index, &deformation_projection(&points, pattern.block()));
    }
    matrix
}

/// Identity minus the projection on the rigid motions of some points.
fn deformation_projection(points: &[[f64; 3]], block: usize) -> Vec<f64> {
    let size = points.len() * block;
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for mode in rigid_modes(points, block) {
        let mut mode = mode;
        for other in &basis {
            let along: f64 = mode.iter().zip(other).map(|(a, b)| a * b).sum();
            mode.iter_mut().zip(other).for_each(|(a, b)| *a -= along * b);
        }
        let norm = mode.iter().map(|a| a * a).sum::<f64>().sqrt();
        basis.push(mode.into_iter().map(|a| a / norm).collect());
    }
    let entry = |i: usize, j: usize| f64::from(i == j) - basis.iter().map(|mode| mode[i] * mode[j]).sum::<f64>();
    (0..size * size).map(|k| entry(k / size, k % size)).collect()
}

/// Translations and rotations of points, with two or three components.
pub fn rigid_modes(points: &[[f64; 3]], block: usize) -> Vec<Vec<f64>> {
    let translations =
        (0..block).map(|d| (0..points.len() * block).map(|k| f64::from(k % block == d)).collect::<Vec<f64>>());
    let planes: &[[usize; 2]] = if block == 2 { &[[0, 1]] } else { &[[0, 1], [1, 2], [2, 0]] };
    let rotations = planes.iter().map(|&[a, b]| {
        let mut mode = vec![0.0; points.len() * block];
        for (own, point) in mode.chunks_exact_mut(block).zip(points) {
            (own[a], own[b]) = (-point[b], point[a]);
        }
        mode
    });
    translations.chain(rotations).collect()
}

/// Largest error of the solution for the load of a known `x`, with one right-hand side and with three.
pub fn solution_error(factor: &impl SpdFactor, matrix: &SymmetricMatrix, pattern: &Pattern) -> f64 {
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

/// Solutions of right-hand sides, one after the other, by a dense Cholesky factorization without any reordering.
pub fn dense_solution(mut a: Vec<f64>, mut sides: Vec<f64>) -> Vec<f64> {
    let n = a.len().isqrt();
    for j in 0..n {
        for k in 0..j {
            (j..n).for_each(|i| a[i * n + j] -= a[i * n + k] * a[j * n + k]);
        }
        let pivot = a[j * n + j].sqrt();
        (j..n).for_each(|i| a[i * n + j] /= pivot);
    }
    for x in sides.chunks_exact_mut(n) {
        for i in 0..n {
            (0..i).for_each(|j| x[i] -= a[i * n + j] * x[j]);
            x[i] /= a[i * n + i];
        }
        for i in (0..n).rev() {
            (i + 1..n).for_each(|j| x[i] -= a[j * n + i] * x[j]);
            x[i] /= a[i * n + i];
        }
    }
    sides
}

/// Runs with this number of threads.
pub fn in_pool<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}
