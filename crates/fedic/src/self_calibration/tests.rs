//! Comparison of the normal equations with finite differences of the cost.

#![allow(clippy::unwrap_used)]

use fedic_camera::{BrownDistortion, Parameter, Pinhole, rotation_from_vector, unproject};
use fedic_image::{Image, Interpolation};
use fedic_mesh::{CellType, Mesh, rectangle_mesh};
use nalgebra::DVector;

use crate::self_calibration::image_stack::{ImageStack, LevelImages};
use crate::self_calibration::motion::{Motion, MotionKind};
use crate::self_calibration::normal_equations::CalibrationEquations;
use crate::self_calibration::problem::{Problem, State};
use crate::{Gradient, ImageSampler};
use fedic_synthetic::Speckle;

const SIZE: [usize; 2] = [150, 120];
const PARAMETERS: [Parameter; 6] =
    [Parameter::Lens("k1"), Parameter::Cx, Parameter::Cy, Parameter::Lens("k2"), Parameter::Rx, Parameter::Ry];
/// In-plane motions: translation and rotation about the centre of the mesh.
const MOTIONS: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [24.3, -11.8, 0.05], [-12.6, 20.4, -0.03]];

fn camera() -> Pinhole {
    let looking_down = rotation_from_vector([std::f64::consts::PI, 0.0, 0.0]);
    let camera = Pinhole::new([200.0; 2], [80.0, 55.0], looking_down, [0.0, 0.0, 200.0]).unwrap();
    camera.with_distortion(BrownDistortion::new([-0.3, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap())
}

fn motion([x, y, angle]: [f64; 3]) -> Motion {
    Motion::translation([0.0; 3], [x, y]).perturbed(&[5], &[angle])
}

/// Image of the moved specimen. Gain and offset vary from image to image.
fn image(index: usize) -> Image {
    let speckle = Speckle::new(9.0, 0.5, 2).unwrap();
    let [x, y, angle] = MOTIONS[index];
    let pixels = (0..SIZE[0] * SIZE[1]).map(|k| [(k % SIZE[0]) as f64, (k / SIZE[0]) as f64]);
    let greys = pixels.map(|pixel| {
        let [px, py, _] = unproject(&camera(), pixel, 0.0).unwrap();
        let (dx, dy, (sin, cos)) = (px - x, py - y, angle.sin_cos());
        let [gain, offset] = brightness(index);
        let grey = 40.0 + 170.0 * speckle.value([cos * dx + sin * dy, cos * dy - sin * dx]);
        ((grey - offset - 100.0) / gain + 100.0) as f32
    });
    Image::new(SIZE[0], SIZE[1], greys.collect()).unwrap()
}

/// Gain, about a grey level of 100, and offset that map an image to the reference image.
fn brightness(index: usize) -> [f64; 2] {
    [1.0 + 0.04 * index as f64, -3.0 * index as f64]
}

fn mesh() -> Mesh {
    rectangle_mesh([-90.0, -80.0, 90.0, 80.0], 20.0, CellType::Quad).unwrap()
}

fn problem(mesh: &Mesh) -> Problem<'_> {
    Problem {
        mesh,
        parameters: &PARAMETERS,
        components: MotionKind::InPlane.components(),
        gain_and_offset: true,
        num_images: MOTIONS.len(),
        grey_origin: 100.0,
        prior_deviation: 1.0,
    }
}

fn truth() -> State {
    State {
        camera: camera(),
        motions: MOTIONS.into_iter().map(motion).collect(),
        brightness: (0..MOTIONS.len()).map(brightness).collect(),
    }
}

fn stack<'a>(problem: &'a Problem<'a>) -> ImageStack<'a> {
    let sampler =
        |index| ImageSampler::new(image(index).view(), Interpolation::Bspline5, Gradient::Analytic, 0.0).unwrap();
    let samplers = (0..MOTIONS.len()).map(sampler).collect();
    let images = LevelImages { samplers, size: SIZE, factor: 1.0, margin: 6.0 };
    ImageStack::new(problem, images, &camera(), 0.2).unwrap()
}

/// Steps of the unknowns that displace the image points by 0.02 pixels, or change the grey levels slightly.
fn steps(problem: &Problem<'_>, equations: &CalibrationEquations) -> Vec<f64> {
    let layout = problem.layout();
    let mut steps = vec![f64::NAN; layout.len()];
    for image in 1..layout.images {
        steps[layout.block(image)][layout.motion..].copy_from_slice(&[2e-3, 0.2]);
    }
    for i in 0..steps.len() {
        if steps[i].is_nan() {
            let unit = DVector::from_fn(steps.len(), |k, _| if k == i { 1.0 } else { 0.0 });
            steps[i] = 0.02 / equations.rms_displacement(&unit);
        }
    }
    steps
}

#[test]
fn the_normal_matrix_is_half_the_second_derivative_of_the_cost() {
    let (mesh, state) = (mesh(), truth());
    let problem = problem(&mesh);
    let stack = stack(&problem);
    let equations = stack.assemble(&state, &state, |pixels| pixels, &()).unwrap();
    let degrees = equations.degrees_of_freedom();
    let cost = |step: &[f64]| {
        let perturbed = state.perturbed(&problem, step).unwrap();
        stack.assemble(&perturbed, &state, |pixels| pixels, &()).unwrap().residual_variance() * degrees
    };
    let (steps, matrix) = (steps(&problem, &equations), equations.matrix());
    let n = steps.len();
    assert_eq!(matrix.nrows(), n);
    let along = |i: usize, a: f64, k: usize, b: f64| {
        let mut step = vec![0.0; n];
        step[i] += a * steps[i];
        step[k] += b * steps[k];
        cost(&step)
    };
    for i in 0..n {
        for k in 0..=i {
            let mixed =
                along(i, 1.0, k, 1.0) + along(i, -1.0, k, -1.0) - along(i, 1.0, k, -1.0) - along(i, -1.0, k, 1.0);
            let numeric = mixed / 8.0;
            let [entry, scale] =
                [matrix[(i, k)], (matrix[(i, i)] * matrix[(k, k)]).sqrt()].map(|m| m * steps[i] * steps[k]);
            assert!(
                (numeric - entry).abs() < 0.01 * scale,
                "unknowns {i}, {k}: {numeric:e} for {entry:e} of {scale:e}"
            );
        }
    }
}

#[test]
fn a_step_reverts_a_small_change_of_any_unknown() {
    let (mesh, state) = (mesh(), truth());
    let problem = problem(&mesh);
    let stack = stack(&problem);
    let steps = steps(&problem, &stack.assemble(&state, &state, |pixels| pixels, &()).unwrap());
    for i in 0..steps.len() {
        let mut change = vec![0.0; steps.len()];
        change[i] = steps[i];
        let perturbed = state.perturbed(&problem, &change).unwrap();
        let equations = stack.assemble(&perturbed, &state, |pixels| pixels, &()).unwrap();
        let step = equations.step(0.0, &[f64::INFINITY; PARAMETERS.len()]).unwrap();
        for (k, (found, size)) in step.iter().zip(&steps).enumerate() {
            let error = (found + change[k]) / size;
            assert!(error.abs() < 0.05, "unknown {k} after a change of {i}: error {error}");
        }
    }
}
