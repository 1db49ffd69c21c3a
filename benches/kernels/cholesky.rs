//! The linear system of a grid of quads: pattern, symbolic and numeric factorisation, solution, per unknown.

#![allow(clippy::unwrap_used, missing_docs)]

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use fedic_benches::criterion;
use fedic_sparse::{Cholesky, Pattern, SymmetricMatrix};

const NODES_PER_CELL: usize = 4;
const BLOCK: usize = 2;
const SIZE: usize = NODES_PER_CELL * BLOCK;

fn cholesky(c: &mut Criterion) {
    let mut group = c.benchmark_group("cholesky");
    for dofs in [10_000_u32, 100_000] {
        let side = (f64::from(dofs) / BLOCK as f64).sqrt().round() as u32;
        let cells = quads(side);
        let build = || Pattern::new((side * side) as usize, BLOCK, cells.iter().map(<[u32; 4]>::as_slice));
        let pattern = build();
        let points: Vec<[f64; 3]> =
            (0..side * side).map(|node| [f64::from(node % side), f64::from(node / side), 0.0]).collect();
        let symbolic = Cholesky::of_mesh(&pattern, &points).unwrap();
        let matrix = assemble(&pattern);
        let factor = symbolic.factorize(&matrix).unwrap();
        let loads = vec![1.0; pattern.num_dofs()];

        group.throughput(Throughput::Elements(pattern.num_dofs() as u64));
        group.bench_function(format!("pattern/{dofs}"), |b| b.iter(build));
        group.bench_function(format!("assembly/{dofs}"), |b| b.iter(|| assemble(&pattern)));
        group.bench_function(format!("symbolic/{dofs}"), |b| b.iter(|| Cholesky::of_mesh(&pattern, &points).unwrap()));
        group.bench_function(format!("numeric/{dofs}"), |b| b.iter(|| symbolic.factorize(&matrix).unwrap()));
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

/// A matrix of dominant diagonal.
fn assemble(pattern: &Pattern) -> SymmetricMatrix {
    let dense: [f64; SIZE * SIZE] = std::array::from_fn(|k| if k / SIZE == k % SIZE { 2.0 } else { -0.2 });
    let mut matrix = SymmetricMatrix::zeros(pattern);
    (0..pattern.num_cells()).for_each(|cell| matrix.add_cell(pattern, cell, &dense));
    matrix
}

criterion_group! { name = benches; config = criterion(); targets = cholesky }
criterion_main!(benches);
