//! Results are identical bit by bit for any number of threads and from one run to the next.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::sync::Arc;

use common::{Motion, mixed_mesh, render};
use fedic::{Brightness, Correlator, Hessian, Image, ImageFrame, Options, Quadrature, Rule, Solution, Start};
use fedic_synthetic::Speckle;

/// All numbers of a solution as bits, so that NaN equals NaN.
fn bits(solution: &Solution) -> Vec<u64> {
    let fields = solution.displacement.iter().chain(&solution.pixel_displacement).flatten();
    let iterations = solution.history.iter().flat_map(|i| [&i.correction, &i.residual_rms]);
    let numbers = fields.chain(iterations).chain(&solution.cell_residuals).chain([&solution.residual_rms]);
    let counts = solution.history.iter().flat_map(|i| [i.level as u64, i.iteration as u64]);
    numbers.map(|number| number.to_bits()).chain(counts).collect()
}

fn solve(images: &[Image; 2], options: &Options, num_threads: Option<usize>) -> Solution {
    // More cells than one thread processes at a time.
    let mesh = mixed_mesh([20.3, 18.7], 20, 8.0);
    let options = options.clone().num_threads(num_threads);
    let correlator = Correlator::new(Arc::new(images[0].clone()), &mesh, Arc::new(ImageFrame), options).unwrap();
    correlator.correlate(images[1].view(), Start::Pyramid).unwrap()
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let motion = Motion { gradient: [[1.01, 0.003], [-0.004, 0.995]], shift: [3.3, -2.6], centre: [100.0; 2] };
    let images = render(&ImageFrame, [200, 200], Speckle::new(5.0, 0.5, 3).unwrap(), motion);
    let mesh_rule = |rule| Quadrature::Mesh { rule, density: 1.0 };
    for quadrature in [mesh_rule(Rule::Rotated), mesh_rule(Rule::Diameter), Quadrature::Pixel] {
        for (brightness, hessian) in [(Brightness::Global, Hessian::Initial), (Brightness::Element, Hessian::Updated)] {
            let options = Options::default().quadrature(quadrature).brightness(brightness).hessian(hessian);
            let alone = solve(&images, &options, Some(1));
            assert!(alone.converged && alone.history.iter().any(|i| i.level > 0), "{:?}", alone.history);
            for num_threads in [Some(1), Some(2), Some(4), None] {
                let together = solve(&images, &options, num_threads);
                assert_eq!(bits(&together), bits(&alone), "{quadrature:?}, {num_threads:?} threads");
            }
        }
    }
}

#[test]
fn standard_deviations_do_not_depend_on_the_number_of_threads() {
    let [reference, _] =
        render(&ImageFrame, [200, 200], Speckle::new(5.0, 0.5, 3).unwrap(), Motion::translation([0.0; 2]));
    let mesh = mixed_mesh([20.3, 18.7], 20, 8.0);
    let deviations = |num_threads| -> Vec<u64> {
        let options = Options::default().smoothing(0.8).num_threads(num_threads);
        let correlator = Correlator::new(Arc::new(reference.clone()), &mesh, Arc::new(ImageFrame), options).unwrap();
        let found = correlator.covariance(2.0, None, None, &()).unwrap().standard_deviations();
        found.as_flattened().iter().map(|deviation| deviation.to_bits()).collect()
    };
    let alone = deviations(Some(1));
    for num_threads in [Some(1), Some(2), Some(4), None] {
        assert_eq!(deviations(num_threads), alone, "{num_threads:?} threads");
    }
}

#[test]
fn results_do_not_depend_on_earlier_frames() {
    let speckle = Speckle::new(5.0, 0.5, 3).unwrap();
    let [reference, first] = render(&ImageFrame, [200, 200], speckle, Motion::translation([2.3, -1.6]));
    let [_, second] = render(&ImageFrame, [200, 200], speckle, Motion::translation([-0.7, 1.2]));
    let mesh = mixed_mesh([20.3, 18.7], 20, 8.0);
    let correlator =
        || Correlator::new(Arc::new(reference.clone()), &mesh, Arc::new(ImageFrame), Options::default()).unwrap();
    let solve =
        |correlator: &Correlator, image: &Image| bits(&correlator.correlate(image.view(), Start::Zero).unwrap());
    let used = correlator();
    solve(&used, &first);
    assert_eq!(solve(&used, &second), solve(&correlator(), &second));
}
