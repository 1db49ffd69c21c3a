//! Fields on surfaces in space: areas, gradients and strains on slanted, vertical and curved meshes.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::{Random, jittered_mesh};
use fedic_mesh::{
    CellType, Mesh, StrainField, StrainMeasure, cell_areas, jacobian, map, rectangle_mesh, shape_gradients,
    surface_gradients,
};
use proptest::prelude::*;

type Vector = [f64; 3];
type Matrix = [Vector; 3];

fn any_cell() -> impl Strategy<Value = CellType> {
    proptest::sample::select(CellType::ALL.as_slice())
}

fn dot(a: Vector, b: Vector) -> f64 {
    (0..3).map(|d| a[d] * b[d]).sum()
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn apply(matrix: &Matrix, v: Vector) -> Vector {
    matrix.map(|row| dot(row, v))
}

/// A random rotation, from a random quaternion.
fn rotation(random: &mut Random) -> Matrix {
    loop {
        let q: [f64; 4] = std::array::from_fn(|_| random.between(-1.0, 1.0));
        let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if length > 0.1 {
            let [w, x, y, z] = q.map(|c| c / length);
            return [
                [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
                [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
                [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
            ];
        }
    }
}

fn cell_strains<const D: usize>(mesh: &Mesh, displacement: &[[f64; D]]) -> Vec<Vector> {
    let strains = StrainField::new(mesh, displacement, StrainMeasure::Small).at_cells();
    strains.into_iter().map(|strain| strain.components).collect()
}

fn with_points(mesh: &Mesh, points: Vec<Vector>) -> Mesh {
    let blocks: Vec<_> =
        mesh.cells().map(|cell| (cell.cell_type, cell.nodes.iter().map(|&n| i64::from(n)).collect())).collect();
    Mesh::new(points, &blocks).unwrap()
}

/// The documented axes of a surface with this normal.
fn axes(normal: Vector) -> [Vector; 2] {
    let length = dot(normal, normal).sqrt();
    let n = normal.map(|c| c / length);
    let base = if n[0].abs() > 1.0 - 1e-12 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
    let projected: Vector = std::array::from_fn(|d| base[d] - dot(base, n) * n[d]);
    let size = dot(projected, projected).sqrt();
    let first = projected.map(|c| c / size);
    [first, cross(n, first)]
}

/// Strain along two axes of a displacement with this gradient (row: component, column: direction).
fn strain_along([first, second]: [Vector; 2], gradient: &Matrix) -> Vector {
    let along = |a: Vector, b: Vector| 0.5 * (dot(a, apply(gradient, b)) + dot(b, apply(gradient, a)));
    [along(first, first), along(second, second), along(first, second)]
}

proptest! {
    /// The surface formulas reduce to those of the plane, bit by bit.
    #[test]
    fn a_mesh_parallel_to_the_plane_gets_the_bits_of_the_plane_formulas(
        cell in any_cell(), seed: u64, z in -1e3..1e3_f64, size in 1e-3..1e3,
    ) {
        let mut random = Random::new(seed);
        let (flat, _) = jittered_mesh(&mut random, [3, 2], &[cell], size, 0.2);
        let mesh = with_points(&flat, flat.points().iter().map(|p| [p[0], p[1], z]).collect());
        let displacement: Vec<[f64; 2]> =
            (0..mesh.num_nodes()).map(|_| [random.between(-1.0, 1.0), random.between(-1.0, 1.0)]).collect();
        let strains = cell_strains(&mesh, &displacement);
        let areas = cell_areas(&mesh);
        for index in 0..mesh.num_cells() {
            let nodes = mesh.cell_points(index);
            let centre = cell.reference_centre();
            let [[xx, xy], [yx, yy], _] = jacobian(cell, &nodes, centre);
            let det = xx * yy - xy * yx;
            let mut h = [[0.0; 2]; 2];
            for (&node, [xi, eta]) in mesh.cell(index).nodes.iter().zip(shape_gradients(cell, centre)) {
                let slope = [(yy * xi - yx * eta) / det, (xx * eta - xy * xi) / det];
                for (row, u) in h.iter_mut().zip(displacement[node as usize]) {
                    row[0] += u * slope[0];
                    row[1] += u * slope[1];
                }
            }
            let expected = [h[0][0], h[1][1], 0.5 * (h[0][1] + h[1][0])];
            prop_assert_eq!(strains[index].map(f64::to_bits), expected.map(f64::to_bits));
            let subdivision = fedic_mesh::Subdivision::uniform(cell, 8);
            let determinants = subdivision.all_points().into_iter().map(|at| {
                let [[xx, xy], [yx, yy], _] = jacobian(cell, &nodes, at);
                xx * yy - xy * yx
            });
            let area = subdivision.subcell_area() * determinants.sum::<f64>();
            prop_assert_eq!(areas[index].to_bits(), area.to_bits());
        }
    }

    #[test]
    fn areas_do_not_change_with_a_rigid_motion(cell in any_cell(), seed: u64) {
        let mut random = Random::new(seed);
        let (mesh, _) = jittered_mesh(&mut random, [3, 2], &[cell], 5.0, 0.2);
        let moved = mesh.rotated(rotation(&mut random), [1.0, 2.0, 3.0]).unwrap().translated([7.0, -8.0, 9.0]).unwrap();
        for (area, expected) in cell_areas(&moved).into_iter().zip(cell_areas(&mesh)) {
            prop_assert!((area - expected).abs() < 1e-12 * expected, "{area} {expected}");
        }
    }

    /// The strain as a tensor in space rotates with the mesh and its displacement.
    #[test]
    fn strains_follow_a_rigid_motion_of_the_mesh_in_space(cell in any_cell(), seed: u64) {
        let mut random = Random::new(seed);
        let (flat, _) = jittered_mesh(&mut random, [3, 2], &[cell], 5.0, 0.2);
        let bend = |p: &Vector| [p[0], p[1], 0.02 * p[0] * p[0] - 0.01 * p[0] * p[1]];
        let mesh = with_points(&flat, flat.points().iter().map(bend).collect());
        let displacement: Vec<Vector> =
            (0..mesh.num_nodes()).map(|_| std::array::from_fn(|_| random.between(-1.0, 1.0))).collect();
        let turn = rotation(&mut random);
        let moved = mesh.rotated(turn, [1.0, 2.0, 3.0]).unwrap().translated([7.0, -8.0, 9.0]).unwrap();
        let turned: Vec<Vector> = displacement.iter().map(|&u| apply(&turn, u)).collect();
        let tensors = |mesh: &Mesh, displacement: &[Vector], turn: Option<&Matrix>| -> Vec<Matrix> {
            let strains = cell_strains(mesh, displacement);
            let tensor = |index: usize| {
                let at = cell.reference_centre();
                let [first, second, _] = surface_gradients(cell, &mesh.cell_points(index), at).axes;
                let [first, second] = [first, second].map(|axis| turn.map_or(axis, |turn| apply(turn, axis)));
                let [xx, yy, xy] = strains[index];
                std::array::from_fn(|a| std::array::from_fn(|b| {
                    xx * first[a] * first[b] + yy * second[a] * second[b]
                        + xy * (first[a] * second[b] + second[a] * first[b])
                }))
            };
            (0..mesh.num_cells()).map(tensor).collect()
        };
        let (expected, found) = (tensors(&mesh, &displacement, Some(&turn)), tensors(&moved, &turned, None));
        for (found, expected) in found.iter().flatten().flatten().zip(expected.iter().flatten().flatten()) {
            prop_assert!((found - expected).abs() < 1e-11, "{found} {expected}");
        }
    }

    #[test]
    fn an_infinitesimal_rotation_of_a_curved_surface_strains_nothing(cell in any_cell(), seed: u64) {
        let mut random = Random::new(seed);
        let (flat, _) = jittered_mesh(&mut random, [3, 2], &[cell], 5.0, 0.2);
        let mesh = with_points(&flat, flat.points().iter().map(|p| [p[0], p[1], 0.05 * p[0] * p[1]]).collect());
        let spin: Vector = std::array::from_fn(|_| random.between(-1.0, 1.0));
        let displacement: Vec<Vector> = mesh.points().iter().map(|&x| cross(spin, x)).collect();
        for strain in cell_strains(&mesh, &displacement) {
            prop_assert!(strain.iter().all(|c| c.abs() < 1e-12), "{strain:?}");
        }
    }

    /// Green-Lagrange and Hencky strains of a finite rotation in space, which moves points out of the tangent plane.
    #[test]
    fn a_rotation_of_a_curved_surface_in_space_has_no_finite_strain(cell in any_cell(), seed: u64) {
        let mut random = Random::new(seed);
        let (flat, _) = jittered_mesh(&mut random, [3, 2], &[cell], 5.0, 0.2);
        let mesh = with_points(&flat, flat.points().iter().map(|p| [p[0], p[1], 0.05 * p[0] * p[1]]).collect());
        let turn = rotation(&mut random);
        let displacement: Vec<Vector> = mesh.points().iter().map(|&x| {
            let turned = apply(&turn, x);
            std::array::from_fn(|d| turned[d] - x[d] + 3.0)
        }).collect();
        for measure in [StrainMeasure::GreenLagrange, StrainMeasure::Hencky] {
            let field = StrainField::new(&mesh, &displacement, measure);
            for strain in field.at_cells().into_iter().chain(field.at_nodes()) {
                prop_assert!(strain.components.iter().all(|c| c.abs() < 1e-11), "{measure}: {strain:?}");
            }
        }
    }

    /// Patch test: polynomials of the order of the cell on cells with straight edges have exact gradients everywhere.
    #[test]
    fn gradients_of_polynomials_are_exact_on_slanted_planes(cell in any_cell(), seed: u64) {
        let mut random = Random::new(seed);
        // Affine cells: mapped ones reproduce linear fields only.
        let flat = rectangle_mesh([-1.0, -2.0, 3.0, 2.0], 2.0, cell).unwrap();
        let (turn, quadratic) = (rotation(&mut random), cell.edge_intervals() > 1);
        let mesh = flat.rotated(turn, [0.0; 3]).unwrap();
        let linear: Matrix = std::array::from_fn(|_| std::array::from_fn(|_| random.between(-1.0, 1.0)));
        let square: Matrix = std::array::from_fn(|_| std::array::from_fn(|_| f64::from(quadratic) * random.between(-1.0, 1.0)));
        let field = |x: Vector| -> Vector {
            let (a, b) = (apply(&linear, x), apply(&square, [x[0] * x[0], x[1] * x[2], x[2] * x[2]]));
            std::array::from_fn(|d| a[d] + b[d])
        };
        let gradient = |x: Vector| -> Matrix {
            std::array::from_fn(|d| {
                let [p, q, r] = square[d];
                let [a, b, c] = linear[d];
                [a + 2.0 * p * x[0], b + q * x[2], c + q * x[1] + 2.0 * r * x[2]]
            })
        };
        let nodal: Vec<Vector> = mesh.points().iter().map(|&x| field(x)).collect();
        for index in 0..mesh.num_cells() {
            let (nodes, at) = (mesh.cell_points(index), random.reference_point(cell));
            let surface = surface_gradients(cell, &nodes, at);
            let found = surface.of_vectors(mesh.cell(index).nodes.iter().map(|&n| nodal[n as usize]));
            let exact = gradient(map(cell, &nodes, at));
            for (a, row) in found.into_iter().enumerate() {
                for (b, value) in row.into_iter().enumerate() {
                    let expected = dot(surface.axes[a], apply(&exact, surface.axes[b]));
                    prop_assert!((value - expected).abs() < 1e-12, "{value} {expected}");
                }
            }
        }
    }
}

#[test]
fn axes_are_those_documented() {
    let at = [0.0, 0.0];
    let square: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let axes_of = |a: Vector, b: Vector| {
        let nodes = square.map(|[s, t]| std::array::from_fn(|d| s * a[d] + t * b[d]));
        surface_gradients(CellType::Quad, &nodes, at).axes
    };
    let (x, y, z) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]);
    let minus = |v: Vector| v.map(|c| 0.0 - c);
    assert_eq!(axes_of(x, y), [x, y, z]);
    assert_eq!(axes_of(y, minus(x)), [x, y, z]);
    assert_eq!(axes_of(x, z), [x, z, minus(y)]);
    // Perpendicular to x: the first axis comes from y.
    assert_eq!(axes_of(y, z), [y, z, x]);
    assert_eq!(axes_of(z, y), [y, minus(z), minus(x)]);
    // Slanted about y by 45 degrees.
    let h = 0.5_f64.sqrt();
    for (found, expected) in axes_of([1.0, 0.0, 1.0], y).into_iter().zip([[h, 0.0, h], y, [-h, 0.0, h]]) {
        assert!((0..3).all(|d| (found[d] - expected[d]).abs() < 1e-15), "{found:?}");
    }
}

#[test]
fn a_uniform_strain_of_a_slanted_or_vertical_plane_is_exact() {
    let gradient: Matrix = [[0.01, -0.02, 0.005], [0.03, 0.02, -0.01], [0.004, 0.015, -0.03]];
    for (a, b) in [
        ([1.0, 0.0, 0.5], [0.0, 1.0, -0.3]),
        ([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]),
        ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0]),
        ([0.6, 0.8, 0.0], [0.0, 0.1, 1.0]),
    ] {
        for cell in CellType::ALL {
            let flat = rectangle_mesh([-1.0, -2.0, 3.0, 2.0], 1.0, cell).unwrap();
            let place = |p: &Vector| -> Vector { std::array::from_fn(|d| p[0] * a[d] + p[1] * b[d]) };
            let mesh = with_points(&flat, flat.points().iter().map(place).collect());
            let displacement: Vec<Vector> = mesh.points().iter().map(|&x| apply(&gradient, x)).collect();
            // The orientation does not matter: both axes, or none, change sign, or the second does with the shear.
            let normal = surface_gradients(cell, &mesh.cell_points(0), cell.reference_centre()).axes[2];
            let expected = strain_along(axes(normal), &gradient);
            for strain in cell_strains(&mesh, &displacement) {
                for (found, expected) in strain.into_iter().zip(expected) {
                    assert!((found - expected).abs() < 1e-14, "{cell}: {found} {expected}");
                }
            }
            let area: f64 = cell_areas(&mesh).iter().sum();
            let normal = cross(a, b);
            assert!((area - 16.0 * dot(normal, normal).sqrt()).abs() < 1e-12, "{cell}: {area}");
        }
    }
}

