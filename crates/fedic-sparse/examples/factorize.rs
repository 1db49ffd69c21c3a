//! Factorizes the system of a mesh, finds the entries of its inverse on the pattern, and reports time and memory.
//! `benches/python/cholesky.py` compares it with CHOLMOD.
//!
//!     factorize FOLDER THREADS SECONDS PRECISION
//!
//! `PRECISION` is `double` or `compact` (the factor is stored in single precision). `FOLDER` holds `points.f64` (two
//! coordinates per node) and `cells.u32` (nodes per cell, then the nodes of each cell). The matrix is written there for
//! other solvers: `starts.i32`, `rows.i32`, `values.f64`, the lower triangle by columns.

#![allow(clippy::panic, clippy::unwrap_used, missing_docs)]

mod common;

use std::fs;
use std::path::Path;
use std::time::Duration;

use common::{fastest, peak, reset_peak, resident};
use fedic_sparse::{Cholesky, Pattern, SpdFactor, SpdSolver, SymmetricMatrix};

/// Degrees of freedom per node.
const COMPONENTS: usize = 2;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let (folder, threads) = (Path::new(&arguments[1]), arguments[2].parse().unwrap());
    let duration = Duration::from_secs_f64(arguments[3].parse().unwrap());
    let compact = match arguments[4].as_str() {
        "double" => false,
        "compact" => true,
        other => panic!("the precision is double or compact, not {other}"),
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| measure(folder, duration, compact));
}

fn measure(folder: &Path, duration: Duration, compact: bool) {
    let read = |name: &str| fs::read(folder.join(name)).unwrap();
    let coordinates: Vec<f64> = parse(&read("points.f64"), f64::from_le_bytes);
    let cells: Vec<u32> = parse(&read("cells.u32"), u32::from_le_bytes);
    let (width, cells) = (cells[0] as usize, &cells[1..]);
    let points: Vec<[f64; 3]> = coordinates.chunks_exact(2).map(|p| [p[0], p[1], 0.0]).collect();
    let pattern = Pattern::new(points.len(), COMPONENTS, cells.chunks_exact(width));
    let matrix = diagonally_dominant(&pattern);
    let (starts, rows) = pattern.lower_triangle();
    let as_bytes =
        |indices: Vec<usize>| -> Vec<u8> { indices.iter().flat_map(|&i| (i as i32).to_le_bytes()).collect() };
    fs::write(folder.join("starts.i32"), as_bytes(starts)).unwrap();
    fs::write(folder.join("rows.i32"), as_bytes(rows)).unwrap();
    fs::write(folder.join("values.f64"), matrix.values().iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>())
        .unwrap();

    let before = resident();
    let (symbolic, cholesky) = fastest(duration, || Cholesky::new(&pattern, &points).unwrap());
    let (numeric, factor) = fastest(duration, || {
        if compact { cholesky.factorize_compact(&matrix) } else { cholesky.factorize(&matrix) }.unwrap()
    });
    let exact: Vec<f64> = (0..pattern.num_dofs()).map(|k| (k as f64).sin()).collect();
    let load = matrix.multiply(&pattern, &exact);
    let (solve, x) = fastest(duration, || {
        let mut x = load.clone();
        factor.solve(&mut x);
        x
    });
    let memory = peak() - before;
    let (measures_peak, before) = (reset_peak(), resident());
    let (inverse, _) = fastest(duration, || factor.selected_inverse().unwrap());
    let inverse_memory = if measures_peak { peak() - before } else { f64::NAN };
    let error = x.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!(
        "dofs {} entries {} work {:.3e} order {symbolic:.6} numeric {numeric:.6} solve {solve:.6} error {error:.2e} peak_MB {memory:.1} inverse {inverse:.6} inverse_peak_MB {inverse_memory:.1}",
        pattern.num_dofs(),
        factor.num_entries(),
        cholesky.work(),
    );
}

/// A diagonally dominant matrix with irregular entries.
fn diagonally_dominant(pattern: &Pattern) -> SymmetricMatrix {
    let mut matrix = SymmetricMatrix::zeros(pattern);
    for cell in 0..pattern.num_cells() {
        let size = pattern.cell(cell).len() * COMPONENTS;
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

fn parse<T, const N: usize>(bytes: &[u8], number: impl Fn([u8; N]) -> T) -> Vec<T> {
    bytes.as_chunks().0.iter().map(|&chunk| number(chunk)).collect()
}
