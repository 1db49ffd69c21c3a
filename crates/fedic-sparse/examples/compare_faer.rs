//! Compares this crate's Cholesky factorization with the sparse Cholesky factorization of faer.
//!
//!     cargo run --release -p fedic-sparse --example compare_faer -- [--dofs 10000,100000,1000000] [--threads 1,2]
//!         [--repeats 9] [--components 2]
//!
//! Both solve the Gauss-Newton system of digital image correlation on a square grid of quads in one process. faer is
//! given the elimination order found by nested dissection and its supernodal factorization is forced. Runs alternate
//! between the two, times are medians, and a ratio is the median over the pairs (above 1: this crate needs less).

#![allow(clippy::panic, clippy::unwrap_used, missing_docs)]

mod common;

use std::time::Instant;

use common::{correlation_matrix, pattern, peak, quads, reset_peak, resident, rotating_sheet};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};
use fedic_sparse::{Cholesky, Pattern, SparseError, SpdFactor, SpdSolver, SymmetricMatrix};

/// faer's supernodal Cholesky factorization with a given elimination order.
struct Faer {
    starts: Vec<usize>,
    rows: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
    par: Par,
}

/// A factor of faer and the values it stores.
struct FaerFactor<'a> {
    solver: &'a Faer,
    values: Vec<f64>,
}

impl Faer {
    fn new(pattern: &Pattern, order: &[u32], threads: usize) -> Self {
        let block = pattern.block();
        let (starts, rows) = pattern.lower_triangle();
        let forward: Vec<usize> =
            order.iter().flat_map(|&node| (0..block).map(move |c| node as usize * block + c)).collect();
        let mut inverse = vec![0; forward.len()];
        forward.iter().enumerate().for_each(|(at, &dof)| inverse[dof] = at);
        let n = forward.len();
        let symbolic = factorize_symbolic_cholesky(
            SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, n)),
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..Default::default()
            },
        )
        .unwrap();
        let par = if threads == 1 { Par::Seq } else { Par::rayon(threads) };
        Self { starts, rows, symbolic, par }
    }

    fn factorize(&self, matrix: &SymmetricMatrix) -> Result<FaerFactor<'_>, String> {
        let n = self.symbolic.nrows();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.starts, None, &self.rows);
        let matrix = SparseColMatRef::new(pattern, matrix.values());
        let mut values = vec![0.0; self.symbolic.len_val()];
        let mut buffer = MemBuffer::new(self.symbolic.factorize_numeric_llt_scratch::<f64>(self.par, Spec::default()));
        self.symbolic
            .factorize_numeric_llt(
                &mut values,
                matrix,
                Side::Lower,
                LltRegularization::default(),
                self.par,
                MemStack::new(&mut buffer),
                Spec::default(),
            )
            .map_err(|error| format!("{error:?}"))?;
        Ok(FaerFactor { solver: self, values })
    }
}

impl FaerFactor<'_> {
    fn solve(&self, rhs: &mut [f64]) {
        let Faer { symbolic, par, .. } = self.solver;
        let mut buffer = MemBuffer::new(symbolic.solve_in_place_scratch::<f64>(1, *par));
        let rhs = MatMut::from_column_major_slice_mut(rhs, symbolic.nrows(), 1);
        let factor = LltRef::new(symbolic, &self.values);
        factor.solve_in_place_with_conj(Conj::No, rhs, *par, MemStack::new(&mut buffer));
    }

    /// The smallest pivot relative to the largest.
    fn smallest_pivot(&self) -> f64 {
        let SymbolicCholeskyRaw::Supernodal(symbolic) = self.solver.symbolic.raw() else { return f64::NAN };
        let factor = SupernodalLltRef::new(symbolic, &self.values);
        let (mut smallest, mut largest) = (f64::MAX, 0.0_f64);
        for supernode in 0..symbolic.n_supernodes() {
            let values = factor.supernode(supernode).val();
            for j in 0..values.ncols() {
                let pivot = values[(j, j)].powi(2);
                (smallest, largest) = (smallest.min(pivot), largest.max(pivot));
            }
        }
        smallest / largest
    }
}

