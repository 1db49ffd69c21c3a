//! Strain measures, their axes, and strains at cells, points and nodes of plane meshes.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{Random, jittered_mesh};
use fedic_mesh::{
    CellType, Locator, Mesh, StrainAxes, StrainField, StrainMeasure, Subdivision, SurfaceStrain, interpolate_field,
    jacobian, map, rectangle_mesh, shape_values,
};
use proptest::prelude::*;

type Matrix = [[f64; 2]; 2];

const FINITE: [StrainMeasure; 2] = [StrainMeasure::GreenLagrange, StrainMeasure::Hencky];

fn any_cell() -> impl Strategy<Value = CellType> {
    proptest::sample::select(CellType::ALL.as_slice())
}

fn any_measure() -> impl Strategy<Value = StrainMeasure> {
    proptest::sample::select(StrainMeasure::ALL.as_slice())
}

fn apply(matrix: &Matrix, [x, y]: [f64; 2]) -> [f64; 2] {
    matrix.map(|row| row[0] * x + row[1] * y)
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    a.map(|row| [0, 1].map(|c| row[0] * b[0][c] + row[1] * b[1][c]))
}

fn turn(angle: f64) -> Matrix {
    let (sin, cos) = angle.sin_cos();
    [[cos, -sin], [sin, cos]]
}

/// Symmetric matrix with these principal values, the first along a direction of this angle.
fn symmetric(principal: [f64; 2], angle: f64) -> Matrix {
    let rotation = turn(angle);
    let [[a, b], [c, d]] = rotation;
    product(&product(&rotation, &[[principal[0], 0.0], [0.0, principal[1]]]), &[[a, c], [b, d]])
}

/// Displacement of the nodes under `x -> F x + t`.
fn affine(mesh: &Mesh, deformation: &Matrix, shift: [f64; 2]) -> Vec<[f64; 2]> {
    let moved = |p: &[f64; 3]| {
        let x = apply(deformation, [p[0], p[1]]);
        [x[0] + shift[0] - p[0], x[1] + shift[1] - p[1]]
    };
    mesh.points().iter().map(moved).collect()
}

/// Strains at the centres of the cells, at points inside them and at the nodes.
fn everywhere(
    random: &mut Random,
    mesh: &Mesh,
    displacement: &[[f64; 2]],
    measure: StrainMeasure,
) -> Vec<SurfaceStrain> {
    let mut found = StrainField::new(mesh, displacement, measure).at_cells();
    let points: Vec<[f64; 2]> = (0..mesh.num_cells())
        .map(|cell| {
            let cell_type = mesh.cell(cell).cell_type;
            let [x, y, _] = map(cell_type, &mesh.cell_points(cell), random.reference_point(cell_type));
            [x, y]
        })
        .collect();
    found.extend(StrainField::new(mesh, displacement, measure).at_points(&points).into_iter().map(Option::unwrap));
    found.extend(StrainField::new(mesh, displacement, measure).at_nodes());
    found
}