/// A sheet of arc length 3 and height 2 on a cylinder of radius 2 whose axis is `z`, so that its cells are vertical, or `y`.
fn cylinder(cell: CellType, size: f64, vertical: bool) -> (Mesh, Vec<[f64; 2]>) {
    let flat = rectangle_mesh([0.2, 0.0, 3.2, 2.0], size, cell).unwrap();
    let place = |p: &Vector| on_cylinder([p[0], p[1]], vertical);
    let centres = (0..flat.num_cells()).map(|index| {
        let [s, t, _] = map(cell, &flat.cell_points(index), cell.reference_centre());
        [s, t]
    });
    (with_points(&flat, flat.points().iter().map(place).collect()), centres.collect())
}

const RADIUS: f64 = 2.0;

fn on_cylinder([s, t]: [f64; 2], vertical: bool) -> Vector {
    let (sin, cos) = (s / RADIUS).sin_cos();
    if vertical { [RADIUS * cos, RADIUS * sin, t] } else { [RADIUS * sin, t, RADIUS * cos] }
}

fn cylinder_normal([s, _]: [f64; 2], vertical: bool) -> Vector {
    let (sin, cos) = (s / RADIUS).sin_cos();
    if vertical { [cos, sin, 0.0] } else { [sin, 0.0, cos] }
}

