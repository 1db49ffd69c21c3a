//! The polynomial approximation of the projection over a cell is checked against the camera only when needed.

#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use common::{Motion, render, warped_mesh};
use fedic::{
    BrownDistortion, Camera, CellType, Correlator, Monitor, Options, Pinhole, Progress, Start, rotation_from_vector,
};
use fedic_synthetic::Speckle;

/// A camera that counts the points it projects.
#[derive(Debug)]
struct Counting {
    camera: Pinhole,
    projected: AtomicUsize,
}

impl Camera for Counting {
    fn project(&self, point: [f64; 3]) -> [f64; 2] {
        self.camera.project(point)
    }

    fn project_with_jacobian(&self, point: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]) {
        self.camera.project_with_jacobian(point)
    }

    fn unproject_linear(&self, pixel: [f64; 2], z: f64) -> [f64; 3] {
        self.camera.unproject_linear(pixel, z)
    }

    fn project_with_jacobian_batch(
        &self,
        x: &[f64],
        y: &[f64],
        z: &[f64],
        u: &mut [f64],
        v: &mut [f64],
        jacobian: &mut [[&mut [f64]; 3]; 2],
    ) {
        self.projected.fetch_add(x.len(), Ordering::Relaxed);
        self.camera.project_with_jacobian_batch(x, y, z, u, v, jacobian);
    }
}

/// Number of points projected so far and the correction, at each iteration.
struct Record<'a>(&'a Counting, Mutex<Vec<(usize, f64)>>);

impl Monitor for Record<'_> {
    fn progress(&self, progress: &Progress) {
        if progress.iteration > 0 {
            self.1.lock().unwrap().push((self.0.projected.load(Ordering::Relaxed), progress.correction));
        }
    }
}

#[test]
fn projection_polynomials_are_checked_again_after_one_pixel_of_motion() {
    let lens = BrownDistortion::new([-0.05, 0.0, 0.0], [0.0; 2], [0.0; 2]).unwrap();
    let rotation = rotation_from_vector([std::f64::consts::PI, 0.1, 0.0]);
    let camera = Pinhole::new([1000.0; 2], [100.0; 2], rotation, [0.0, 0.0, 1000.0]).unwrap().with_distortion(lens);
    let camera = Arc::new(Counting { camera, projected: AtomicUsize::new(0) });
    let speckle = Speckle::new(8.0, 0.5, 3).unwrap();
    let images = render(camera.as_ref(), [200, 200], speckle, Motion::translation([2.1, -1.4]));
    let mesh = warped_mesh([-70.0, -70.0, 70.0, 70.0], 14.0, CellType::Quad, 0.5);
    // Without smoothing no pass prepares its correction for the deformation.
    let options = Options::default().tolerance(1e-5).smoothing(0.0).num_threads(Some(1));
    let shared: Arc<dyn Camera> = Arc::<Counting>::clone(&camera);
    let correlator = Correlator::new(Arc::new(images[0].clone()), &mesh, shared, options).unwrap();
    let record = Record(&camera, Mutex::default());
    let solution = correlator.correlate_with(images[1].view(), Start::Zero, &record).unwrap();
    assert!(solution.converged);

    let record = record.1.into_inner().unwrap();
    let projected: Vec<usize> = record.windows(2).map(|pair| pair[1].0 - pair[0].0 - mesh.num_nodes()).collect();
    // The centre of each cell, and as many points for a check; some cells are expanded twice, the same ones each time.
    let centres = *projected.iter().min().unwrap();
    assert!(centres >= mesh.num_cells());
    let mut moved = 0.0;
    for (projected, (_, correction)) in projected.iter().zip(&record) {
        moved += correction;
        assert_eq!(*projected, if moved > 1.0 { 2 * centres } else { centres }, "moved by {moved} px");
        if moved > 1.0 {
            moved = 0.0;
        }
    }
    assert!(projected.contains(&(2 * centres)), "{record:?}");
}
