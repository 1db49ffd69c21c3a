//! The covariance prepared once for the reference image and the points used, and carried to every frame.

#![allow(clippy::unwrap_used)]

mod common;

use std::sync::Arc;

use common::{Motion, mixed_mesh, render};
use fedic::{
    CellType, Correlator, Covariance, Error, Image, ImageFrame, Information, Mesh, OptionError, Options, StrainMeasure,
    rectangle_mesh,
};
use fedic_synthetic::Speckle;

const SIZE: [usize; 2] = [200, 200];

fn images(motion: Motion) -> [Image; 2] {
    render(&ImageFrame, SIZE, Speckle::new(5.0, 0.5, 3).unwrap(), motion)
}

fn reference() -> Image {
    let [reference, _] = images(Motion::translation([0.0; 2]));
    reference
}

fn correlator(reference: &Image, mesh: &Mesh) -> Correlator {
    let options = Options::default().smoothing(0.8);
    Correlator::new(Arc::new(reference.clone()), mesh, Arc::new(ImageFrame), options).unwrap()
}

fn field(mesh: &Mesh, displacement: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<[f64; 2]> {
    mesh.points().iter().map(|&[x, y, _]| displacement([x, y])).collect()
}

/// Bits of the covariances of nodes, strains and points.
fn bits(found: &Covariance) -> Vec<u64> {
    let mut numbers = found.blocks().as_flattened().as_flattened().to_vec();
    numbers.extend(found.cell_strains(StrainMeasure::Hencky).as_flattened().as_flattened());
    numbers.extend(found.at_points(&[[61.0, 47.0]], &()).unwrap().as_flattened().as_flattened());
    numbers.into_iter().map(f64::to_bits).collect()
}

/// Largest relative difference of the standard deviations of the nodes.
fn largest_difference(found: &[[[f64; 2]; 2]], expected: &[[[f64; 2]; 2]]) -> f64 {
    let deviations = |blocks: &[[[f64; 2]; 2]]| -> Vec<f64> {
        blocks.iter().flat_map(|block| [block[0][0].sqrt(), block[1][1].sqrt()]).collect()
    };
    let pairs = deviations(found).into_iter().zip(deviations(expected));
    pairs
        .map(|(found, expected)| (found / expected - 1.0).abs())
        .fold(0.0, |m, d| if d > m || d.is_nan() { d } else { m })
}

/// The covariance at a displacement by the noise of each cell: `F C F^T` where `C` has the part of `B` of each cell multiplied by
/// `(1 + 1 / det F) / 2`. `gradient` is `F` at a point.
fn by_cells(correlator: &Correlator, mesh: &Mesh, gradient: impl Fn([f64; 2]) -> [[f64; 2]; 2]) -> Vec<[[f64; 2]; 2]> {
    let of_cell = |cell: usize| {
        let points = mesh.cell_points(cell);
        let centre = [0, 1].map(|d| points.iter().map(|p| p[d]).sum::<f64>() / points.len() as f64);
        let [[a, b], [c, d]] = gradient(centre);
        Information { hessian: 1.0, noise: 0.5 * (1.0 + 1.0 / (a * d - b * c)), weights: None }
    };
    let information: Vec<Information> = (0..mesh.num_cells()).map(of_cell).collect();
    let at_rest = correlator.covariance(2.0, None, Some(&information), &()).unwrap().blocks();
    let of_node = |(block, &[x, y, _]): (&[[f64; 2]; 2], &[f64; 3])| {
        let gradient = gradient([x, y]);
        let half = gradient.map(|[x, y]| [x * block[0][0] + y * block[1][0], x * block[0][1] + y * block[1][1]]);
        half.map(|[x, y]| gradient.map(|row| x * row[0] + y * row[1]))
    };
    at_rest.iter().zip(mesh.points()).map(of_node).collect()
}

#[test]
fn a_covariance_that_was_kept_is_that_of_a_fresh_correlator() {
    let (reference, mesh) = (reference(), mixed_mesh([20.3, 18.7], 8, 20.0));
    let moved = field(&mesh, |[x, y]| [0.1 * x - 0.03 * y, 0.02 * x * y / 100.0]);
    let partly = |left_out: usize| -> Vec<Information> {
        let of_cell = |cell: usize| {
            let used = f64::from(u8::from(cell != left_out));
            Information { hessian: used, noise: used, weights: None }
        };
        (0..mesh.num_cells()).map(of_cell).collect()
    };
    let used = correlator(&reference, &mesh);
    let (first, second) = (partly(5), partly(9));
    for information in [None, Some(first.as_slice()), Some(second.as_slice()), Some(first.as_slice()), None] {
        for (noise, displacement) in [(2.0, None), (2.0, None), (0.7, Some(moved.as_slice())), (2.0, None)] {
            let found =
                |correlator: &Correlator| bits(&correlator.covariance(noise, displacement, information, &()).unwrap());
            assert_eq!(found(&used), found(&correlator(&reference, &mesh)));
        }
    }
}

#[test]
fn noise_of_cells_that_grow_is_averaged() {
    let (reference, mesh) = (reference(), rectangle_mesh([20.0, 20.0, 180.0, 180.0], 10.0, CellType::Quad).unwrap());
    let correlator = correlator(&reference, &mesh);
    let (sin, cos) = 40.0_f64.to_radians().sin_cos();
    let turned = [[1.3 * cos, -1.3 * sin], [1.3 * sin, 1.3 * cos]];
    let displacement = field(&mesh, |[x, y]| turned.map(|[a, b]| a * x + b * y)).into_iter().zip(mesh.points());
    let displacement: Vec<_> = displacement.map(|(at, point)| [at[0] - point[0], at[1] - point[1]]).collect();
    let found = correlator.covariance(2.0, Some(&displacement), None, &()).unwrap().blocks();
    assert!(largest_difference(&found, &by_cells(&correlator, &mesh, |_| turned)) < 1e-7);

    // A bent beam, whose area changes by 10 % from one side to the other.
    let bent = |[x, y]: [f64; 2]| [0.1 * (x - 100.0) * (y - 100.0) / 160.0, -0.05 * (x - 100.0).powi(2) / 160.0];
    let gradient = |[x, y]: [f64; 2]| {
        let slope = |c: f64| 0.1 * (c - 100.0) / 160.0;
        [[1.0 + slope(y), slope(x)], [-slope(x), 1.0]]
    };
    // Along the border the gradient of a node is that of the cells inside.
    let inside = |[x, y]: [f64; 2]| gradient([x, y].map(|c| c.clamp(25.0, 175.0)));
    let found = correlator.covariance(2.0, Some(&field(&mesh, bent)), None, &()).unwrap().blocks();
    assert!(largest_difference(&found, &by_cells(&correlator, &mesh, inside)) < 2e-3);
}

#[test]
fn strains_of_two_steps_have_the_covariance_of_one() {
    // Two stretches that keep the area, the first with a turn.
    let (sin, cos) = 20.0_f64.to_radians().sin_cos();
    let first =
        Motion { gradient: [[1.1 * cos, -sin / 1.1], [1.1 * sin, cos / 1.1]], shift: [1.3, -2.6], centre: [100.0; 2] };
    let stretch = [[1.1, 0.21_f64.sqrt()], [0.21_f64.sqrt(), 1.1]];
    let mesh = rectangle_mesh([60.0, 60.0, 140.0, 140.0], 10.0, CellType::Quad).unwrap();
    let before = field(&mesh, |at| first.displacement(at));
    let points = mesh.points().iter().zip(&before).map(|(&[x, y, z], u)| [x + u[0], y + u[1], z]).collect();
    let cells = mesh.cells().flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node))).collect();
    let moved = Mesh::new(points, &[(CellType::Quad, cells)]).unwrap();
    let step = field(&moved, |at| {
        let from_centre = at.map(|c| c - 100.0);
        [0, 1].map(|i| stretch[i][0] * from_centre[0] + stretch[i][1] * from_centre[1] - from_centre[i])
    });
    let total: Vec<[f64; 2]> = before.iter().zip(&step).map(|(a, b)| [a[0] + b[0], a[1] + b[1]]).collect();

    let [reference, intermediate] = images(first);
    let direct = correlator(&reference, &mesh).covariance(2.0, Some(&total), None, &()).unwrap();
    let stepwise = correlator(&intermediate, &moved).covariance(2.0, Some(&step), None, &()).unwrap();
    let of_total = stepwise.of_total(&mesh, &total).unwrap();
    assert_eq!(of_total.blocks(), stepwise.blocks());
    let difference = largest_difference(&of_total.blocks(), &direct.blocks());
    assert!(difference < 0.05, "{difference}");

    let places = [[97.0, 88.0], [73.5, 120.0]];
    let deviations = |of: &Covariance| {
        let mut all: Vec<f64> = Vec::new();
        for measure in StrainMeasure::ALL {
            let cells = of.cell_strains(measure);
            all.extend(cells.iter().flat_map(|cell| (0..3).map(|s| cell[s][s].sqrt())));
            let gauge = of.mean_strain(&places, measure, &()).unwrap();
            all.extend((0..3).map(|s| gauge[s][s].sqrt()));
        }
        let points = of.at_points(&places, &()).unwrap();
        all.extend(points.iter().flat_map(|point| (0..2).map(|c| point[c][c].sqrt())));
        all
    };
    for (found, expected) in deviations(&of_total).into_iter().zip(deviations(&direct)) {
        assert!((found / expected - 1.0).abs() < 0.08, "{found} {expected}");
    }
    // The strains of the second step alone are others.
    let own = stepwise.cell_strains(StrainMeasure::GreenLagrange)[0][0][0];
    assert!((own / direct.cell_strains(StrainMeasure::GreenLagrange)[0][0][0] - 1.0).abs() > 0.2);
}

#[test]
fn a_total_displacement_is_that_of_the_same_cells() {
    let (reference, mesh) = (reference(), rectangle_mesh([20.0, 20.0, 180.0, 180.0], 20.0, CellType::Quad).unwrap());
    let found = correlator(&reference, &mesh).covariance(2.0, None, None, &()).unwrap();
    for other in [(40.0, CellType::Quad), (20.0, CellType::Triangle)] {
        let other = rectangle_mesh([20.0, 20.0, 180.0, 180.0], other.0, other.1).unwrap();
        let refused = found.of_total(&other, &vec![[0.0; 2]; other.num_nodes()]).unwrap_err();
        assert!(matches!(refused, Error::Option(OptionError::Invalid { option: "mesh", .. })), "{refused:?}");
    }
    assert!(matches!(found.of_total(&mesh, &[[0.0; 2]]), Err(Error::Solve(_))));
}
