//! The promise of the diameter rule: no pixel without a quadrature point.

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

fn pixels_missed(seed: u64, cell: CellType, size: f64) -> Vec<[i32; 2]> {
    let (mesh, outline) = jittered_mesh(&mut Random::new(seed), [7, 6], &[cell], size);
    let found = pixels_with_points(&mesh);
    pixels_inside(&outline).into_iter().filter(|pixel| !found.contains(pixel)).collect()
}

#[test]
#[ignore]
fn survey() {
    for cell in [CellType::Triangle, CellType::Quad] {
        let (mut meshes, mut failed, mut pixels, mut missed) = (0, 0, 0, 0);
        for seed in 0..20000_u64 {
            let size = 2.0 * 15.0_f64.powf(Random::new(seed ^ 0xabcdef).between(0.0, 1.0));
            let (_, outline) = jittered_mesh(&mut Random::new(seed), [7, 6], &[cell], size);
            let n = pixels_missed(seed, cell, size).len();
            meshes += 1;
            pixels += pixels_inside(&outline).len();
            missed += n;
            failed += usize::from(n > 0);
        }
        println!("{cell}: {failed}/{meshes} meshes, {missed}/{pixels} pixels");
    }
}
