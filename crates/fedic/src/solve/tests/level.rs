//! Factors in single and in double precision.

use std::sync::Arc;

use fedic_camera::ImageFrame;
use fedic_image::{Image, Interpolator};
use fedic_mesh::{CellType, rectangle_mesh};
use fedic_sparse::SpdFactor;
use fedic_synthetic::Speckle;

use crate::equations::dofs::Dofs;
use crate::solve::gauss_newton::GaussNewton;
use crate::solve::level::Comparison;
use crate::solve::tests::level;
use crate::{Brightness, Hessian, Options, PLANE};

const SIZE: usize = 240;

fn image(shift: f64) -> Image {
    let speckle = Speckle::new(5.0, 0.5, 3).unwrap();
    let at = |k: usize| [(k % SIZE) as f64 - shift, (k / SIZE) as f64 + 0.5 * shift];
    let greys = (0..SIZE * SIZE).map(|k| (35.0 + 180.0 * speckle.value(at(k))) as f32);
    Image::new(SIZE, SIZE, greys.collect()).unwrap()
}

/// Displacement with a factor in either precision.
fn measure(dofs: &Dofs<PLANE>, images: &[Image; 2], compact: bool) -> Vec<[f64; PLANE]> {
    let options = Options::default();
    let level = level(dofs, Arc::new(ImageFrame), &images[0], options.smoothing, compact);
    assert_eq!(level.factor.is_compact(), compact);
    let deformed = Interpolator::smoothed(images[1].view(), options.interpolation, options.smoothing).unwrap();
    let iterations = GaussNewton {
        level: 0,
        hessian: Hessian::Initial,
        tolerance: options.tolerance,
        max_iterations: options.max_iterations,
        max_increment: SIZE as f64,
    };
    let start = vec![[0.0; PLANE]; dofs.mesh.num_nodes()];
    let image = Comparison { deformed: &deformed, brightness: Brightness::Global, full_scale: None, robust: None };
    let outcome = level.solve(dofs, &image, &iterations, (start, &[]), &mut Vec::new(), &()).unwrap().outcome;
    assert!(outcome.converged);
    outcome.displacement
}

/// Measured on these cells: the displacement differs by up to 3.1e-6 px at a tolerance of 1e-3 px.
#[test]
fn a_factor_in_single_precision_gives_nearly_the_same_results() {
    let images = [image(0.0), image(0.7)];
    let meshes =
        [(CellType::Triangle, 6.0), (CellType::Quad, 6.0), (CellType::Triangle6, 14.0), (CellType::Quad9, 11.0)];
    for (cell_type, size) in meshes {
        let mesh = rectangle_mesh([20.0, 20.0, 220.0, 220.0], size, cell_type).unwrap();
        let dofs = Dofs::new(&mesh).unwrap();
        let [compact, double] = [true, false].map(|compact| measure(&dofs, &images, compact));
        let pairs = compact.as_flattened().iter().zip(double.as_flattened());
        let moved = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(moved < 1e-5, "{cell_type:?}: {moved:e} px");
        assert!(moved > 0.0, "{cell_type:?}: the same factor");
    }
}