/// Smooth displacement and its gradient.
fn wave([x, y, z]: Vector) -> (Vector, Matrix) {
    let (a, b) = (0.7 * x + 0.4 * y - 0.2 * z, 0.5 * y + 0.6 * z);
    let u = [a.sin(), (a + b).cos(), b.sin() * 0.5];
    let (da, db) = ([0.7, 0.4, -0.2], [0.0, 0.5, 0.6]);
    let gradient = [
        da.map(|d| a.cos() * d),
        std::array::from_fn(|k| -(a + b).sin() * (da[k] + db[k])),
        db.map(|d| 0.5 * b.cos() * d),
    ];
    (u, gradient)
}

fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

#[test]
fn nodal_strains_on_a_cylinder_converge_at_the_order_of_the_cell() {
    for vertical in [false, true] {
        for cell in CellType::ALL {
            let error = |size: f64| {
                let flat = rectangle_mesh([0.2, 0.0, 3.2, 2.0], size, cell).unwrap();
                let (mesh, _) = cylinder(cell, size, vertical);
                let displacement: Vec<Vector> = mesh.points().iter().map(|&x| wave(x).0).collect();
                let strains = StrainField::new(&mesh, &displacement, StrainMeasure::Small).at_nodes();
                let mut sum = 0.0;
                for (strain, p) in strains.iter().zip(flat.points()) {
                    let outward = cylinder_normal([p[0], p[1]], vertical);
                    let normal = cross(strain.axes[0], strain.axes[1]);
                    let side = if dot(normal, outward) > 0.0 { 1.0 } else { -1.0 };
                    let exact = strain_along(axes(outward.map(|c| side * c)), &wave(strain.position).1);
                    sum += strain.components.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
                }
                (sum / strains.len() as f64).sqrt()
            };
            let found = orders(&[0.2, 0.1, 0.05].map(error));
            let least = cell.edge_intervals() as f64 - 0.1;
            assert!(found.iter().all(|&order| order > least), "{cell}, vertical {vertical}: {found:?}");
        }
    }
}

