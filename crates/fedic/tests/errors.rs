//! Impossible correlations are refused with the cause and its place.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use common::{Motion, mixed_mesh, render, warped_mesh};
use fedic::{
    CellType, Correlator, Error, FrontParallel, Image, ImageFrame, Interpolation, Mesh, Monitor, OptionError, Options,
    Progress, Quadrature, Rule, SolveError, Start, rectangle_mesh,
};
use fedic_synthetic::Speckle;

fn images() -> [Image; 2] {
    render(&ImageFrame, [90, 80], Speckle::new(5.0, 0.5, 4).unwrap(), Motion::translation([0.3, 0.2]))
}

fn flat(grey: f32) -> Image {
    Image::new(90, 80, vec![grey; 90 * 80]).unwrap()
}

fn quads(bounds: [f64; 4], size: f64) -> Mesh {
    rectangle_mesh(bounds, size, CellType::Quad).unwrap()
}

fn inner_mesh() -> Mesh {
    quads([20.0, 20.0, 60.0, 60.0], 20.0)
}

fn prepare(reference: &Image, mesh: &Mesh, options: Options) -> Result<Correlator, Error> {
    Correlator::new(Arc::new(reference.clone()), mesh, Arc::new(ImageFrame), options)
}

fn refused(result: Result<Correlator, Error>) -> Error {
    result.err().unwrap()
}

#[test]
fn cells_outside_the_image_are_named() {
    let [reference, _] = images();
    // The image ends at 89.5: the last column of cells leaves it.
    let mesh = quads([30.0, 20.0, 90.0, 60.0], 20.0);
    for quadrature in [Quadrature::default(), Quadrature::Pixel] {
        let error = refused(prepare(&reference, &mesh, Options::default().quadrature(quadrature)));
        assert_eq!(error, Error::MeshOutsideImage { cells: vec![2, 5], num_cells: 6, width: 90, height: 80 });
        assert_eq!(
            error.to_string(),
            "2 of 6 cells lie at least partly outside the reference image of 90 x 80 pixels, as this camera sees it: cells 2, \
             5; check the camera, the mesh's unit and its position"
        );
    }
}

#[test]
fn a_mesh_entirely_outside_the_image_is_refused() {
    let [reference, _] = images();
    // Millimetres given as metres are refused before billions of points are created.
    let camera = Arc::new(FrontParallel::new(1e7, [40.0, 40.0]).unwrap());
    let mesh = quads([-20.0, -20.0, 20.0, 20.0], 20.0);
    let error = Correlator::new(Arc::new(reference.clone()), &mesh, camera, Options::default()).err().unwrap();
    assert_eq!(error, Error::MeshOutsideImage { cells: vec![0, 1, 2, 3], num_cells: 4, width: 90, height: 80 });
    assert_eq!(
        error.to_string(),
        "the whole mesh lies outside the reference image of 90 x 80 pixels, as this camera sees it: cells 0, 1, 2, 3; check \
         the camera, the mesh's unit and its position"
    );
}

#[test]
fn a_curved_edge_outside_the_image_is_detected() {
    let [reference, _] = images();
    // Every node lies in the image, which ends at -0.5; the upper edge bulges out to -0.63 between two of them.
    let nodes = [
        [20.0, -0.45],
        [60.0, 1.0],
        [60.0, 40.0],
        [20.0, 40.0],
        [40.0, -0.45],
        [60.0, 20.0],
        [40.0, 40.0],
        [20.0, 20.0],
    ];
    let points = nodes.iter().map(|p| [p[0], p[1], 0.0]).collect();
    let mesh = Mesh::new(points, &[(CellType::Quad8, (0..8).collect())]).unwrap();
    let options = Options::default().quadrature(Quadrature::Mesh { rule: Rule::Edges, density: 100.0 });
    let result = prepare(&reference, &mesh, options);
    assert_eq!(refused(result), Error::MeshOutsideImage { cells: vec![0], num_cells: 1, width: 90, height: 80 });
}

