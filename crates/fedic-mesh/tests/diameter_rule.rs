//! The diameter rule leaves no pixel inside the mesh without a quadrature point.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashSet;

use common::{Random, cell_nodes, depth_in_convex, jittered_mesh};
use fedic_mesh::{CellType, Mesh, Rule, Subdivision, map};
use proptest::prelude::*;

/// Pixels, as closed unit squares around integers, that hold a quadrature point of the diameter rule.
fn pixels_with_points(mesh: &Mesh) -> HashSet<[i32; 2]> {
    let mut pixels = HashSet::new();
    for index in 0..mesh.num_cells() {
        let cell_type = mesh.cell(index).cell_type;
        let nodes = cell_nodes(mesh, index);
        let subdivision = Subdivision::of_cell(cell_type, &nodes, Rule::Diameter, 1.0);
        let count = subdivision.num_points();
        let (mut xi, mut eta) = (vec![0.0; count], vec![0.0; count]);
        subdivision.points(0, &mut xi, &mut eta);
        for (&x, &y) in xi.iter().zip(&eta) {
            let [u, v] = map(cell_type, &nodes, [x, y]);
            pixels.insert([u.round() as i32, v.round() as i32]);
        }
    }
    pixels
}

/// Pixels entirely inside a convex outline that turns counter-clockwise.
fn pixels_inside(outline: &[[f64; 2]]) -> Vec<[i32; 2]> {
    let range = |d: usize| {
        let (low, high) = outline.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[d]), h.max(p[d])));
        low.floor() as i32..=high.ceil() as i32
    };
    let corners = [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]];
    let inside = |&[u, v]: &[i32; 2]| {
        corners.iter().all(|[du, dv]| depth_in_convex(outline, [f64::from(u) + du, f64::from(v) + dv]) > 0.0)
    };
    range(1).flat_map(|v| range(0).map(move |u| [u, v])).filter(inside).collect()
}

fn pixels_missed(mesh: &Mesh, outline: &[[f64; 2]]) -> Vec<[i32; 2]> {
    let found = pixels_with_points(mesh);
    pixels_inside(outline).into_iter().filter(|pixel| !found.contains(pixel)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn every_pixel_inside_a_random_mesh_holds_a_point(seed: u64, magnitude in 0.0..1.0, kind in 0_usize..3) {
        let types = [&[CellType::Triangle][..], &[CellType::Quad], &[CellType::Triangle, CellType::Quad]][kind];
        // From 2 to 30 pixels.
        let size = 2.0 * 15.0_f64.powf(magnitude);
        let (mesh, outline) = jittered_mesh(&mut Random::new(seed), [7, 6], types, size, 0.24);
        prop_assert_eq!(pixels_missed(&mesh, &outline), Vec::<[i32; 2]>::new());
    }

    /// The worst that triangles can do: their longest edge a whole number of pixels, all of one shape. The largest square
    /// without a point then grows up to one pixel (upright triangles nearly equilateral), never beyond.
    #[test]
    fn triangles_with_edges_of_whole_pixels_leave_no_pixel_without_a_point(
        x in 0.0..1.0_f64,
        height in 0.02..1.0,
        angle in 0.0..std::f64::consts::TAU,
        parts in 2_u32..6,
        origin in [-0.5..0.5, -0.5..0.5],
    ) {
        // The apex over a base of length one, as high as the two other edges stay shorter.
        let y = height * (1.0 - x.max(1.0 - x).powi(2)).sqrt();
        let (sin, cos) = angle.sin_cos();
        let size = f64::from(parts) * (1.0 - 1e-12);
        let at = |[i, j]: [f64; 2]| {
            let [s, t] = [size * (i + x * j), size * y * j];
            [origin[0] + cos * s - sin * t, origin[1] + sin * s + cos * t]
        };
        let cells: Vec<i64> = (0..81)
            .flat_map(|square| {
                let first = square / 9 * 10 + square % 9;
                [first, first + 1, first + 10, first + 1, first + 11, first + 10]
            })
            .collect();
        let nodes = (0..100).map(|n| at([f64::from(n % 10), f64::from(n / 10)])).map(|[x, y]| [x, y, 0.0]).collect();
        let mesh = Mesh::new(nodes, &[(CellType::Triangle, cells)]).unwrap();
        let outline = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]].map(at);
        prop_assert_eq!(pixels_missed(&mesh, &outline), Vec::<[i32; 2]>::new());
    }

    /// Stronger, for quads: no point of one is further than half a pixel from the centre of its own sub-quad.
    #[test]
    fn every_subquad_lies_within_half_a_pixel_of_its_centre(seed: u64, size in 1.5..30.0) {
        let mut random = Random::new(seed);
        let nodes = random.corners(CellType::Quad, size);
        let Subdivision::Quad { nx, ny } = Subdivision::of_cell(CellType::Quad, &nodes, Rule::Diameter, 1.0) else {
            unreachable!("a quad is cut into quads");
        };
        let edge = |part: usize, parts: u32| 2.0 * part as f64 / f64::from(parts) - 1.0;
        for (i, j) in (0..ny as usize).flat_map(|j| (0..nx as usize).map(move |i| (i, j))) {
            let [west, east, south, north] = [edge(i, nx), edge(i + 1, nx), edge(j, ny), edge(j + 1, ny)];
            let centre = map(CellType::Quad, &nodes, [0.5 * (west + east), 0.5 * (south + north)]);
            for corner in [[west, south], [east, south], [east, north], [west, north]] {
                let [u, v] = map(CellType::Quad, &nodes, corner);
                let distance = (u - centre[0]).hypot(v - centre[1]);
                prop_assert!(distance < 0.5 + 1e-9, "{distance}");
            }
        }
    }
}
