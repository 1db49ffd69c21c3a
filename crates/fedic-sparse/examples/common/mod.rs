//! Meshes, matrices and measurements for the examples.

#![allow(dead_code, unreachable_pub)]

use std::fs;
use std::time::{Duration, Instant};

use fedic_sparse::{Pattern, SymmetricMatrix};

/// Points of a quad: a grid of so many by as many, each with one image gradient.
const POINTS: usize = 6;

/// Nodes of a square grid, side by side, and its quads.
pub fn quads(side: u32) -> (Vec<[f64; 3]>, Vec<[u32; 4]>) {
    let points = (0..side * side).map(|node| [f64::from(node % side), f64::from(node / side), 0.0]).collect();
    let corner = |i, j| j * side + i;
    let cells = (1..side).flat_map(|j| (1..side).map(move |i| (i, j)));
    let cells = cells.map(|(i, j)| [corner(i - 1, j - 1), corner(i, j - 1), corner(i, j), corner(i - 1, j)]);
    (points, cells.collect())
}

/// Pattern of quads with `block` degrees of freedom per node.
pub fn pattern(num_nodes: usize, block: usize, cells: &[[u32; 4]]) -> Pattern {
    Pattern::new(num_nodes, block, cells.iter().map(<[u32; 4]>::as_slice))
}

/// The Gauss-Newton matrix of digital image correlation on quads: `sum_k (N_k q_k) (N_k q_k)^T` over points with bilinear
/// shape functions `N` and pseudo-random image gradients `q`.
pub fn correlation_matrix(pattern: &Pattern) -> SymmetricMatrix {
    let mut matrix = SymmetricMatrix::zeros(pattern);
    let block = pattern.block();
    let size = 4 * block;
    let mut dense = vec![0.0; size * size];
    let mut random = random();
    for cell in 0..pattern.num_cells() {
        dense.fill(0.0);
        for point in 0..POINTS * POINTS {
            let [x, y] = [point % POINTS, point / POINTS].map(|k| (k as f64 + 0.5) / POINTS as f64);
            let shape = [(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y];
            let gradient: Vec<f64> = (0..block).map(|_| random() - 0.5).collect();
            let product = |k: usize| shape[k / block] * gradient[k % block];
            for (k, value) in dense.iter_mut().enumerate() {
                *value += product(k / size) * product(k % size);
            }
        }
        matrix.add_cell(pattern, cell, &dense);
    }
    matrix
}

/// A sheet of quads in the plane, free but for its first node, which is fixed: its rotation is undetermined.
///
/// The matrix of a cell is the projection on the complement of the cell's rigid motions.
pub fn rotating_sheet(pattern: &Pattern) -> SymmetricMatrix {
    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    // Translations and rotation of a square, orthonormal.
    let mode = |k: usize, mode: usize| match mode {
        2 => 0.5_f64.sqrt() * [-corners[k / 2][1], corners[k / 2][0]][k % 2],
        direction => 0.5 * f64::from(u8::from(k % 2 == direction)),
    };
    let entry = |i: usize, j: usize| f64::from(u8::from(i == j)) - (0..3).map(|m| mode(i, m) * mode(j, m)).sum::<f64>();
    let dense: Vec<f64> = (0..64).map(|k| entry(k / 8, k % 8)).collect();
    let mut matrix = SymmetricMatrix::zeros(pattern);
    (0..pattern.num_cells()).for_each(|cell| matrix.add_cell(pattern, cell, &dense));
    let mut support = vec![0.0; 64];
    (support[0], support[9]) = (1.0, 1.0);
    matrix.add_cell(pattern, 0, &support);
    matrix
}

/// Pseudo-random numbers between 0 and 1.
fn random() -> impl FnMut() -> f64 {
    let mut state = 11_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The shortest time of repetitions over a duration, in seconds, and the last result.
pub fn fastest<T>(duration: Duration, run: impl Fn() -> T) -> (f64, T) {
    let begin = Instant::now();
    let mut best = f64::MAX;
    loop {
        let start = Instant::now();
        let result = run();
        best = best.min(start.elapsed().as_secs_f64());
        if begin.elapsed() > duration {
            return (best, result);
        }
    }
}

/// Resident memory of this process in megabytes; NaN where the system does not report it.
pub fn resident() -> f64 {
    status("VmRSS:")
}

/// Peak resident memory since the start of the process or the last [`reset_peak`], in megabytes.
pub fn peak() -> f64 {
    status("VmHWM:")
}

/// Begins a new measurement of the peak memory; says whether the system allows it.
pub fn reset_peak() -> bool {
    fs::write("/proc/self/clear_refs", "5").is_ok()
}

fn status(name: &str) -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with(name)).unwrap_or_default();
    let kilobytes = line.split_whitespace().nth(1).and_then(|number| number.parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kilobytes| kilobytes * 1.024e-3)
}
