//! Points of a subdivision, and the subdivision that each rule chooses.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashSet;

use common::{Random, determinant, straight_cell};
use fedic_mesh::{CellType, Rule, Subdivision, jacobian};
use proptest::prelude::*;

fn any_subdivision() -> impl Strategy<Value = Subdivision> {
    prop_oneof![
        (1_u32..60).prop_map(|n| Subdivision::Triangle { n }),
        (0_u8..3, 1_u32..60, 1_u32..60).prop_map(|(base, n, rows)| Subdivision::TriangleRows { base, n, rows }),
        (1_u32..60, 1_u32..60).prop_map(|(nx, ny)| Subdivision::Quad { nx, ny }),
        (1_u32..60, 1_u32..60).prop_map(|(nx, ny)| Subdivision::RotatedQuad { nx, ny }),
    ]
}

fn points(subdivision: Subdivision, first: usize, count: usize) -> Vec<[f64; 2]> {
    let (mut xi, mut eta) = (vec![f64::NAN; count], vec![f64::NAN; count]);
    subdivision.points(first, &mut xi, &mut eta);
    xi.into_iter().zip(eta).map(|(x, y)| [x, y]).collect()
}

proptest! {
    #[test]
    fn subcells_fill_the_reference_domain(subdivision in any_subdivision()) {
        let whole = match subdivision {
            Subdivision::Triangle { .. } | Subdivision::TriangleRows { .. } => 0.5,
            Subdivision::Quad { .. } | Subdivision::RotatedQuad { .. } => 4.0,
        };
        let sum = subdivision.subcell_area() * subdivision.num_points() as f64;
        prop_assert!((sum - whole).abs() < 1e-15, "{sum}");
    }

    #[test]
    fn points_lie_inside_apart_from_each_other_and_around_the_centre(subdivision in any_subdivision()) {
        let all = points(subdivision, 0, subdivision.num_points());
        // Centres of equal parts: none nearer to an edge than a third (triangles) or half (quads) of a part. Turned, the
        // points of a corner come as near as half a part over the number of parts. The first row and the last point of
        // rows are about a row high.
        let (centre, margin) = match subdivision {
            Subdivision::Triangle { n } => (1.0 / 3.0, 1.0 / (3.0 * f64::from(n))),
            Subdivision::TriangleRows { n, rows, .. } => (1.0 / 3.0, 0.1 / f64::from(n * rows)),
            Subdivision::Quad { nx, ny } => (0.0, 1.0 / f64::from(nx.max(ny))),
            Subdivision::RotatedQuad { nx, ny } => (0.0, 1.0 / f64::from(nx.max(ny)).powi(2)),
        };
        for &[x, y] in &all {
            let nearest = match subdivision {
                Subdivision::Triangle { .. } | Subdivision::TriangleRows { .. } => x.min(y).min(1.0 - x - y),
                Subdivision::Quad { .. } | Subdivision::RotatedQuad { .. } => (1.0 - x.abs()).min(1.0 - y.abs()),
            };
            prop_assert!(nearest > margin - 1e-14, "({x}, {y})");
        }
        let rounded: HashSet<[i64; 2]> = all.iter().map(|p| p.map(|c| (c * 1e9).round() as i64)).collect();
        prop_assert_eq!(rounded.len(), all.len());
        for d in 0..2 {
            let mean = all.iter().map(|p| p[d]).sum::<f64>() / all.len() as f64;
            prop_assert!((mean - centre).abs() < 1e-14, "{mean}");
        }
    }

    #[test]
    fn points_from_any_index_on_have_the_same_bits(
        subdivision in any_subdivision(),
        place: proptest::sample::Index,
        length: proptest::sample::Index,
    ) {
        let all = points(subdivision, 0, subdivision.num_points());
        let first = place.index(all.len());
        let count = 1 + length.index(all.len() - first);
        prop_assert_eq!(points(subdivision, first, count), &all[first..first + count]);
    }
}

fn rectangle(cell: CellType, width: f64, height: f64) -> Vec<[f64; 2]> {
    let corners = [[3.0, 4.0], [3.0 + width, 4.0], [3.0 + width, 4.0 + height], [3.0, 4.0 + height]];
    let triangle = [corners[0], corners[1], corners[3]];
    straight_cell(cell, if cell.is_triangle() { &triangle } else { &corners })
}

fn cut(cell: CellType, pixels: &[[f64; 2]], rule: Rule, density: f64) -> Subdivision {
    Subdivision::of_cell(cell, pixels, rule, density)
}

