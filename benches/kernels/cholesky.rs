//! The linear system of a grid of quads: pattern, assembly, symbolic and numeric factorization, solution, per unknown.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use fedic_benches::criterion;
use fedic_sparse::{Cholesky, Pattern, SpdFactor, SpdSolver, SymmetricMatrix};

const NODES_PER_CELL: usize = 4;
const COMPONENTS: usize = 2;
const CELL_DOFS: usize = NODES_PER_CELL * COMPONENTS;

fn cholesky(c: &mut Criterion) {
    let mut group = c.benchmark_group("cholesky");
    for dofs in [10_000_u32, 100_000] {
        let side = (f64::from(dofs) / COMPONENTS as f64).sqrt().round() as u32;
        let cells = quads(side);
        let build = || Pattern::new((side * side) as usize, COMPONENTS, cells.iter().map(<[u32; 4]>::as_slice));
        let pattern = build();
        let points: Vec<[f64; 3]> =
            (0..side * side).map(|node| [f64::from(node % side), f64::from(node / side), 0.0]).collect();
        let solver = Cholesky::new(&pattern, &points).unwrap();
        let matrix = assemble(&pattern);
        let factor = solver.factorize(&matrix).unwrap();
        let loads = vec![1.0; pattern.num_dofs()];

        group.throughput(Throughput::Elements(pattern.num_dofs() as u64));
        group.bench_function(format!("pattern/{dofs}"), |b| b.iter(build));
        group.bench_function(format!("assembly/{dofs}"), |b| b.iter(|| assemble(&pattern)));
        group.bench_function(format!("symbolic/{dofs}"), |b| b.iter(|| Cholesky::new(&pattern, &points).unwrap()));
        group.bench_function(format!("numeric/{dofs}"), |b| b.iter(|| solver.factorize(&matrix).unwrap()));
        group.bench_function(format!("solve/{dofs}"), |b| {
            b.iter_batched_ref(|| loads.clone(), |x| factor.solve(x), BatchSize::LargeInput);
        });
    }
    group.finish();
}

/// Cells of a grid of `side * side` nodes.
fn quads(side: u32) -> Vec<[u32; NODES_PER_CELL]> {
    let corner = |i, j| j * side + i;
    let rows = (1..side).flat_map(|j| (1..side).map(move |i| (i, j)));
    rows.map(|(i, j)| [corner(i - 1, j - 1), corner(i, j - 1), corner(i, j), corner(i - 1, j)]).collect()
}

/// A diagonally dominant matrix.
fn assemble(pattern: &Pattern) -> SymmetricMatrix {
    let dense: [f64; CELL_DOFS * CELL_DOFS] =
        std::array::from_fn(|k| if k / CELL_DOFS == k % CELL_DOFS { 2.0 } else { -0.2 });
    let mut matrix = SymmetricMatrix::zeros(pattern);
    (0..pattern.num_cells()).for_each(|cell| matrix.add_cell(pattern, cell, &dense));
    matrix
}

criterion_group! { name = benches; config = criterion(); targets = cholesky }
criterion_main!(benches);
