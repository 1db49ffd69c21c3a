//! The smooth start.

use std::sync::Arc;

use fedic_camera::ImageFrame;
use fedic_image::{Image, Interpolator};
use fedic_mesh::{CellType, rectangle_mesh};
use fedic_synthetic::Speckle;

use crate::equations::dofs::Dofs;
use crate::solve::basis::nodal::NodalBasis;
use crate::solve::start::smooth_field::smooth_start;
use crate::solve::tests::level;
use crate::{Brightness, Options};

const SIZE: usize = 400;
const BOUNDS: [f64; 4] = [20.0, 20.0, 380.0, 380.0];

/// A texture after a displacement, given by the material point seen at each pixel.
fn image(origin: impl Fn([f64; 2]) -> [f64; 2]) -> Image {
    let speckle = Speckle::new(5.0, 0.5, 3).unwrap();
    let at = |k: usize| origin([(k % SIZE) as f64, (k / SIZE) as f64]);
    let greys = (0..SIZE * SIZE).map(|k| (35.0 + 180.0 * speckle.value(at(k))) as f32);
    Image::new(SIZE, SIZE, greys.collect()).unwrap()
}

/// The field found from `start`, the nodes, and the mean square of the residual in the subset before and after.
fn smooth(size: f64, deformed: &Image, start: [f64; 2]) -> (Vec<[f64; 2]>, Vec<[f64; 3]>, [f64; 2]) {
    let mesh = rectangle_mesh(BOUNDS, size, CellType::Quad).unwrap();
    let dofs = Dofs::new(&mesh).unwrap();
    let reference = image(|x| x);
    let level = level(&dofs, Arc::new(ImageFrame), &reference, 0.0, false);
    let deformed = Interpolator::new(deformed.view(), Options::default().interpolation);
    let start = vec![start; mesh.num_nodes()];
    let found = smooth_start(&dofs, &level, &deformed, Brightness::Global, start.clone(), &()).unwrap();
    let residuals = [&start, &found].map(|field| {
        let mut term = level.image_term(&dofs, &deformed, Brightness::Global).restricted_to(&level.subset);
        term.estimate_gain_offset(field, &level.subset, &()).unwrap();
        let basis = NodalBasis::new(&dofs, &level.factor, &level.observation.quadrature);
        let report = term.evaluate(field, &basis, &()).unwrap();
        report.cost / report.weight
    });
    (found, mesh.points().to_vec(), residuals)
}

#[test]
fn a_smooth_motion_is_found_to_a_fraction_of_a_pixel() {
    let moved = |[x, y]: [f64; 2]| [2.5 + 0.006 * (x - 200.0), -1.8 + 1e-5 * (x - 200.0) * (y - 200.0)];
    // Two fixed-point iterations: accurate to 1e-4 px.
    let origin = |[x, y]: [f64; 2]| {
        let [u, v] = moved([x, y]);
        let [u, v] = moved([x - u, y - v]);
        [x - u, y - v]
    };
    let (found, points, [before, after]) = smooth(6.0, &image(origin), [0.0; 2]);
    assert!(after < 0.02 * before, "{before} {after}");
    for (found, point) in found.iter().zip(points) {
        let [u, v] = moved([point[0], point[1]]);
        let error = (found[0] - u).hypot(found[1] - v);
        assert!(error < 0.005, "{error} px at {point:?}");
    }
}

#[test]
fn a_start_near_the_solution_is_unchanged() {
    let start = [1.2, 0.7];
    let (found, ..) = smooth(6.0, &image(|[x, y]| [x - 1.23, y - 0.66]), start);
    assert!(found.iter().all(|&u| u == start));
}

#[test]
fn a_field_that_does_not_lower_the_residual_is_rejected() {
    let unrelated = image(|[x, y]| [x + 5000.0, y - 3000.0]);
    let start = [0.3, -0.2];
    let (found, _, [before, after]) = smooth(6.0, &unrelated, start);
    assert!(after <= before, "{before} {after}");
    assert!(found.iter().flatten().all(|u| u.is_finite() && u.abs() < 20.0));
}

#[test]
fn a_mesh_of_few_cells_is_not_sampled() {
    let (found, ..) = smooth(20.0, &image(|[x, y]| [x - 2.0, y]), [0.0; 2]);
    assert!(found.iter().all(|&u| u == [0.0; 2]));
}