#[test]
fn strains_on_a_cylinder_converge_at_the_order_of_the_cell() {
    for vertical in [false, true] {
        for cell in CellType::ALL {
            let error = |size: f64| {
                let (mesh, centres) = cylinder(cell, size, vertical);
                let displacement: Vec<Vector> = mesh.points().iter().map(|&x| wave(x).0).collect();
                let strains = cell_strains(&mesh, &displacement);
                let mut sum = 0.0;
                for (index, (strain, &at)) in strains.iter().zip(&centres).enumerate() {
                    // Outward or inward, as the mesh is oriented.
                    let [.., normal] = surface_gradients(cell, &mesh.cell_points(index), cell.reference_centre()).axes;
                    let outward = cylinder_normal(at, vertical);
                    let side = if dot(normal, outward) > 0.0 { 1.0 } else { -1.0 };
                    let exact = strain_along(axes(outward.map(|c| side * c)), &wave(on_cylinder(at, vertical)).1);
                    sum += strain.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
                }
                (sum / strains.len() as f64).sqrt()
            };
            let found = orders(&[0.2, 0.1, 0.05].map(error));
            let least = cell.edge_intervals() as f64 - 0.1;
            assert!(found.iter().all(|&order| order > least), "{cell}, vertical {vertical}: {found:?}");
        }
    }
}

#[test]
fn the_area_of_a_cylinder_converges_at_second_order_with_a_small_constant_for_curved_cells() {
    for vertical in [false, true] {
        for cell in CellType::ALL {
            let error =
                |size: f64| (cell_areas(&cylinder(cell, size, vertical).0).iter().sum::<f64>() / 6.0 - 1.0).abs();
            let errors = [0.5, 0.25, 0.125].map(error);
            let found = orders(&errors);
            assert!(found.iter().all(|&order| order > 1.9), "{cell}, vertical {vertical}: {found:?}");
            let largest = if cell.edge_intervals() > 1 { 1e-5 } else { 2e-4 };
            assert!(errors[2] < largest, "{cell}, vertical {vertical}: {errors:?}");
        }
    }
}
