//! Sums of terms: two cameras, a reduced basis, and a second quadratic term.

use std::sync::Arc;

use fedic_camera::{Camera, ImageFrame, Pinhole};
use fedic_image::{Image, Interpolator};
use fedic_mesh::{CellType, Mesh, rectangle_mesh};
use fedic_sparse::SymmetricMatrix;
use fedic_synthetic::{Plane, Render, RigidMotion, Speckle};
use nalgebra::{Rotation3, Vector3};

use crate::equations::basis::Basis;
use crate::equations::dofs::Dofs;
use crate::equations::normal_equations::NormalEquations;
use crate::equations::term::{Term, TermReport};
use crate::equations::terms::image::ImageTerm;
use crate::observation::observe::Observation;
use crate::solve::basis::nodal::NodalBasis;
use crate::solve::basis::reduced::ReducedBasis;
use crate::solve::basis::rigid::RigidModes;
use crate::solve::gauss_newton::GaussNewton;
use crate::solve::tests::{level, observation_settings, sampler};
use crate::{Brightness, Error, Hessian, Monitor, Options, PLANE, SPACE};

const SMOOTHING: f64 = 0.8;

fn iterations(hessian: Hessian, image: &Image) -> GaussNewton {
    let max_increment = image.width().max(image.height()) as f64;
    GaussNewton { level: 0, hessian, tolerance: 1e-4, max_iterations: 30, max_increment }
}

fn prepare(image: &Image) -> Interpolator {
    Interpolator::smoothed(image.view(), Options::default().interpolation, SMOOTHING).unwrap()
}

/// Largest length of the differences of two fields.
fn largest_difference<const D: usize>(a: &[[f64; D]], b: &[[f64; D]]) -> f64 {
    let length = |(a, b): (&[f64; D], &[f64; D])| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    // `max` would ignore a NaN.
    a.iter().zip(b).map(length).fold(0.0, |largest, d| if d > largest || d.is_nan() { d } else { largest })
}

/// Two cameras 500 mm before the origin, 20 degrees apart, of about 3 px per mm.
fn stereo_cameras() -> [Pinhole; 2] {
    [-10.0_f64, 10.0].map(|degrees| {
        let facing = Rotation3::new(Vector3::new(std::f64::consts::PI, 0.0, 0.0));
        let turned = facing * Rotation3::new(Vector3::new(0.0, degrees.to_radians(), 0.0));
        let rotation = turned.matrix().transpose().data.0;
        Pinhole::new([1500.0; 2], [104.5, 89.5], rotation, [0.0, 0.0, 500.0]).unwrap()
    })
}

/// Images of a textured plane by one camera, before and after a motion.
fn images_of(camera: &Pinhole, plane: &Plane, motion: &RigidMotion) -> [Image; 2] {
    let speckle = Speckle::new(2.0, 0.5, 5).unwrap();
    [*plane, plane.moved(motion)].map(|plane| {
        let rendering = Render::new(camera, [210, 180]).plane(&plane, &speckle).unwrap();
        let greys = rendering.values().iter().map(|value| (35.0 + 180.0 * value) as f32).collect();
        Image::new(210, 180, greys).unwrap()
    })
}

