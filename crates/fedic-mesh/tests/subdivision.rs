//! Points of a subdivision, and the subdivision that each rule chooses.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashSet;

use common::straight_cell;
use fedic_mesh::{CellType, Rule, Subdivision};
use proptest::prelude::*;

fn any_subdivision() -> impl Strategy<Value = Subdivision> {
    prop_oneof![
        (1_u32..60).prop_map(|n| Subdivision::Triangle { n }),
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
            Subdivision::Triangle { .. } => 0.5,
            Subdivision::Quad { .. } | Subdivision::RotatedQuad { .. } => 4.0,
        };
        let sum = subdivision.subcell_area() * subdivision.num_points() as f64;
        prop_assert!((sum - whole).abs() < 1e-15, "{sum}");
    }

    #[test]
    fn points_lie_inside_apart_from_each_other_and_around_the_centre(subdivision in any_subdivision()) {
        let all = points(subdivision, 0, subdivision.num_points());
        // Centres of equal parts: none nearer to an edge than a third (triangles) or half (quads) of a part. Turned, the
        // points of a corner come as near as half a part over the number of parts.
        let (centre, margin) = match subdivision {
            Subdivision::Triangle { n } => (1.0 / 3.0, 1.0 / (3.0 * f64::from(n))),
            Subdivision::Quad { nx, ny } => (0.0, 1.0 / f64::from(nx.max(ny))),
            Subdivision::RotatedQuad { nx, ny } => (0.0, 1.0 / f64::from(nx.max(ny)).powi(2)),
        };
        for &[x, y] in &all {
            let nearest = match subdivision {
                Subdivision::Triangle { .. } => x.min(y).min(1.0 - x - y),
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
    // Of two edges that face each other the shorter one counts.
    let trapezium = [[0.0, 0.0], [9.0, 0.0], [6.0, 4.5], [2.0, 4.5]];
    assert_eq!(cut(CellType::Quad, &trapezium, Rule::Edges, 1.0), Subdivision::Quad { nx: 4, ny: 4 });
    for cell in CellType::ALL.into_iter().filter(|cell| cell.is_triangle()) {
        // 1.6 times an area of 33.02 pixels, whichever way the triangle turns.
        let mut pixels = rectangle(cell, 12.7, 5.2);
        assert_eq!(cut(cell, &pixels, Rule::Edges, 1.0), Subdivision::Triangle { n: 7 });
        pixels.iter_mut().for_each(|p| p[0] = -p[0]);
        assert_eq!(cut(cell, &pixels, Rule::Edges, 1.0), Subdivision::Triangle { n: 7 });
        assert_eq!(cut(cell, &pixels, Rule::Edges, 4.0), Subdivision::Triangle { n: 14 });
    }
}

#[test]
fn the_rotated_rule_counts_as_the_edges_rule_does() {
    let pixels = rectangle(CellType::Quad, 12.7, 5.2);
    assert_eq!(cut(CellType::Quad, &pixels, Rule::Rotated, 1.0), Subdivision::RotatedQuad { nx: 12, ny: 5 });
    let pixels = rectangle(CellType::Triangle, 12.7, 5.2);
    assert_eq!(cut(CellType::Triangle, &pixels, Rule::Rotated, 1.0), Subdivision::Triangle { n: 7 });
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