fn largest_difference(found: &[SurfaceStrain], expected: [f64; 3]) -> f64 {
    let differences = found.iter().flat_map(|s| s.components.into_iter().zip(expected).map(|(a, b)| (a - b).abs()));
    differences.fold(0.0, |worst: f64, d| if d.is_nan() { d } else { worst.max(d) })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    #[test]
    fn finite_strains_of_a_rigid_rotation_are_zero(cell in any_cell(), seed: u64, quarter in 0..4_u8, angle in -4.0..4.0_f64) {
        let mut random = Random::new(seed);
        let (mesh, _) = jittered_mesh(&mut random, [4, 3], &[cell], 5.0, 0.2);
        let exact = [[[1.0, 0.0], [0.0, 1.0]], [[0.0, -1.0], [1.0, 0.0]], [[-1.0, 0.0], [0.0, -1.0]], turn(angle)];
        let displacement = affine(&mesh, &exact[usize::from(quarter)], [3.0, -2.0]);
        for measure in FINITE {
            let found = everywhere(&mut random, &mesh, &displacement, measure);
            prop_assert!(largest_difference(&found, [0.0; 3]) < 1e-12, "{measure}");
        }
    }

    /// `F = R U` with given principal stretches of `U`.
    #[test]
    fn strains_of_a_uniform_deformation_are_those_of_its_stretches(
        cell in any_cell(), seed: u64, first in 0.4..2.5_f64, second in 0.4..2.5_f64, along in 0.0..3.2_f64, angle in -3.2..3.2_f64,
    ) {
        let mut random = Random::new(seed);
        let (mesh, _) = jittered_mesh(&mut random, [4, 3], &[cell], 5.0, 0.2);
        let deformation = product(&turn(angle), &symmetric([first, second], along));
        let displacement = affine(&mesh, &deformation, [3.0, -2.0]);
        let stretches = [first, second];
        let [green_lagrange, hencky] = [stretches.map(|s| 0.5 * (s * s - 1.0)), stretches.map(f64::ln)].map(|principal| {
            let [[xx, xy], [_, yy]] = symmetric(principal, along);
            [xx, yy, xy]
        });
        let small = [deformation[0][0] - 1.0, deformation[1][1] - 1.0, 0.5 * (deformation[0][1] + deformation[1][0])];
        for (measure, expected) in StrainMeasure::ALL.into_iter().zip([green_lagrange, hencky, small]) {
            let found = everywhere(&mut random, &mesh, &displacement, measure);
            prop_assert!(largest_difference(&found, expected) < 1e-11, "{measure}");
        }
    }

    #[test]
    fn finite_strains_do_not_change_with_a_rotation_after_the_deformation(cell in any_cell(), seed: u64, angle in -3.2..3.2_f64) {
        let mut random = Random::new(seed);
        let (mesh, _) = jittered_mesh(&mut random, [4, 3], &[cell], 5.0, 0.2);
        let displacement: Vec<[f64; 2]> =
            (0..mesh.num_nodes()).map(|_| [random.between(-0.1, 0.1), random.between(-0.1, 0.1)]).collect();
        let rotation = turn(angle);
        let rotated: Vec<[f64; 2]> = mesh.points().iter().zip(&displacement).map(|(p, u)| {
            let x = apply(&rotation, [p[0] + u[0], p[1] + u[1]]);
            [x[0] - p[0] + 7.0, x[1] - p[1]]
        }).collect();
        for measure in FINITE {
            for (before, after) in [
                (StrainField::new(&mesh, &displacement, measure).at_cells(), StrainField::new(&mesh, &rotated, measure).at_cells()),
                (StrainField::new(&mesh, &displacement, measure).at_nodes(), StrainField::new(&mesh, &rotated, measure).at_nodes()),
            ] {
                for (before, after) in before.iter().zip(&after) {
                    // Badly shaped cells have large strains.
                    let size = before.components.iter().fold(1.0, |size: f64, c| size.max(c.abs()));
                    prop_assert!(largest_difference(&[*after], before.components) < 1e-10 * size, "{measure}");
                }
            }
        }
    }

    /// The components along turned axes are those in a mesh that is turned the other way.
    #[test]
    fn turned_axes_equal_a_turned_mesh(cell in any_cell(), measure in any_measure(), seed: u64, angle in -3.2..3.2_f64) {
        let mut random = Random::new(seed);
        let (mesh, _) = jittered_mesh(&mut random, [3, 3], &[cell], 5.0, 0.2);
        let back = turn(-angle);
        let [[a, b], [c, d]] = back;
        let turned_mesh = mesh.rotated([[a, b, 0.0], [c, d, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]).unwrap();
        let displacement: Vec<[f64; 2]> =
            (0..mesh.num_nodes()).map(|_| [random.between(-0.3, 0.3), random.between(-0.3, 0.3)]).collect();
        let turned: Vec<[f64; 2]> = displacement.iter().map(|&u| apply(&back, u)).collect();
        for (strains, expected) in [
            (StrainField::new(&mesh, &displacement, measure).at_cells(), StrainField::new(&turned_mesh, &turned, measure).at_cells()),
            (StrainField::new(&mesh, &displacement, measure).at_nodes(), StrainField::new(&turned_mesh, &turned, measure).at_nodes()),
        ] {
            for (strain, expected) in strains.into_iter().zip(expected) {
                let found = strain.along(StrainAxes::Turned(angle));
                prop_assert!(largest_difference(&[found], expected.components) < 1e-11);
                let (sin, cos) = angle.sin_cos();
                prop_assert!((found.axes[0][0] - cos).abs() < 1e-15 && (found.axes[0][1] - sin).abs() < 1e-15);
                prop_assert!((found.axes[1][0] + sin).abs() < 1e-15 && (found.axes[1][1] - cos).abs() < 1e-15);
            }
        }
    }

    /// The strain of a quadratic displacement is linear inside affine quadratic cells, so its projection is exact.
    #[test]
    fn nodal_strains_of_a_quadratic_displacement_are_exact_up_to_the_boundary(seed: u64, triangles: bool) {
        let mut random = Random::new(seed);
        let cells: &[CellType] = if triangles { &[CellType::Triangle6] } else { &[CellType::Quad8, CellType::Quad9] };
        let [[a, b], [c, d]] = random.affine(2.0);
        let coefficients: [[f64; 5]; 2] = std::array::from_fn(|_| std::array::from_fn(|_| random.between(-0.01, 0.01)));
        for &cell in cells {
            let flat = rectangle_mesh([-1.0, -1.0, 2.0, 1.0], 1.0, cell).unwrap();
            let mut points = Vec::new();
            for p in flat.points() {
                points.push([a * p[0] + b * p[1], c * p[0] + d * p[1], 0.0]);
            }
            let blocks: Vec<_> =
                flat.cells().map(|each| (cell, each.nodes.iter().map(|&n| i64::from(n)).collect())).collect();
            let mesh = Mesh::new(points, &blocks).unwrap();
            let field = |x: f64, y: f64| coefficients.map(|k| k[0] * x + k[1] * y + k[2] * x * x + k[3] * x * y + k[4] * y * y);
            let displacement: Vec<[f64; 2]> = mesh.points().iter().map(|p| field(p[0], p[1])).collect();
            for strain in StrainField::new(&mesh, &displacement, StrainMeasure::Small).at_nodes() {
                let [x, y, _] = strain.position;
                let [gx, gy] = coefficients.map(|k| [k[0] + 2.0 * k[2] * x + k[3] * y, k[1] + k[3] * x + 2.0 * k[4] * y]);
                let expected = [gx[0], gy[1], 0.5 * (gx[1] + gy[0])];
                prop_assert!(largest_difference(&[strain], expected) < 1e-13, "{cell}");
            }
        }
    }

    /// The difference between the strain and its projection is orthogonal to every shape function.
    #[test]
    fn nodal_strains_satisfy_the_projection_equations(cell in any_cell(), seed: u64) {
        let mut random = Random::new(seed);
        let (mesh, _) = jittered_mesh(&mut random, [3, 2], &[cell], 1.0, 0.2);
        let displacement: Vec<[f64; 2]> =
            (0..mesh.num_nodes()).map(|_| [random.between(-0.02, 0.02), random.between(-0.02, 0.02)]).collect();
        let nodal: Vec<f64> = StrainField::new(&mesh, &displacement, StrainMeasure::GreenLagrange).at_nodes()
            .iter().flat_map(|strain| strain.components).collect();
        let mut sums = vec![[0.0; 3]; mesh.num_nodes()];
        let subdivision = Subdivision::uniform(cell, 20);
        for index in 0..mesh.num_cells() {
            let nodes = common::cell_nodes(&mesh, index);
            let at = subdivision.all_points();
            let places: Vec<[f64; 2]> = at.iter().map(|&at| map(cell, &nodes, at)).collect();
            let strains = StrainField::new(&mesh, &displacement, StrainMeasure::GreenLagrange).at_points(&places);
            let projected = interpolate_field(&Locator::new(&mesh), &nodal, 3, &places);
            for ((&at, strain), projected) in at.iter().zip(strains).zip(projected.chunks_exact(3)) {
                let weight = common::determinant(jacobian(cell, &nodes, at)) * subdivision.subcell_area();
                for (&node, n) in mesh.cell(index).nodes.iter().zip(shape_values(cell, at)) {
                    for k in 0..3 {
                        sums[node as usize][k] += weight * n * (projected[k] - strain.unwrap().components[k]);
                    }
                }
            }
        }
        // The integrals are about 0.02; the midpoint rule leaves an error of 1 % at most.
        prop_assert!(sums.iter().flatten().all(|sum| sum.abs() < 2e-4), "{cell}: {sums:?}");
    }

    #[test]
    fn cylindrical_axes_follow_the_position(cell in any_cell(), seed: u64, radial in -0.2..0.4_f64, swirl in -0.2..0.2_f64) {
        let mut random = Random::new(seed);
        let (mesh, _) = jittered_mesh(&mut random, [3, 3], &[cell], 3.0, 0.2);
        let displacement: Vec<[f64; 2]> =
            (0..mesh.num_nodes()).map(|_| [random.between(-0.1, 0.1), random.between(-0.1, 0.1)]).collect();
        let centre = [radial * 20.0, swirl * 20.0];
        for strain in everywhere(&mut random, &mesh, &displacement, StrainMeasure::GreenLagrange) {
            let [x, y, _] = strain.position;
            let [dx, dy] = [x - centre[0], y - centre[1]];
            let expected = strain.along(StrainAxes::Turned(dy.atan2(dx)));
            let found = strain.along(StrainAxes::Cylindrical { centre });
            prop_assert!(largest_difference(&[found], expected.components) < 1e-12);
            let r = dx.hypot(dy);
            prop_assert!((found.axes[0][0] - dx / r).abs() < 1e-12 && (found.axes[0][1] - dy / r).abs() < 1e-12);
        }
    }
}

#[test]
fn a_node_not_measured_makes_its_cells_nan_and_no_others() {
    for cell in CellType::ALL {
        let mesh = rectangle_mesh([0.0, 0.0, 5.0, 4.0], 1.0, cell).unwrap();
        let mut displacement: Vec<[f64; 2]> = mesh.points().iter().map(|p| [0.02 * p[0], -0.01 * p[1]]).collect();
        let missing = mesh.points().iter().position(|p| p[0] == 2.0 && p[1] == 2.0).unwrap();
        displacement[missing] = [f64::NAN; 2];
        let expected = [0.0202, -0.00995, 0.0];
        let mut valid = vec![false; mesh.num_nodes()];
        for (index, strain) in
            StrainField::new(&mesh, &displacement, StrainMeasure::GreenLagrange).at_cells().into_iter().enumerate()
        {
            let nodes = mesh.cell(index).nodes;
            if nodes.contains(&(missing as u32)) {
                assert!(strain.components.iter().all(|c| c.is_nan()), "{cell}");
            } else {
                assert!(largest_difference(&[strain], expected) < 1e-14, "{cell}");
                nodes.iter().for_each(|&node| valid[node as usize] = true);
            }
        }
        let nodal = StrainField::new(&mesh, &displacement, StrainMeasure::GreenLagrange).at_nodes();
        assert!(valid.iter().any(|valid| !valid));
        for (strain, valid) in nodal.into_iter().zip(valid) {
            if valid {
                assert!(largest_difference(&[strain], expected) < 1e-14, "{cell}: {strain:?}");
            } else {
                assert!(strain.components.iter().all(|c| c.is_nan()), "{cell}");
            }
        }
        let at = StrainField::new(&mesh, &displacement, StrainMeasure::GreenLagrange).at_points(&[
            [2.1, 2.1],
            [4.4, 3.3],
            [6.0, 1.0],
        ]);
        assert!(at[0].unwrap().components[0].is_nan(), "{cell}");
        assert!(largest_difference(&[at[1].unwrap()], expected) < 1e-14, "{cell}");
        assert_eq!(at[2], None, "{cell}");
    }
}

#[test]
fn cells_marked_invalid_take_no_part_in_nodal_strains() {
    for cell in CellType::ALL {
        let mesh = rectangle_mesh([0.0, 0.0, 4.0, 3.0], 1.0, cell).unwrap();
        // A jump between the columns of cells left and right of x = 1, across one column.
        let displacement: Vec<[f64; 2]> = mesh
            .points()
            .iter()
            .map(|p| if p[0] > 1.5 { [0.01 * p[0] + 0.5, 0.0] } else { [0.01 * p[0], 0.0] })
            .collect();
        let valid: Vec<bool> = (0..mesh.num_cells())
            .map(|index| {
                mesh.cell_points(index).iter().all(|p| p[0] <= 1.0)
                    || mesh.cell_points(index).iter().all(|p| p[0] >= 2.0)
            })
            .collect();
        for strain in StrainField::new(&mesh, &displacement, StrainMeasure::Small).with_valid_cells(&valid).at_nodes() {
            let [x, ..] = strain.position;
            if x > 1.0 && x < 2.0 {
                assert!(strain.components[0].is_nan(), "{cell}");
            } else {
                assert!(largest_difference(&[strain], [0.01, 0.0, 0.0]) < 1e-13, "{cell}: {strain:?}");
            }
        }
    }
}

#[test]
fn a_quad_with_a_repeated_node_projects_like_a_triangle() {
    let points = vec![[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0], [1.0, 2.0, 0.0]];
    let blocks = [(CellType::Quad, vec![0, 1, 2, 3, 3, 2, 4, 4])];
    let mesh = Mesh::new(points, &blocks).unwrap();
    let displacement = affine(&mesh, &[[1.1, 0.05], [-0.02, 0.9]], [0.0; 2]);
    let found = StrainField::new(&mesh, &displacement, StrainMeasure::Small).at_nodes();
    assert!(largest_difference(&found, [0.1, -0.1, 0.015]) < 1e-13, "{found:?}");
}

#[test]
fn nodes_of_no_cell_are_nan() {
    let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [9.0, 9.0, 0.0]];
    let mesh = Mesh::new(points, &[(CellType::Triangle, vec![0, 1, 2])]).unwrap();
    let strains = StrainField::new(&mesh, &[[0.0; 2]; 4], StrainMeasure::Hencky).at_nodes();
    assert!(strains[..3].iter().all(|strain| strain.components == [0.0; 3]));
    assert!(strains[3].components.iter().all(|c| c.is_nan()));
}