#[test]
fn the_edges_rule_counts_whole_pixels_along_the_edges() {
    for cell in CellType::ALL.into_iter().filter(|cell| !cell.is_triangle()) {
        let pixels = rectangle(cell, 12.7, 5.2);
        assert_eq!(cut(cell, &pixels, Rule::Edges, 1.0), Subdivision::Quad { nx: 12, ny: 5 });
        assert_eq!(cut(cell, &pixels, Rule::Edges, 4.0), Subdivision::Quad { nx: 25, ny: 10 });
        assert_eq!(cut(cell, &pixels, Rule::Edges, 1e-6), Subdivision::Quad { nx: 1, ny: 1 });
    }
    for cell in CellType::ALL.into_iter().filter(|cell| cell.is_triangle()) {
        // A hypotenuse of 13.72 pixels and a height of 4.81 above it.
        let mut pixels = rectangle(cell, 12.7, 5.2);
        let rows = |n, rows| Subdivision::TriangleRows { base: 1, n, rows };
        assert_eq!(cut(cell, &pixels, Rule::Edges, 1.0), rows(14, 5));
        pixels.iter_mut().for_each(|p| p[0] = -p[0]);
        assert_eq!(cut(cell, &pixels, Rule::Edges, 1.0), rows(14, 5));
        assert_eq!(cut(cell, &pixels, Rule::Edges, 4.0), rows(27, 10));
        assert_eq!(cut(cell, &pixels, Rule::Edges, 1e-6), rows(1, 1));
    }
}

#[test]
fn opposite_edges_of_different_length_leave_no_gaps() {
    let trapezium = |top: f64| {
        let (left, right) = (50.0 - 0.5 * top, 50.0 + 0.5 * top);
        [[10.0, 5.0], [90.0, 5.0], [right, 85.0], [left, 85.0]]
    };
    // The line halfway between the sloping edges is 80 pixels long; points along the long edge are 1.2 pixels apart.
    for (top, expected) in [(80.0, [80, 80]), (70.0, [70, 80]), (40.0, [66, 80]), (10.0, [66, 80]), (2.0, [66, 80])] {
        let [nx, ny] = expected;
        assert_eq!(
            cut(CellType::Quad, &trapezium(top), Rule::Rotated, 1.0),
            Subdivision::RotatedQuad { nx, ny },
            "{top}"
        );
    }
}

#[test]
fn the_rotated_rule_counts_as_the_edges_rule_does() {
    let pixels = rectangle(CellType::Quad, 12.7, 5.2);
    assert_eq!(cut(CellType::Quad, &pixels, Rule::Rotated, 1.0), Subdivision::RotatedQuad { nx: 12, ny: 5 });
    let pixels = rectangle(CellType::Triangle, 12.7, 5.2);
    let rows = Subdivision::TriangleRows { base: 1, n: 14, rows: 5 };
    assert_eq!(cut(CellType::Triangle, &pixels, Rule::Rotated, 1.0), rows);
}

/// Number of points and area in pixels of a cell.
fn points_and_area(cell: CellType, pixels: &[[f64; 2]]) -> (f64, f64) {
    let fine = Subdivision::uniform(cell, 32);
    let area = fine.all_points().into_iter().map(|at| determinant(jacobian(cell, pixels, at))).sum::<f64>()
        * fine.subcell_area();
    (cut(cell, pixels, Rule::Rotated, 1.0).num_points() as f64, area)
}

