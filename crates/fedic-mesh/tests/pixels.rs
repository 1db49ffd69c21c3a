//! Pixels of a polygon: cells that tile a region partition its pixels.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashMap;

use common::{Random, cell_nodes, jittered_mesh, mesh_of_grid};
use fedic_mesh::{CellType, Mesh, pixels_in_polygon};
use proptest::prelude::*;

fn pixels(polygon: &[[f64; 2]]) -> Vec<[i32; 2]> {
    let mut pixels = Vec::new();
    pixels_in_polygon(polygon, &mut pixels);
    pixels
}

fn outline(mesh: &Mesh, cell: usize) -> Vec<[f64; 2]> {
    let nodes = cell_nodes(mesh, cell);
    mesh.cell(cell).cell_type.outline().iter().map(|&node| nodes[node]).collect()
}

/// How many cells each pixel belongs to.
fn owners(mesh: &Mesh) -> HashMap<[i32; 2], usize> {
    let mut owners = HashMap::new();
    for cell in 0..mesh.num_cells() {
        for pixel in pixels(&outline(mesh, cell)) {
            *owners.entry(pixel).or_default() += 1;
        }
    }
    owners
}

fn around(polygon: &[[f64; 2]]) -> impl Iterator<Item = [i32; 2]> {
    let range = |d: usize| {
        let (low, high) = polygon.iter().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p[d]), h.max(p[d])));
        low.floor() as i32 - 1..=high.ceil() as i32 + 1
    };
    let columns = range(0);
    range(1).flat_map(move |v| columns.clone().map(move |u| [u, v]))
}

/// Whether a pixel lies in a polygon, by the angle under which it sees the edges; `None` on an edge.
fn is_inside(polygon: &[[f64; 2]], [u, v]: [i32; 2]) -> Option<bool> {
    let (u, v) = (f64::from(u), f64::from(v));
    let mut angle = 0.0;
    for (k, a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let (ax, ay, bx, by) = (a[0] - u, a[1] - v, b[0] - u, b[1] - v);
        let (cross, dot) = (ax * by - ay * bx, ax * bx + ay * by);
        if cross.abs() <= 1e-9 && dot <= 1e-9 {
            return None;
        }
        angle += cross.atan2(dot);
    }
    Some(angle.abs() > std::f64::consts::PI)
}

/// Every pixel inside belongs to one cell, none outside to any; one on the outline to one at most.
fn check_partition(mesh: &Mesh, outline: &[[f64; 2]]) -> Result<(), TestCaseError> {
    let owners = owners(mesh);
    for pixel in around(outline) {
        let count = owners.get(&pixel).copied().unwrap_or(0);
        match is_inside(outline, pixel) {
            Some(inside) => prop_assert_eq!(count, usize::from(inside), "pixel {:?}", pixel),
            None => prop_assert!(count <= 1, "pixel {:?} on the outline: {}", pixel, count),
        }
    }
    Ok(())
}