#[test]
fn finite_strains_of_a_cell_turned_inside_out_are_nan() {
    let mesh = rectangle_mesh([0.0, 0.0, 2.0, 1.0], 1.0, CellType::Quad).unwrap();
    // The right cell is mirrored about its left edge.
    let displacement: Vec<[f64; 2]> = mesh.points().iter().map(|p| [-2.0 * (p[0] - 1.0).max(0.0), 0.0]).collect();
    for measure in StrainMeasure::ALL {
        let strains = StrainField::new(&mesh, &displacement, measure).at_cells();
        let (left, right) = (strains[0], strains[1]);
        assert!(left.components.iter().all(|c| c.abs() < 1e-15), "{measure}");
        assert_eq!(right.components[0].is_nan(), measure != StrainMeasure::Small, "{measure}");
    }
    // In space a mesh may be turned over.
    let turned: Vec<[f64; 3]> = mesh.points().iter().map(|p| [-2.0 * p[0], 0.0, 0.0]).collect();
    for measure in FINITE {
        let strains = StrainField::new(&mesh, &turned, measure).at_cells();
        assert!(largest_difference(&strains, [0.0; 3]) < 1e-15, "{measure}");
    }
}

#[test]
fn derivatives_of_strains_are_their_differences() {
    let gradient = [[0.1, -0.4], [0.3, -0.05], [0.2, 0.1]];
    let step = 1e-5;
    for measure in StrainMeasure::ALL {
        let derivative = measure.derivative(&gradient);
        for (a, b) in (0..3).flat_map(|a| (0..2).map(move |b| (a, b))) {
            let strain = |step: f64| {
                let mut moved = gradient;
                moved[a][b] += step;
                measure.of_gradient(&moved)
            };
            let (up, down) = (strain(step), strain(-step));
            for s in 0..3 {
                let expected = (up[s] - down[s]) / (2.0 * step);
                assert!((derivative[s][a][b] - expected).abs() < 1e-8, "{measure} {s} {a} {b}");
            }
        }
    }
}