fn main() {
    let (mut dofs, mut threads) = (vec![10_000, 100_000, 1_000_000], vec![1, 2]);
    let (mut repeats, mut components) = (9, 2);
    let mut arguments = std::env::args().skip(1);
    while let Some(name) = arguments.next() {
        let value = arguments.next().unwrap();
        let list = |value: &str| value.split(',').map(|number| number.parse().unwrap()).collect::<Vec<usize>>();
        match name.as_str() {
            "--dofs" => dofs = list(&value),
            "--threads" => threads = list(&value),
            "--repeats" => repeats = value.parse().unwrap(),
            "--components" => components = value.parse().unwrap(),
            other => panic!("unknown option {other}"),
        }
    }
    println!("faer 0.24 with the same elimination order; {components} degrees of freedom per node; {repeats} pairs\n");
    println!("    dofs threads  step           fedic        faer   faer / fedic");
    for &dofs in &dofs {
        let side = (dofs as f64 / components as f64).sqrt().round() as u32;
        let (points, cells) = quads(side);
        let pattern = pattern(points.len(), components, &cells);
        let matrix = correlation_matrix(&pattern);
        for &threads in &threads {
            in_pool(threads, || compare(&pattern, &points, &matrix, threads, repeats));
        }
        in_pool(1, || compare_bits(&pattern, &points, &matrix));
    }
    undetermined_rotation();
}

fn in_pool<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

/// Prints the times and memory of both solvers.
fn compare(pattern: &Pattern, points: &[[f64; 3]], matrix: &SymmetricMatrix, threads: usize, repeats: usize) {
    let dofs = pattern.num_dofs();
    let row = |step: &str, [fedic, faer, ratio]: [f64; 3], unit: &str| {
        println!("{dofs:8} {threads:7}  {step:9} {fedic:9.3} {unit:2} {faer:8.3} {unit:2} {ratio:14.2}");
    };
    let symbolic = paired(
        repeats,
        || Cholesky::new(pattern, points).unwrap(),
        |cholesky| Faer::new(pattern, cholesky.elimination_order(), threads),
    );
    row("symbolic", symbolic.figures(1e3), "ms");
    let (fedic, faer) = (symbolic.fedic, symbolic.faer);

    let numeric = paired(repeats, || fedic.factorize(matrix).unwrap(), |_| faer.factorize(matrix).unwrap());
    row("numeric", numeric.figures(1e3), "ms");
    let (fedic_factor, faer_factor) = (numeric.fedic, numeric.faer);

    let exact: Vec<f64> = (0..dofs).map(|k| (k as f64).sin()).collect();
    let load = matrix.multiply(pattern, &exact);
    let solved = |solve: &dyn Fn(&mut [f64])| {
        let mut x = load.clone();
        solve(&mut x);
        x
    };
    let solve = paired(3 * repeats, || solved(&|x| fedic_factor.solve(x)), |_| solved(&|x| faer_factor.solve(x)));
    row("solve", solve.figures(1e3), "ms");
    let error = |x: &[f64]| x.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let [fedic_error, faer_error] = [error(&solve.fedic), error(&solve.faer)];
    println!("{dofs:8} {threads:7}  error     {fedic_error:9.1e}    {faer_error:8.1e}");

    let megabytes = [fedic_factor.num_entries(), faer_factor.values.len()].map(|values| 8e-6 * values as f64);
    row("factor", with_ratio(megabytes), "MB");
    drop((fedic_factor, faer_factor));
    let peaks = [
        peak_of(|| fedic.factorize(matrix).unwrap().num_entries()),
        peak_of(|| faer.factorize(matrix).unwrap().values.len()),
    ];
    row("peak", with_ratio(peaks), "MB");
    if let Ok(compact) = fedic.factorize_compact(matrix)
        && compact.is_compact()
    {
        let compact_solve = paired(3 * repeats, || solved(&|x| compact.solve(x)), |_| ());
        println!(
            "{dofs:8} {threads:7}  fedic's factor in single precision: {:.3} MB, solve {:.3} ms",
            4e-6 * compact.num_entries() as f64,
            1e3 * compact_solve.figures(1.0)[0]
        );
    }
}

fn with_ratio([fedic, faer]: [f64; 2]) -> [f64; 3] {
    [fedic, faer, faer / fedic]
}