#[test]
fn images_must_have_one_size() {
    let [reference, _] = images();
    let correlator = prepare(&reference, &inner_mesh(), Options::default()).unwrap();
    let other = Image::new(80, 90, reference.pixels().to_vec()).unwrap();
    let expected = Error::SizeMismatch { reference: [90, 80], deformed: [80, 90] };
    assert_eq!(correlator.correlate(other.view(), Start::Zero), Err(expected.clone()));
    assert_eq!(
        expected.to_string(),
        "the reference image has 90 x 80 pixels (columns x rows), the deformed one 80 x 90; both must come from the same \
         camera"
    );
}

#[test]
fn the_noise_must_be_zero_or_positive() {
    let [reference, _] = images();
    let correlator = prepare(&reference, &inner_mesh(), Options::default()).unwrap();
    for noise in [-0.5, f64::NAN, f64::INFINITY] {
        let error = correlator.covariance(noise, None, None, &()).unwrap_err();
        assert!(
            matches!(&error, Error::Option(OptionError::Invalid { option: "noise", value, .. }) if *value == noise.to_string()),
            "{error:?}"
        );
    }
}

#[test]
fn images_without_texture_are_refused() {
    let [reference, _] = images();
    let exact = Options::default().smoothing(0.0).interpolation(Interpolation::Bspline3);
    let error = refused(prepare(&flat(117.0), &inner_mesh(), exact));
    assert!(matches!(error, Error::Flat { which: "reference", std } if std < 1e-4), "{error:?}");
    assert_eq!(
        Error::Flat { which: "reference", std: 0.0 }.to_string(),
        "the reference image is flat where the mesh lies: its grey levels have a standard deviation of 0.00e0; nothing can \
         be measured without a texture"
    );
    let correlator = prepare(&reference, &inner_mesh(), Options::default()).unwrap();
    for start in [Start::Zero, Start::Pyramid] {
        let error = correlator.correlate(flat(117.0).view(), start).unwrap_err();
        assert!(matches!(error, Error::Flat { which: "deformed", std } if std < 1e-3), "{error:?}");
        assert!(error.to_string().starts_with("the deformed image is flat where the mesh lies: "));
    }
}

#[test]
fn nodes_with_too_few_quadrature_points_are_named() {
    let [reference, _] = images();
    // One point per cell: 25 equations for 72 unknowns.
    let mesh = quads([20.3, 20.3, 25.3, 25.3], 1.0);
    let quadrature = Quadrature::Mesh { rule: Rule::Edges, density: 1e-3 };
    let error = refused(prepare(&reference, &mesh, Options::default().quadrature(quadrature)));
    let Error::Solve(SolveError::Singular { nodes, points: 1, unknowns: 8 }) = &error else {
        unreachable!("{error:?}");
    };
    // At most half of the unknowns can be determined.
    assert!(nodes.len() >= 47 / 2 && nodes.iter().all(|&n| n < 36) && nodes.is_sorted(), "{nodes:?}");
    let text = error.to_string();
    assert!(
        text.starts_with(&format!("the images do not determine the displacement of nodes {}, ", nodes[0])),
        "{text}"
    );
    assert!(
        text.ends_with(
            ": the poorest cell there holds 1 quadrature points for 8 unknowns; use larger elements, a texture with more \
             contrast there, or a regularization length"
        ),
        "{text}"
    );
    // Regularization determines them.
    let options = Options::default().quadrature(quadrature).regularization_length(Some(20.0));
    assert!(prepare(&reference, &mesh, options).is_ok());
}

#[test]
fn nodes_without_texture_are_named_by_mesh_node_number() {
    let [reference, _] = images();
    let greys = reference.pixels().iter().enumerate().map(|(k, &grey)| if k % 90 > 50 { 100.0 } else { grey });
    let half = Image::new(90, 80, greys.collect()).unwrap();
    // Columns of nodes at 15, 25, ... 75: those from 65 on lie in the flat part. Three unused nodes come first.
    let mesh = quads([15.0, 15.0, 75.0, 65.0], 10.0);
    let points: Vec<[f64; 3]> = [[-1e9; 3]; 3].iter().chain(mesh.points()).copied().collect();
    let cells = mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&n| i64::from(n) + 3)).collect();
    let shifted = Mesh::new(points, &[(CellType::Quad, cells)]).unwrap();
    let flat_nodes: Vec<usize> = (0..shifted.num_nodes()).filter(|&node| shifted.points()[node][0] >= 65.0).collect();
    assert_eq!(flat_nodes.len(), 12);
    // The spline interpolant oscillates in the flat part near its edge.
    for interpolation in [Interpolation::Bilinear, Interpolation::Bspline3] {
        let options = Options::default().interpolation(interpolation);
        match refused(prepare(&half, &shifted, options)) {
            Error::Solve(SolveError::Singular { nodes, .. }) => assert_eq!(nodes, flat_nodes, "{interpolation}"),
            other => unreachable!("{other:?}"),
        }
    }
}