#[test]
fn two_cameras_recover_a_rigid_motion_of_a_tilted_plane_in_space() {
    let (sin, cos) = 0.3_f64.sin_cos();
    let axes = [[cos, 0.0, sin], [0.0, 1.0, 0.0]];
    let plane = Plane::new([0.0; 3], axes).unwrap();
    let flat = rectangle_mesh([-24.0, -20.0, 24.0, 20.0], 6.0, CellType::Quad).unwrap();
    let points = flat.points().iter().map(|&[a, b, _]| plane.point([a, b])).collect();
    let cells = flat.cells().flat_map(|cell| cell.nodes.iter().map(|&node| i64::from(node))).collect();
    let mesh = Mesh::new(points, &[(CellType::Quad, cells)]).unwrap();
    let motion = RigidMotion::new([0.01, -0.015, 0.02], [0.0; 3], [0.3, -0.2, 0.4]).unwrap();

    let dofs = Dofs::<SPACE>::new(&mesh).unwrap();
    let mut hessian = SymmetricMatrix::zeros(&dofs.pattern);
    let (mut observations, mut deformed) = (Vec::new(), Vec::new());
    for camera in stereo_cameras() {
        let images = images_of(&camera, &plane, &motion);
        let camera: Arc<dyn Camera> = Arc::new(camera);
        let settings = observation_settings(&images[0]);
        let observation =
            Observation::<SPACE>::new(&dofs.mesh, camera, sampler(images[0].view(), SMOOTHING), &settings, &(), {
                |cell, sums| hessian.add_cell(&dofs.pattern, cell, &sums.matrix.entries())
            });
        observations.push(observation.unwrap());
        deformed.push(images[1].clone());
    }
    let quadrature = &observations[0].quadrature;
    let factor = dofs.factorize(&hessian, false, quadrature).unwrap();
    let prepared: Vec<Interpolator> = deformed.iter().map(prepare).collect();
    let mut terms: Vec<ImageTerm<'_, SPACE>> = observations
        .iter()
        .zip(&prepared)
        .map(|(observation, deformed)| ImageTerm::new(&dofs.mesh, observation, deformed, Brightness::None))
        .collect();
    let mut terms: Vec<&mut dyn Term<SPACE>> = terms.iter_mut().map(|term| term as &mut dyn Term<SPACE>).collect();
    let expected: Vec<[f64; 3]> = dofs
        .mesh
        .points()
        .iter()
        .map(|&point| {
            let moved = motion.apply(point);
            std::array::from_fn(|c| moved[c] - point[c])
        })
        .collect();
    for hessian in [Hessian::Initial, Hessian::Updated] {
        let mut basis = NodalBasis::new(&dofs, &factor, quadrature);
        let start = vec![[0.0; SPACE]; dofs.mesh.num_nodes()];
        let outcome =
            iterations(hessian, &deformed[0]).run(&mut terms, &mut basis, start, &mut Vec::new(), &()).unwrap();
        assert!(outcome.converged, "{hessian:?}");
        assert_eq!(outcome.reports.len(), 2);
        // Along the optical axes, where 20 degrees determine the least, the error is the largest.
        let error = 3.0 * largest_difference(&outcome.displacement, &expected);
        let largest = 3.0 * largest_difference(&expected, &vec![[0.0; SPACE]; expected.len()]);
        assert!(error < 0.01, "{hessian:?}: {error} px of a motion of up to {largest} px");
        assert!(largest > 2.0);
    }
}

const SIDE: usize = 180;
const CENTRE: f64 = 90.0;

/// A texture in the image plane, of which pixel `x` shows the material point `origin(x)`.
fn plane_image(origin: impl Fn([f64; 2]) -> [f64; 2]) -> Image {
    let speckle = Speckle::new(8.0, 0.5, 9).unwrap();
    let at = |k: usize| origin([(k % SIDE) as f64, (k / SIDE) as f64]);
    Image::new(SIDE, SIDE, (0..SIDE * SIDE).map(|k| (35.0 + 180.0 * speckle.value(at(k))) as f32).collect()).unwrap()
}

fn plane_dofs(size: f64) -> Dofs<PLANE> {
    Dofs::new(&rectangle_mesh([40.0, 40.0, 140.0, 140.0], size, CellType::Quad).unwrap()).unwrap()
}

#[test]
fn a_rigid_basis_recovers_a_rotation_of_three_degrees() {
    let (sin, cos) = 3.0_f64.to_radians().sin_cos();
    let turn = |[x, y]: [f64; 2], sin: f64| {
        let (dx, dy) = (x - CENTRE, y - CENTRE);
        [CENTRE + cos * dx - sin * dy, CENTRE + sin * dx + cos * dy]
    };
    let (reference, deformed) = (plane_image(|x| x), plane_image(|x| turn(x, -sin)));
    let dofs = plane_dofs(20.0);
    let level = level(&dofs, Arc::new(ImageFrame), &reference, SMOOTHING, false);
    let interpolator = prepare(&deformed);
    let mut term = level.image_term(&dofs, &interpolator, Brightness::Global);
    let mut basis = ReducedBasis::new(&dofs, RigidModes::new(&dofs.mesh), 0.0);
    let start = vec![[0.0; PLANE]; dofs.mesh.num_nodes()];
    let mut history = Vec::new();
    let outcome =
        iterations(Hessian::Updated, &deformed).run(&mut [&mut term], &mut basis, start, &mut history, &()).unwrap();
    assert!(outcome.converged && history.len() > 2, "{}", history.len());
    let points: Vec<[f64; 2]> = dofs.mesh.points().iter().map(|&[x, y, _]| [x, y]).collect();
    let moved: Vec<[f64; 2]> =
        points.iter().zip(&outcome.displacement).map(|(x, u)| [x[0] + u[0], x[1] + u[1]]).collect();
    let expected: Vec<[f64; 2]> = points.iter().map(|&x| turn(x, sin)).collect();
    let error = largest_difference(&moved, &expected);
    assert!(error < 0.01, "{error} px");
    // The field is rigid to rounding: distances do not change.
    let last = points.len() - 1;
    let distance = |x: &[[f64; 2]]| (x[0][0] - x[last][0]).hypot(x[0][1] - x[last][1]);
    assert!((distance(&moved) - distance(&points)).abs() < 1e-10);
}

