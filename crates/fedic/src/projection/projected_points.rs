//! Points projected by a camera in batches, which costs less than one by one.

use fedic_camera::Camera;
use fedic_mesh::Mesh;
use rayon::prelude::*;

/// Largest number of points of a batch.
pub(crate) const BATCH: usize = 40;

/// A batch of points with their projections.
pub(crate) struct ProjectedPoints {
    world: [[f64; BATCH]; 3],
    pixel: [[f64; BATCH]; 2],
    jacobian: [[[f64; BATCH]; 3]; 2],
}

/// A point in the world, its image point and the Jacobian of the projection there.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ProjectedPoint {
    pub(crate) world: [f64; 3],
    pub(crate) pixel: [f64; 2],
    pub(crate) jacobian: [[f64; 3]; 2],
}

impl ProjectedPoints {
    /// Projects up to [`BATCH`] points; further ones are ignored.
    pub(crate) fn new(camera: &dyn Camera, points: impl Iterator<Item = [f64; 3]>) -> Self {
        let mut batch = Self { world: [[0.0; BATCH]; 3], pixel: [[0.0; BATCH]; 2], jacobian: [[[0.0; BATCH]; 3]; 2] };
        let mut n = 0;
        for point in points.take(BATCH) {
            (0..3).for_each(|d| batch.world[d][n] = point[d]);
            n += 1;
        }
        let [x, y, z] = batch.world.each_ref().map(|c| &c[..n]);
        let [u, v] = batch.pixel.each_mut().map(|c| &mut c[..n]);
        let mut jacobian = batch.jacobian.each_mut().map(|row| row.each_mut().map(|entry| &mut entry[..n]));
        camera.project_with_jacobian_batch(x, y, z, u, v, &mut jacobian);
        batch
    }

    /// Point `k` of the batch.
    pub(crate) fn at(&self, k: usize) -> ProjectedPoint {
        ProjectedPoint {
            world: self.world.each_ref().map(|c| c[k]),
            pixel: self.pixel.each_ref().map(|c| c[k]),
            jacobian: self.jacobian.each_ref().map(|row| row.each_ref().map(|entry| entry[k])),
        }
    }
}

impl ProjectedPoint {
    /// Pixels per area of a surface along the `D` components of the displacement: the mean square of the scale along two directions.
    pub(crate) fn pixels_per_area<const D: usize>(&self) -> f64 {
        0.5 * self.jacobian.iter().flat_map(|row| &row[..D]).map(|entry| entry * entry).sum::<f64>()
    }
}

/// Projects every node of a mesh, displaced if a displacement is given.
pub(crate) fn project_nodes<const D: usize>(
    mesh: &Mesh,
    camera: &dyn Camera,
    displacement: Option<&[[f64; D]]>,
) -> Vec<ProjectedPoint> {
    let mut nodes = vec![ProjectedPoint::default(); mesh.num_nodes()];
    nodes.par_chunks_mut(BATCH).enumerate().for_each(|(chunk, nodes)| {
        let projected = project_chunk(mesh, camera, displacement, chunk);
        nodes.iter_mut().enumerate().for_each(|(k, node)| *node = projected.at(k));
    });
    nodes
}

/// Displacement of every node in the image, `P(X + U) - P(X)`, in pixels.
pub(crate) fn pixel_displacement<const D: usize>(
    mesh: &Mesh,
    camera: &dyn Camera,
    displacement: &[[f64; D]],
) -> Vec<[f64; 2]> {
    let mut pixels = vec![[0.0; 2]; mesh.num_nodes()];
    pixels.par_chunks_mut(BATCH).enumerate().for_each(|(chunk, pixels)| {
        let [from, to] =
            [None, Some(displacement)].map(|displacement| project_chunk(mesh, camera, displacement, chunk));
        for (k, pixels) in pixels.iter_mut().enumerate() {
            let (from, to) = (from.at(k).pixel, to.at(k).pixel);
            *pixels = [to[0] - from[0], to[1] - from[1]];
        }
    });
    pixels
}

/// Projects the nodes of chunk number `chunk`, of [`BATCH`] nodes.
fn project_chunk<const D: usize>(
    mesh: &Mesh,
    camera: &dyn Camera,
    displacement: Option<&[[f64; D]]>,
    chunk: usize,
) -> ProjectedPoints {
    let nodes = chunk * BATCH..mesh.num_nodes();
    let points = nodes.map(|node| {
        let mut point = mesh.points()[node];
        if let Some(displacement) = displacement {
            point.iter_mut().zip(displacement[node]).for_each(|(x, u)| *x += u);
        }
        point
    });
    ProjectedPoints::new(camera, points)
}

/// Smallest and largest image coordinate of some points, along `u` and along `v`.
pub(crate) fn pixel_bounds<'a>(points: impl Iterator<Item = &'a ProjectedPoint>) -> [[f64; 2]; 2] {
    let empty = [f64::INFINITY, f64::NEG_INFINITY];
    points.fold([empty; 2], |bounds, point| {
        [0, 1].map(|c| {
            let ([low, high], x) = (bounds[c], point.pixel[c]);
            [low.min(x), high.max(x)]
        })
    })
}