proptest! {
    #[test]
    fn parallelograms_have_a_point_per_whole_pixel_of_their_edges(seed: u64, size in 5.0_f64..80.0) {
        let mut random = Random::new(seed);
        let [[a, b], [c, d]] = random.affine(size);
        let corners = [[0.0, 0.0], [a, c], [a + b, c + d], [b, d]].map(|[x, y]| [x + 100.0, y - 50.0]);
        let [nx, ny] = [a.hypot(c), b.hypot(d)].map(|length| (length + 1e-9).floor() as u32);
        prop_assume!([a.hypot(c), b.hypot(d)].iter().all(|length| (length - length.round()).abs() > 1e-6));
        for cell in CellType::ALL.into_iter().filter(|cell| !cell.is_triangle()) {
            let pixels = straight_cell(cell, &corners);
            prop_assert_eq!(cut(cell, &pixels, Rule::Rotated, 1.0), Subdivision::RotatedQuad { nx, ny });
        }
    }

    #[test]
    fn no_point_of_a_convex_quad_stands_for_much_more_than_a_pixel(seed: u64, size in 10.0_f64..80.0, taper in 0.0_f64..0.95) {
        let mut random = Random::new(seed);
        let mut corners = random.corners(CellType::Quad, size);
        // The third edge shrinks.
        let towards = corners[2];
        for d in 0..2 {
            corners[3][d] += taper * (towards[d] - corners[3][d]);
        }
        for cell in CellType::ALL.into_iter().filter(|cell| !cell.is_triangle()) {
            let pixels = straight_cell(cell, &corners);
            let subdivision = cut(cell, &pixels, Rule::Rotated, 1.0);
            let Subdivision::RotatedQuad { nx, ny } = subdivision else { unreachable!() };
            let largest = CellType::Quad.reference_nodes().iter().map(|&at| determinant(jacobian(cell, &pixels, at))).fold(0.0, f64::max);
            // Rounded up instead of down, no point is further than 1.2 pixels from the next.
            prop_assert!(1.44 * f64::from(nx + 1) * f64::from(ny + 1) > 4.0 * largest, "{nx} {ny} {largest}");
        }
    }

    #[test]
    fn triangles_have_a_point_per_pixel_of_their_area(seed: u64, size in 10.0_f64..80.0, flatten in 0.1_f64..1.0) {
        let mut random = Random::new(seed);
        let corners: Vec<[f64; 2]> =
            random.corners(CellType::Triangle, size).into_iter().map(|[x, y]| [x, flatten * y]).collect();
        for cell in CellType::ALL.into_iter().filter(|cell| cell.is_triangle()) {
            let (points, area) = points_and_area(cell, &straight_cell(cell, &corners));
            let perimeter: f64 = (0..3).map(|k| (0..2).map(|d| (corners[k][d] - corners[(k + 1) % 3][d]).abs()).sum::<f64>()).sum();
            prop_assert!((points - area).abs() < 0.5 * perimeter, "{points} points for {area} pixels");
        }
    }

    #[test]
    fn rows_of_a_triangle_integrate_with_second_order(base in 0_u8..3, aspect in 1_u32..5) {
        // Exact second moments of the reference triangle.
        let exact = [1.0 / 12.0, 1.0 / 24.0, 1.0 / 12.0];
        let error = |n: u32| {
            let subdivision = Subdivision::TriangleRows { base, n, rows: n.div_ceil(aspect) };
            let mut moments = [0.0; 3];
            for [x, y] in subdivision.all_points() {
                moments.iter_mut().zip([x * x, x * y, y * y]).for_each(|(moment, value)| *moment += value);
            }
            let error = |k: usize| (moments[k] * subdivision.subcell_area() - exact[k]).abs();
            (0..3).map(error).fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(20), error(80));
        prop_assert!(coarse < 0.2 * f64::from(aspect * aspect) / 400.0 && fine < coarse / 8.0, "{coarse} {fine}");
    }
}

proptest! {
    #[test]
    fn rotated_points_stay_in_their_subcells_and_keep_the_mixed_moment(nx in 1_u32..60, ny in 1_u32..60) {
        let centres = Subdivision::Quad { nx, ny }.all_points();
        let turned = Subdivision::RotatedQuad { nx, ny }.all_points();
        for ([x, y], [a, b]) in centres.into_iter().zip(&turned) {
            prop_assert!((x - a).abs() * f64::from(nx) < 1.0 && (y - b).abs() * f64::from(ny) < 1.0);
        }
        let mixed = turned.iter().map(|[x, y]| x * y).sum::<f64>() / turned.len() as f64;
        // The mean of xi^2 over the centres of n parts is (1 - 1/n^2) / 3.
        let gap = (1.0 / f64::from(nx).powi(2) - 1.0 / f64::from(ny).powi(2)) / 3.0;
        prop_assert!((mixed - gap / f64::from(nx.max(ny))).abs() < 1e-12, "{mixed}");
    }
}

#[test]
fn rotated_points_have_all_subpixel_phases() {
    // 20 points along 20 pixels: the centres share one place in their pixels, the turned points share out all.
    let worst = |subdivision: Subdivision| {
        let places = subdivision.all_points().into_iter().map(|[x, _]| 2.0 * std::f64::consts::PI * 10.0 * x);
        let (cos, sin) = places.fold((0.0, 0.0), |(c, s), place| (c + place.cos(), s + place.sin()));
        f64::hypot(cos, sin) / subdivision.num_points() as f64
    };
    assert!(worst(Subdivision::Quad { nx: 20, ny: 20 }) > 0.999);
    assert!(worst(Subdivision::RotatedQuad { nx: 20, ny: 20 }) < 0.01);
}

#[test]
fn the_diameter_rule_cuts_every_edge_by_the_longest_distance() {
    for cell in CellType::ALL {
        // The diagonal is 13.72 pixels, and the longest edge of the triangle too.
        let pixels = rectangle(cell, 12.7, 5.2);
        let expected =
            |n| if cell.is_triangle() { Subdivision::Triangle { n } } else { Subdivision::Quad { nx: n, ny: n } };
        assert_eq!(cut(cell, &pixels, Rule::Diameter, 1.0), expected(14), "{cell}");
        assert_eq!(cut(cell, &pixels, Rule::Diameter, 2.0), expected(20), "{cell}");
    }
}

#[test]
fn rules_have_names() {
    assert_eq!("edges".parse::<Rule>().unwrap(), Rule::Edges);
    assert_eq!("rotated".parse::<Rule>().unwrap(), Rule::Rotated);
    assert_eq!("diameter".parse::<Rule>().unwrap(), Rule::Diameter);
    assert_eq!(
        "Edges".parse::<Rule>().unwrap_err().to_string(),
        "unknown quadrature rule \"Edges\"; choose one of \"rotated\", \"edges\", \"diameter\""
    );
}
