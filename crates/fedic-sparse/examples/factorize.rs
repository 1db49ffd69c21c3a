//! Factorises the system of a mesh and says what it took; `benches/python/cholesky.py` compares it with CHOLMOD.
//!
//!     factorize FOLDER THREADS SECONDS KIND
//!
//! The kind is `double`, `compact` (a factor in single precision) or `degree` (double, ordered by minimum degree).
//! The folder holds `points.f64` (two numbers per node) and `cells.u32` (nodes per cell, then those of each cell); the
//! matrix is left there for others: `starts.i32`, `rows.i32`, `values.f64`, the lower triangle by columns.

#![allow(clippy::unwrap_used, missing_docs)]

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use fedic_sparse::{Cholesky, Pattern, SymmetricMatrix};

/// Unknowns per node.
const BLOCK: usize = 2;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let (folder, threads) = (Path::new(&arguments[1]), arguments[2].parse().unwrap());
    let seconds = Duration::from_secs_f64(arguments[3].parse().unwrap());
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap()
        .install(|| measure(folder, seconds, &arguments[4]));
}

fn measure(folder: &Path, seconds: Duration, kind: &str) {
    let read = |name: &str| fs::read(folder.join(name)).unwrap();
    let coordinates: Vec<f64> = numbers(&read("points.f64"), f64::from_le_bytes);
    let cells: Vec<u32> = numbers(&read("cells.u32"), u32::from_le_bytes);
    let (width, cells) = (cells[0] as usize, &cells[1..]);
    let points: Vec<[f64; 3]> = coordinates.chunks_exact(2).map(|p| [p[0], p[1], 0.0]).collect();
    let pattern = Pattern::new(points.len(), BLOCK, cells.chunks_exact(width));
    let matrix = assemble(&pattern);
    let (starts, rows) = pattern.lower_triangle();
    let as_bytes =
        |indices: Vec<usize>| -> Vec<u8> { indices.iter().flat_map(|&i| (i as i32).to_le_bytes()).collect() };
    fs::write(folder.join("starts.i32"), as_bytes(starts)).unwrap();
    fs::write(folder.join("rows.i32"), as_bytes(rows)).unwrap();
    fs::write(folder.join("values.f64"), matrix.values().iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
        .unwrap();

    let before = resident();
    let (symbolic, cholesky) = fastest(seconds, || match kind {
        "degree" => Cholesky::new(&pattern).unwrap(),
        _ => Cholesky::of_mesh(&pattern, &points).unwrap(),
    });
    let (numeric, factor) = fastest(seconds, || match kind {
        "compact" => cholesky.factorize_compact(&matrix).unwrap(),
        _ => cholesky.factorize(&matrix).unwrap(),
    });
    let exact: Vec<f64> = (0..pattern.num_dofs()).map(|k| (k as f64).sin()).collect();
    let loads = matrix.multiply(&pattern, &exact);
    let (solve, x) = fastest(seconds, || {
        let mut x = loads.clone();
        factor.solve(&mut x);
        x
    });
    let error = x.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!(
        "dofs {} entries {} work {:.3e} order {symbolic:.6} numeric {numeric:.6} solve {solve:.6} error {error:.2e} peak_MB {:.1}",
        pattern.num_dofs(),
        factor.num_entries(),
        cholesky.work(),
        peak() - before,
    );
}

/// The shortest time of some runs, and what the last one made.
fn fastest<T>(seconds: Duration, run: impl Fn() -> T) -> (f64, T) {
    let begin = Instant::now();
    let mut best = f64::MAX;
    loop {
        let start = Instant::now();
        let made = run();
        best = best.min(start.elapsed().as_secs_f64());
        if begin.elapsed() > seconds {
            return (best, made);
        }
    }
}

/// A matrix of dominant diagonal, its entries without order.
fn assemble(pattern: &Pattern) -> SymmetricMatrix {
    let mut matrix = SymmetricMatrix::zeros(pattern);
    for cell in 0..pattern.num_cells() {
        let size = pattern.cell(cell).len() * BLOCK;
        let mut dense = vec![0.0; size * size];
        for i in 0..size {
            dense[i * size + i] = 2.0;
            for j in 0..i {
                let value = -0.4 * ((cell * 17 + i * 5 + j) as f64 * 0.618_033_988_749_895).fract();
                dense[i * size + j] = value;
                dense[j * size + i] = value;
            }
        }
        matrix.add_cell(pattern, cell, &dense);
    }
    matrix
}

fn numbers<T, const N: usize>(bytes: &[u8], number: impl Fn([u8; N]) -> T) -> Vec<T> {
    bytes.as_chunks().0.iter().map(|&chunk| number(chunk)).collect()
}

/// Megabytes that this process holds.
fn resident() -> f64 {
    status("VmRSS:")
}

/// The most it ever held.
fn peak() -> f64 {
    status("VmHWM:")
}

fn status(name: &str) -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find(|line| line.starts_with(name)).unwrap_or_default();
    line.split_whitespace().nth(1).map_or(f64::NAN, |kilobytes| kilobytes.parse::<f64>().unwrap() * 1.024e-3)
}
