//! Positions and weights of the quadrature points.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::HashSet;
use std::sync::Arc;

use common::{Motion, render, warped_mesh};
use fedic::{Camera, CellType, Correlator, FrontParallel, ImageFrame, Mesh, Options, Quadrature, Rule, cell_areas};
use fedic_synthetic::Speckle;

fn points(camera: Arc<dyn Camera>, mesh: &Mesh, quadrature: Quadrature) -> (Vec<[f64; 3]>, Vec<f64>, Vec<usize>) {
    let speckle = Speckle::new(5.0, 0.5, 2).unwrap();
    let [image, _] = render(&ImageFrame, [100, 90], speckle, Motion::translation([0.0; 2]));
    let options = Options::default().quadrature(quadrature);
    let correlator = Correlator::new(Arc::new(image.clone()), mesh, camera, options).unwrap();
    let found = correlator.quadrature_points();
    assert_eq!([found.0.len(), found.1.len(), found.2.len()], [correlator.num_points(); 3]);
    assert!(found.2.is_sorted() && found.2.last().is_some_and(|&cell| cell == mesh.num_cells() - 1));
    found
}

#[test]
fn quadrature_weights_sum_to_the_area() {
    let camera = || -> Arc<dyn Camera> { Arc::new(FrontParallel::new(10.0, [50.0, 45.0]).unwrap()) };
    for cell in CellType::ALL {
        // The square of the diameter is twice the area of a square, four times that of half a square.
        let by_diameter = if cell.is_triangle() { 4.0..4.8 } else { 2.0..2.8 };
        let by_area = if cell.is_triangle() { 0.95..1.06 } else { 0.85..1.05 };
        let rules = [(Rule::Rotated, by_area.clone()), (Rule::Edges, by_area), (Rule::Diameter, by_diameter)];
        for (rule, expected) in rules {
            for density in [1.0, 4.0] {
                let mesh = warped_mesh([-4.1, -3.7, 4.3, 3.9], 2.0, cell, 0.2);
                let (_, weights, cells) = points(camera(), &mesh, Quadrature::Mesh { rule, density });
                let mut areas = vec![0.0; mesh.num_cells()];
                weights.iter().zip(cells).for_each(|(weight, cell)| areas[cell] += weight);
                for (area, exact) in areas.iter().zip(cell_areas(&mesh)) {
                    // Exact up to the rounding of the weights to single precision where edges are straight.
                    let accepted = if cell.num_nodes() == cell.num_corners() { 1e-6 } else { 1e-3 };
                    assert!((area - exact).abs() < accepted * exact, "{cell} {rule:?}: {area} {exact}");
                }
                let pixels = 100.0 * areas.iter().sum::<f64>();
                let per_pixel = weights.len() as f64 / pixels / density;
                assert!(expected.contains(&per_pixel), "{cell} {rule:?}: {per_pixel} points per pixel");
            }
        }
    }
}

#[test]
fn pixel_quadrature_contains_every_pixel_once() {
    for cell in CellType::ALL {
        let mesh = warped_mesh([12.3, 11.6, 87.4, 77.7], 15.0, cell, 1.5);
        let (points, weights, _) = points(Arc::new(ImageFrame), &mesh, Quadrature::Pixel);
        assert!(weights.iter().all(|&weight| weight == 1.0));
        let mut seen = HashSet::new();
        for [u, v, _] in points {
            let pixel = [u.round(), v.round()];
            // Reference coordinates are stored in single precision.
            assert!((u - pixel[0]).abs().max((v - pixel[1]).abs()) < 1e-5, "{cell}: ({u}, {v})");
            assert!(seen.insert(pixel.map(|c| c as i32)), "{cell}: pixel {pixel:?} twice");
        }
        // The outline moves by less than the amplitude of the warp.
        for (u, v) in (15..=85).flat_map(|u| (14..=75).map(move |v| (u, v))) {
            assert!(seen.contains(&[u, v]), "{cell}: pixel ({u}, {v}) left out");
        }
        assert!(seen.iter().all(|&[u, v]| (11..=88).contains(&u) && (11..=79).contains(&v)));
    }
}