/// Results and times of alternating runs.
struct Paired<A, B> {
    fedic: A,
    faer: B,
    times: Vec<[f64; 2]>,
}

impl<A, B> Paired<A, B> {
    /// Median times of both and median ratio.
    fn figures(&self, scale: f64) -> [f64; 3] {
        let median = |of: &dyn Fn(&[f64; 2]) -> f64| {
            let mut all: Vec<f64> = self.times.iter().map(of).collect();
            all.sort_by(f64::total_cmp);
            all[all.len() / 2]
        };
        [median(&|t| scale * t[0]), median(&|t| scale * t[1]), median(&|t| t[1] / t[0])]
    }
}

/// Runs both by turns; `faer` is given the result of `fedic`.
fn paired<A, B>(repeats: usize, fedic: impl Fn() -> A, faer: impl Fn(&A) -> B) -> Paired<A, B> {
    let pair = || {
        let start = Instant::now();
        let fedic = fedic();
        let middle = Instant::now();
        let faer = faer(&fedic);
        (fedic, faer, [(middle - start).as_secs_f64(), middle.elapsed().as_secs_f64()])
    };
    let _warm_up = pair();
    let mut times = Vec::new();
    loop {
        let (fedic, faer, time) = pair();
        times.push(time);
        if times.len() >= repeats {
            return Paired { fedic, faer, times };
        }
    }
}

/// Peak memory beyond the present, in megabytes.
fn peak_of<T>(run: impl FnOnce() -> T) -> f64 {
    if !reset_peak() {
        return f64::NAN;
    }
    let before = resident();
    run();
    peak() - before
}

/// Says whether factors and solutions have the same bits on 1, 2 and 4 threads.
fn compare_bits(pattern: &Pattern, points: &[[f64; 3]], matrix: &SymmetricMatrix) {
    let load: Vec<f64> = (0..pattern.num_dofs()).map(|k| (k as f64).cos()).collect();
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<u64>>();
    let cholesky = Cholesky::new(pattern, points).unwrap();
    let run = |threads: usize| {
        in_pool(threads, || {
            let mut fedic = load.clone();
            cholesky.factorize(matrix).unwrap().solve(&mut fedic);
            let solver = Faer::new(pattern, cholesky.elimination_order(), threads);
            let factor = solver.factorize(matrix).unwrap();
            let mut faer = load.clone();
            factor.solve(&mut faer);
            [bits(&fedic), bits(&factor.values), bits(&faer)]
        })
    };
    let one = run(1);
    let mut same = [true; 3];
    for threads in [2, 4] {
        let other = run(threads);
        (0..3).for_each(|k| same[k] &= one[k] == other[k]);
    }
    let [fedic, factor, solution] = same.map(|same| if same { "the same bits" } else { "DIFFERENT bits" });
    println!(
        "{:8} 1, 2, 4  fedic, solution: {fedic}; faer, factor: {factor}, solution: {solution}\n",
        pattern.num_dofs()
    );
}

/// What both say of a sheet whose rotation is undetermined.
fn undetermined_rotation() {
    for side in [20, 71, 224] {
        let (points, cells) = quads(side);
        let pattern = pattern(points.len(), 2, &cells);
        let matrix = rotating_sheet(&pattern);
        let cholesky = Cholesky::new(&pattern, &points).unwrap();
        let fedic = match cholesky.factorize(&matrix) {
            Ok(_) => "no error".to_owned(),
            Err(SparseError::Singular { dofs }) => format!("undetermined degrees of freedom {dofs:?}"),
            Err(other) => other.to_string(),
        };
        let solver = Faer::new(&pattern, cholesky.elimination_order(), 1);
        let faer = match solver.factorize(&matrix) {
            Ok(factor) => {
                let mut x: Vec<f64> = (0..pattern.num_dofs()).map(|k| (k as f64).cos()).collect();
                factor.solve(&mut x);
                let largest = x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
                format!("no error, smallest / largest pivot {:.0e}, largest |x| {largest:.0e}", factor.smallest_pivot())
            }
            Err(error) => error,
        };
        println!("undetermined rotation, {} dofs: fedic: {fedic}; faer: {faer}", pattern.num_dofs());
    }
}