#[test]
fn strain_measures_are_parsed_from_their_names() {
    for measure in StrainMeasure::ALL {
        assert_eq!(measure.name().parse(), Ok(measure));
    }
    let error = "engineering".parse::<StrainMeasure>().unwrap_err().to_string();
    assert_eq!(
        error,
        "unknown strain measure \"engineering\"; choose one of \"green-lagrange\", \"hencky\", \"small\""
    );
}

/// A thick ring under internal pressure: `u_r = a r + b / r`, known in cylindrical components.
#[test]
fn cylindrical_strains_of_a_ring_converge_at_the_order_of_the_cell() {
    let (a, b) = (0.01, 0.05);
    for cell in CellType::ALL {
        let error = |size: f64| {
            let flat = rectangle_mesh([1.0, 0.2, 2.0, 1.2], size, cell).unwrap();
            let place = |p: &[f64; 3]| [3.0 + p[0] * p[1].cos(), -2.0 + p[0] * p[1].sin(), 0.0];
            let blocks: Vec<_> =
                flat.cells().map(|each| (cell, each.nodes.iter().map(|&n| i64::from(n)).collect())).collect();
            let mesh = Mesh::new(flat.points().iter().map(place).collect(), &blocks).unwrap();
            let displacement: Vec<[f64; 2]> = flat
                .points()
                .iter()
                .map(|p| {
                    let u = a * p[0] + b / p[0];
                    [u * p[1].cos(), u * p[1].sin()]
                })
                .collect();
            let errors = |strains: Vec<SurfaceStrain>| {
                let squares = strains.iter().map(|strain| {
                    let strain = strain.along(StrainAxes::Cylindrical { centre: [3.0, -2.0] });
                    let r = (strain.position[0] - 3.0).hypot(strain.position[1] + 2.0);
                    let exact = [a - b / (r * r), a + b / (r * r), 0.0];
                    largest_difference(&[strain], exact).powi(2)
                });
                (squares.sum::<f64>() / strains.len() as f64).sqrt()
            };
            [
                errors(StrainField::new(&mesh, &displacement, StrainMeasure::Small).at_cells()),
                errors(StrainField::new(&mesh, &displacement, StrainMeasure::Small).at_nodes()),
            ]
        };
        let [coarse, fine] = [0.1, 0.05].map(error);
        for (at, coarse, fine) in [("cells", coarse[0], fine[0]), ("nodes", coarse[1], fine[1])] {
            let order = (coarse / fine).log2();
            assert!(order > cell.edge_intervals() as f64 - 0.1, "{cell}, {at}: {order}");
        }
    }
}