proptest! {
    #[test]
    fn cells_of_any_mesh_partition_its_pixels(seed: u64, size in 1.0..12.0) {
        let (mesh, outline) = jittered_mesh(&mut Random::new(seed), [6, 5], &CellType::ALL, size, 0.24);
        check_partition(&mesh, &outline)?;
    }

    /// Vertices, and long stretches of edges, exactly on pixel centres and halfway between them.
    #[test]
    fn cells_with_whole_and_half_coordinates_partition_their_pixels(seed: u64, pitch in 3_u32..7, x0 in -9..9, shear in -1..=1) {
        let mut random = Random::new(seed);
        let [columns, rows] = [5, 4];
        let pitch = f64::from(pitch);
        let at = |x: f64, y: f64| [0.5 * f64::from(x0) + x + f64::from(shear) * y, 0.5 + y];
        let types = [CellType::Triangle, CellType::Quad];
        let mesh = mesh_of_grid(&mut random, [columns, rows], &types, |random, [i, j]| {
            let mut place = |k: usize, n: usize| {
                let inner = k > 0 && k < n;
                k as f64 * pitch + if inner { 0.5 * random.index(3) as f64 - 0.5 } else { 0.0 }
            };
            let (x, y) = (place(i, columns), place(j, rows));
            at(x, y)
        });
        let (width, height) = (columns as f64 * pitch, rows as f64 * pitch);
        let outline = [at(0.0, 0.0), at(width, 0.0), at(width, height), at(0.0, height)];
        check_partition(&mesh, &outline)?;
        // The outline follows the same rule as the cells: what they take together is what it takes alone.
        let mut together: Vec<[i32; 2]> = owners(&mesh).into_keys().collect();
        together.sort_unstable_by_key(|&[u, v]| (v, u));
        prop_assert_eq!(together, pixels(&outline));
    }

    /// Where rounding decides on which side of a shared edge a pixel lies, both cells must agree.
    #[test]
    fn a_pixel_on_a_shared_edge_belongs_to_one_of_its_cells(
        pixel in [-50_i32..50, -50_i32..50],
        direction in [-1.0..1.0_f64, 0.1..1.0],
        before in 0.5..9.0_f64,
        after in 0.5..9.0_f64,
    ) {
        let [u, v] = pixel.map(f64::from);
        let [dx, dy] = direction;
        let (a, b) = ([u - before * dx, v - before * dy], [u + after * dx, v + after * dy]);
        let (left, right) = ([u - 9.0 * dy, v + 9.0 * dx], [u + 9.0 * dy, v - 9.0 * dx]);
        let found = [[a, b, left], [b, a, right]].map(|triangle| pixels(&triangle).contains(&pixel));
        prop_assert!(found[0] != found[1], "{:?}", found);
    }

    /// Star-shaped polygons, most of them not convex.
    #[test]
    fn pixels_of_a_polygon_are_those_inside(
        radii in proptest::collection::vec(1.0..9.0, 3..9),
        centre in [-20.0..20.0, -20.0..20.0],
        turn in 0.0..6.0_f64,
    ) {
        let angle = |k: usize| -> f64 { turn + std::f64::consts::TAU * k as f64 / radii.len() as f64 };
        let vertex = |(k, r): (usize, &f64)| [centre[0] + r * angle(k).cos(), centre[1] + r * angle(k).sin()];
        let polygon: Vec<[f64; 2]> = radii.iter().enumerate().map(vertex).collect();
        let found = pixels(&polygon);
        for pixel in around(&polygon) {
            if let Some(inside) = is_inside(&polygon, pixel) {
                prop_assert_eq!(found.contains(&pixel), inside, "pixel {:?}", pixel);
            }
        }
    }

    #[test]
    fn neither_the_first_vertex_nor_the_direction_matters(
        doubled in proptest::collection::vec([-12_i32..12, -12_i32..12], 3..7),
        first in 0_usize..7,
    ) {
        let mut polygon: Vec<[f64; 2]> = doubled.iter().map(|p| p.map(|c| 0.5 * f64::from(c))).collect();
        let found = pixels(&polygon);
        let first = first % polygon.len();
        polygon.rotate_left(first);
        prop_assert_eq!(&pixels(&polygon), &found);
        polygon.reverse();
        prop_assert_eq!(&pixels(&polygon), &found);
    }
}

#[test]
fn pixels_are_added_to_those_before_row_by_row() {
    let mut pixels = vec![[7, 7]];
    // Two opposite sides are taken, the other two left.
    pixels_in_polygon(&[[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]], &mut pixels);
    assert_eq!(pixels, [[7, 7], [1, 1], [2, 1], [1, 2], [2, 2]]);
    let before = pixels.clone();
    pixels_in_polygon(&[[0.2, 0.2], [0.8, 0.2], [0.5, 0.8]], &mut pixels);
    assert_eq!(pixels, before);
}