#[test]
fn a_regularization_does_not_determine_parts_without_texture() {
    let [reference, _] = images();
    let greys = reference.pixels().iter().enumerate().map(|(k, &grey)| if k % 90 > 50 { 100.0 } else { grey });
    let half = Image::new(90, 80, greys.collect()).unwrap();
    let options = Options::default().regularization_length(Some(60.0));
    // The displacement of the textured cells is continued across their edges, but not to cells apart from them.
    assert!(prepare(&half, &quads([15.0, 15.0, 75.0, 65.0], 10.0), options.clone()).is_ok());
    let [left, right] = [quads([15.0, 15.0, 45.0, 65.0], 10.0), quads([56.0, 15.0, 76.0, 65.0], 10.0)];
    let points: Vec<[f64; 3]> = left.points().iter().chain(right.points()).copied().collect();
    let of_right = right.cells().flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node) + 24));
    let cells = left.cells().flat_map(|cell| cell.nodes.iter().map(|&n| i64::from(n))).chain(of_right).collect();
    let error = refused(prepare(&half, &Mesh::new(points, &[(CellType::Quad, cells)]).unwrap(), options));
    assert_eq!(error, Error::Solve(SolveError::FlatPart { nodes: (24..42).collect() }));
    assert!(error.to_string().ends_with("leave the part out of the mesh"), "{error}");
}

#[test]
fn regularization_lengths_that_rounding_errors_forbid_are_refused() {
    let [reference, _] = images();
    let error = refused(prepare(&reference, &inner_mesh(), Options::default().regularization_length(Some(1e6))));
    assert!(matches!(&error, Error::Option(OptionError::Invalid { option: "regularization_length", .. })), "{error:?}");
    assert!(error.to_string().contains("at most 2000 times the mean edge of the cells"), "{error}");
}

#[test]
fn a_start_of_the_wrong_length_or_not_finite_is_refused() {
    let [reference, deformed] = images();
    let correlator = prepare(&reference, &inner_mesh(), Options::default()).unwrap();
    let start = |field: &[[f64; 2]]| correlator.correlate(deformed.view(), Start::Field(field)).unwrap_err();
    let words = "the initial displacement must have one finite value per component and node (9 nodes): ";
    let error = start(&[[0.0; 2]; 8]);
    let found = "8 entries were given".to_owned();
    assert_eq!(error, Error::Solve(SolveError::InvalidStart { expected: 9, found }));
    assert_eq!(error.to_string(), format!("{words}8 entries were given"));
    let mut field = [[0.0; 2]; 9];
    field[4][1] = f64::NAN;
    assert_eq!(start(&field).to_string(), format!("{words}that of node 4 is not finite"));
    field[4][1] = f64::INFINITY;
    assert_eq!(start(&field).to_string(), format!("{words}that of node 4 is not finite"));
}