/// Springs between each node and a target displacement: `stiffness / 2 sum over cells and their nodes of |u - target|^2`.
struct Springs<'a> {
    dofs: &'a Dofs<PLANE>,
    stiffness: f64,
    target: [f64; PLANE],
}

impl Springs<'_> {
    fn matrix(&self) -> SymmetricMatrix {
        let mut matrix = SymmetricMatrix::zeros(&self.dofs.pattern);
        for cell in 0..self.dofs.mesh.num_cells() {
            let size = self.dofs.mesh.cell(cell).nodes.len() * PLANE;
            let identity: Vec<f64> = (0..size * size).map(|k| if k / size == k % size { 1.0 } else { 0.0 }).collect();
            matrix.add_cell(&self.dofs.pattern, cell, &identity);
        }
        matrix
    }
}

impl Term<PLANE> for Springs<'_> {
    fn assemble(
        &mut self,
        displacement: &[[f64; PLANE]],
        basis: &dyn Basis<PLANE>,
        equations: &mut NormalEquations,
        _monitor: &dyn Monitor,
    ) -> Result<TermReport, Error> {
        let matrix = self.matrix();
        let stretch: Vec<f64> =
            displacement.iter().flat_map(|u| [u[0] - self.target[0], u[1] - self.target[1]]).collect();
        basis.add_vector(-self.stiffness, &matrix.multiply(&self.dofs.pattern, &stretch), equations);
        basis.add_matrix(self.stiffness, &matrix, equations);
        Ok(TermReport::default())
    }
}

#[test]
fn a_second_quadratic_term_balances_the_image_term() {
    let (motion, target) = ([0.6, -0.3], [0.1, 0.2]);
    let (reference, deformed) = (plane_image(|x| x), plane_image(|[x, y]| [x - motion[0], y - motion[1]]));
    let dofs = plane_dofs(20.0);
    let level = level(&dofs, Arc::new(ImageFrame), &reference, SMOOTHING, false);
    let interpolator = prepare(&deformed);
    let solve = |stiffness: f64| {
        let mut image = level.image_term(&dofs, &interpolator, Brightness::None);
        let mut springs = Springs { dofs: &dofs, stiffness, target };
        let mut basis = NodalBasis::new(&dofs, &level.factor, &level.observation.quadrature);
        let start = vec![[0.0; PLANE]; dofs.mesh.num_nodes()];
        let mut terms: [&mut dyn Term<PLANE>; 2] = [&mut image, &mut springs];
        let outcome =
            iterations(Hessian::Updated, &deformed).run(&mut terms, &mut basis, start, &mut Vec::new(), &()).unwrap();
        assert!(outcome.converged);
        // At the minimum the forces of both terms cancel.
        let forces = [0, 1].map(|term| {
            let mut equations = basis.equations(false);
            terms[term].assemble(&outcome.displacement, &basis, &mut equations, &()).unwrap();
            equations.right_hand_side
        });
        let size = |vector: &[f64]| vector.iter().map(|f| f * f).sum::<f64>().sqrt();
        let sum: Vec<f64> = forces[0].iter().zip(&forces[1]).map(|(image, spring)| image + spring).collect();
        (outcome.displacement, size(&sum) / size(&forces[1]))
    };
    let nodes = dofs.mesh.num_nodes();
    let to_target = |field: &[[f64; PLANE]]| largest_difference(field, &vec![target; nodes]);
    let to_motion = |field: &[[f64; PLANE]]| largest_difference(field, &vec![motion; nodes]);
    let (weak, _) = solve(1e-3);
    assert!(to_motion(&weak) < 0.01, "{}", to_motion(&weak));
    let (stiff, _) = solve(1e9);
    assert!(to_target(&stiff) < 1e-3, "{}", to_target(&stiff));
    let (balanced, unbalanced) = solve(2e5);
    assert!(unbalanced < 1e-3, "{unbalanced}");
    assert!(to_motion(&balanced) > 0.05 && to_target(&balanced) > 0.05, "{balanced:?}");
}
