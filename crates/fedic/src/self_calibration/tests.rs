//! The normal equations against differences of the cost that they are to lower.

#![allow(clippy::unwrap_used)]

use fedic_camera::{BrownDistortion, Parameter, Pinhole, rotation_from_vector, unproject};
use fedic_image::{Image, Interpolation};
use fedic_mesh::{CellType, Mesh, rectangle_mesh};
use nalgebra::DVector;

use crate::self_calibration::motion::{Motion, MotionKind};
use crate::self_calibration::problem::{Problem, State};
use crate::self_calibration::sums::Sums;
use crate::self_calibration::view::{Frames, View};
use crate::{Gradient, ImageSampler};
use fedic_synthetic::Speckle;

const SIZE: [usize; 2] = [150, 120];
const PARAMETERS: [Parameter; 6] =
    [Parameter::K1, Parameter::Cx, Parameter::Cy, Parameter::K2, Parameter::Rx, Parameter::Ry];
/// In-plane motions: translation and rotation about the middle of the mesh.
const MOTIONS: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [24.3, -11.8, 0.05], [-12.6, 20.4, -0.03]];

fn camera() -> Pinhole {
    let looking_down = rotation_from_vector([std::f64::consts::PI, 0.0, 0.0]);
    let camera = Pinhole::new([200.0; 2], [80.0, 55.0], looking_down, [0.0, 0.0, 200.0]).unwrap();
    camera.with_distortion(BrownDistortion::new([-0.3, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap())
}

fn motion([x, y, turn]: [f64; 3]) -> Motion {
    Motion::translation([0.0; 3], [x, y]).moved_by(&[5], &[turn])
}

/// What the camera sees of the specimen moved; grey levels change from image to image.
fn image(index: usize) -> Image {
    let speckle = Speckle::new(9.0, 0.5, 2).unwrap();
    let [x, y, turn] = MOTIONS[index];
    let pixels = (0..SIZE[0] * SIZE[1]).map(|k| [(k % SIZE[0]) as f64, (k / SIZE[0]) as f64]);
    let greys = pixels.map(|pixel| {
        let [px, py, _] = unproject(&camera(), pixel, 0.0).unwrap();
        let (dx, dy, (sin, cos)) = (px - x, py - y, turn.sin_cos());
        let [gain, offset] = brightness(index);
        let grey = 40.0 + 170.0 * speckle.value([cos * dx + sin * dy, cos * dy - sin * dx]);
        ((grey - offset - 100.0) / gain + 100.0) as f32
    });
    Image::new(SIZE[0], SIZE[1], greys.collect()).unwrap()
}

/// Gain and offset that bring an image back to the reference, about a grey level of 100.
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
        brightness: true,
        images: MOTIONS.len(),
        pivot: 100.0,
        reach: 1.0,
    }
}

fn truth() -> State {
    State {
        camera: camera(),
        motions: MOTIONS.into_iter().map(motion).collect(),
        brightness: (0..MOTIONS.len()).map(brightness).collect(),
    }
}

fn view<'a>(problem: &'a Problem<'a>) -> View<'a> {
    let sample =
        |index| ImageSampler::new(image(index).view(), Interpolation::Bspline5, Gradient::Analytic, 0.0).unwrap();
    let frames = Frames { samplers: (0..MOTIONS.len()).map(sample).collect(), size: SIZE, factor: 1.0, margin: 6.0 };
    View::new(problem, frames, &camera(), 0.2).unwrap()
}

/// Steps of the unknowns that move the images by a fiftieth of a pixel, or change the grey levels a little.
fn steps(problem: &Problem<'_>, sums: &Sums) -> Vec<f64> {
    let layout = problem.layout();
    let mut steps = vec![f64::NAN; layout.len()];
    for image in 1..layout.images {
        steps[layout.block(image)][layout.motion..].copy_from_slice(&[2e-3, 0.2]);
    }
    for i in 0..steps.len() {
        if steps[i].is_nan() {
            let unit = DVector::from_fn(steps.len(), |k, _| if k == i { 1.0 } else { 0.0 });
            steps[i] = 0.02 / sums.visible_motion(&unit);
        }
    }
    steps
}

#[test]
fn the_normal_matrix_is_half_the_second_derivative_of_the_cost() {
    let (mesh, state) = (mesh(), truth());
    let problem = problem(&mesh);
    let view = view(&problem);
    let sums = view.sums(&state, &state, |pixels| pixels, &()).unwrap();
    let freedom = sums.freedom();
    let cost = |step: &[f64]| {
        let moved = state.moved_by(&problem, step).unwrap();
        view.sums(&moved, &state, |pixels| pixels, &()).unwrap().variance() * freedom
    };
    let (steps, matrix) = (steps(&problem, &sums), sums.matrix());
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
fn a_step_undoes_a_small_change_of_any_unknown() {
    let (mesh, state) = (mesh(), truth());
    let problem = problem(&mesh);
    let view = view(&problem);
    let steps = steps(&problem, &view.sums(&state, &state, |pixels| pixels, &()).unwrap());
    for i in 0..steps.len() {
        let mut change = vec![0.0; steps.len()];
        change[i] = steps[i];
        let moved = state.moved_by(&problem, &change).unwrap();
        let sums = view.sums(&moved, &state, |pixels| pixels, &()).unwrap();
        let step = sums.step(0.0, &[f64::INFINITY; PARAMETERS.len()]).unwrap();
        for (k, (found, size)) in step.iter().zip(&steps).enumerate() {
            let error = (found + change[k]) / size;
            assert!(error.abs() < 0.05, "unknown {k} after a change of {i}: wrong by {error}");
        }
    }
}