#[test]
fn unused_nodes_are_nan_and_do_not_change_the_solution() {
    let [reference, deformed] = images();
    let mesh = mixed_mesh([20.0, 20.0], 2, 20.0);
    // An unused node far away before each node of the mesh.
    let points = mesh.points().iter().flat_map(|&point| [[1e6, -1e6, 3.0], point]).collect();
    let renumbered = |cell_type| {
        let nodes = mesh.cells().filter(|c| c.cell_type == cell_type).flat_map(|c| c.nodes);
        (cell_type, nodes.map(|&n| 2 * i64::from(n) + 1).collect())
    };
    let sparse = Mesh::new(points, &[renumbered(CellType::Quad), renumbered(CellType::Triangle)]).unwrap();
    let solve = |mesh: &Mesh, start: Start<'_>| {
        prepare(&reference, mesh, Options::default()).unwrap().correlate(deformed.view(), start).unwrap()
    };
    let compact = solve(&mesh, Start::Pyramid);
    let with_unused = solve(&sparse, Start::Pyramid);
    for field in [&with_unused.displacement, &with_unused.pixel_displacement] {
        assert!(field.iter().step_by(2).flatten().all(|c| c.is_nan()));
    }
    let used: Vec<_> = with_unused.displacement.iter().skip(1).step_by(2).copied().collect();
    assert_eq!(used, compact.displacement);
    assert_eq!(with_unused.history, compact.history);

    // The result, NaN included, is a valid start.
    let again = solve(&sparse, Start::Field(&with_unused.displacement));
    assert!(again.converged && again.iterations == 1);
}

/// A monitor that cancels after a number of calls and counts the reported iterations.
struct Impatient {
    questions: AtomicUsize,
    patience: usize,
    steps: AtomicUsize,
}

impl Impatient {
    fn new(patience: usize) -> Self {
        Self { questions: AtomicUsize::new(0), patience, steps: AtomicUsize::new(0) }
    }
}

impl Monitor for Impatient {
    fn progress(&self, _progress: &Progress) {
        self.steps.fetch_add(1, Ordering::Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.questions.fetch_add(1, Ordering::Relaxed) >= self.patience
    }
}

#[test]
fn a_monitor_cancels_every_stage() {
    let [reference, deformed] = images();
    let mesh = warped_mesh([12.0, 12.0, 78.0, 68.0], 8.0, CellType::Triangle, 1.0);
    let cells = mesh.num_cells();
    let prepare = |monitor: &dyn Monitor| {
        // Without smoothing no pass prepares its correction for the deformation.
        let options = Options::default().smoothing(0.0);
        Correlator::new_with(Arc::new(reference.clone()), &mesh, Arc::new(ImageFrame), options, None, None, monitor)
    };
    for patience in [0, cells / 2] {
        let monitor = Impatient::new(patience);
        assert_eq!(refused(prepare(&monitor)), Error::Cancelled);
        assert_eq!(monitor.steps.into_inner(), 0);
        // No more calls than cells: no later stage was started.
        assert!(monitor.questions.into_inner() <= cells);
    }
    assert_eq!(Error::Cancelled.to_string(), "the correlation was cancelled");

    let patient = Impatient::new(usize::MAX);
    let correlator = prepare(&patient).unwrap();
    assert_eq!((patient.steps.into_inner(), patient.questions.into_inner()), (1, cells));
    // Every cell once for the initial brightness correction.
    for (patience, steps) in [(0, 0), (cells, 0), (2 * cells - 1, 0), (2 * cells, 1), (3 * cells + 7, 2)] {
        let monitor = Impatient::new(patience);
        let result = correlator.correlate_with(deformed.view(), Start::Zero, &monitor);
        assert_eq!(result, Err(Error::Cancelled));
        assert_eq!(monitor.steps.into_inner(), steps, "after {patience} questions");
    }
    // During the assembly of the covariance and before the inversion.
    for patience in [0, cells - 1, cells] {
        let monitor = Impatient::new(patience);
        let result = correlator.covariance(1.0, None, None, &monitor);
        assert!(matches!(result, Err(Error::Cancelled)), "after {patience} questions");
    }
    // One that was cancelled is prepared again, one that was completed is not.
    for questions in [true, false] {
        let patient = Impatient::new(usize::MAX);
        assert!(correlator.covariance(1.0, None, None, &patient).is_ok());
        assert_eq!(patient.questions.into_inner() > 0, questions);
    }
    let monitor = Impatient::new(3);
    assert_eq!(correlator.correlate_with(deformed.view(), Start::Pyramid, &monitor), Err(Error::Cancelled));
    // A pyramid cancelled while it was built is built again.
    assert!(correlator.correlate(deformed.view(), Start::Pyramid).unwrap().converged);
}
