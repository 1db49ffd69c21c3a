//! Exact projection of the quadrature points of a cell, batch by batch.
//!
//! Every stage fills arrays by component, so that the next stage runs over contiguous numbers.

use std::ops::Range;

use fedic_camera::Camera;
use fedic_mesh::{CellType, MAX_NODES, shape_values_batch};

use crate::quadrature::cell_quadrature::CellQuadrature;

/// Points per batch.
pub(crate) const BATCH: usize = 64;
/// Arrays are filled up to a multiple of this many points.
const VECTOR: usize = 4;

/// One number per point of a batch.
type Lane = [f64; BATCH];

/// Scratch arrays of one thread: a batch of points and their projections.
pub(crate) struct PointwiseProjector {
    len: usize,
    padded: usize,
    pub(crate) xi: Lane,
    pub(crate) eta: Lane,
    shape: [f64; MAX_NODES * BATCH],
    position: [Lane; 3],
    pub(crate) pixel: [Lane; 2],
    jacobian: [[Lane; 3]; 2],
}

impl PointwiseProjector {
    pub(crate) fn new() -> Box<Self> {
        Box::new(Self {
            len: 0,
            padded: 0,
            xi: [0.0; BATCH],
            eta: [0.0; BATCH],
            shape: [0.0; MAX_NODES * BATCH],
            position: [[0.0; BATCH]; 3],
            pixel: [[0.0; BATCH]; 2],
            jacobian: [[[0.0; BATCH]; 3]; 2],
        })
    }

    /// Loads `len` points of a cell from its point `first` on, with their shape functions.
    pub(crate) fn load(
        &mut self,
        quadrature: &CellQuadrature,
        cell: usize,
        cell_type: CellType,
        first: usize,
        len: usize,
    ) {
        self.len = len;
        self.padded = len.next_multiple_of(VECTOR);
        let n = self.padded;
        quadrature.coordinates(cell, first, &mut self.xi[..n], &mut self.eta[..n]);
        shape_values_batch(cell_type, &self.xi[..n], &self.eta[..n], &mut self.shape);
    }

    /// Projects all points of a cell with these nodes, batch by batch. `use_batch` gets the batch and the points that it holds.
    pub(crate) fn for_each_batch(
        &mut self,
        quadrature: &CellQuadrature,
        (cell, cell_type): (usize, CellType),
        nodes: &[[f64; 3]],
        camera: &dyn Camera,
        mut use_batch: impl FnMut(&mut Self, Range<usize>),
    ) {
        let count = quadrature.range(cell).len();
        for first in (0..count).step_by(BATCH) {
            let points = first..count.min(first + BATCH);
            self.load(quadrature, cell, cell_type, first, points.len());
            self.project_with_jacobian(camera, nodes);
            use_batch(self, points);
        }
    }

    /// Interpolates the positions of the nodes.
    fn interpolate_positions(&mut self, nodes: &[[f64; 3]]) {
        let n = self.padded;
        for d in 0..3 {
            let position = &mut self.position[d][..n];
            position.fill(0.0);
            for (a, node) in nodes.iter().enumerate() {
                let shape = &self.shape[a * n..(a + 1) * n];
                for k in 0..n {
                    position[k] += shape[k] * node[d];
                }
            }
        }
    }

    /// Projects the points of a cell with these nodes into the image.
    pub(crate) fn project(&mut self, camera: &dyn Camera, nodes: &[[f64; 3]]) {
        self.interpolate_positions(nodes);
        let n = self.padded;
        let [x, y, z] = &self.position;
        let [u, v] = &mut self.pixel;
        camera.project_batch(&x[..n], &y[..n], &z[..n], &mut u[..n], &mut v[..n]);
    }

    /// Projects the points of a cell with these nodes into the image, with the camera's Jacobian.
    pub(crate) fn project_with_jacobian(&mut self, camera: &dyn Camera, nodes: &[[f64; 3]]) {
        if let Some(constant) = camera.constant_jacobian() {
            for (row, values) in self.jacobian.iter_mut().zip(constant) {
                for (entry, value) in row.iter_mut().zip(values) {
                    entry[..self.padded].fill(value);
                }
            }
            self.project(camera, nodes);
            return;
        }
        self.interpolate_positions(nodes);
        let n = self.padded;
        let [x, y, z] = &self.position;
        let [u, v] = &mut self.pixel;
        let mut jacobian = self.jacobian.each_mut().map(|row| row.each_mut().map(|entry| &mut entry[..n]));
        camera.project_with_jacobian_batch(&x[..n], &y[..n], &z[..n], &mut u[..n], &mut v[..n], &mut jacobian);
    }

    /// Image coordinates of the points of the batch.
    pub(crate) fn pixels(&self) -> [&[f64]; 2] {
        self.pixel.each_ref().map(|c| &c[..self.len])
    }

    /// Number of points of the batch.
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// Reference coordinates of point `k`.
    pub(crate) fn coordinates(&self, k: usize) -> [f64; 2] {
        [self.xi[k], self.eta[k]]
    }

    /// Position of point `k`.
    pub(crate) fn position_at(&self, k: usize) -> [f64; 3] {
        self.position.each_ref().map(|c| c[k])
    }

    /// Image coordinates of point `k`.
    pub(crate) fn pixel_at(&self, k: usize) -> [f64; 2] {
        self.pixel.each_ref().map(|c| c[k])
    }

    /// Jacobian of the projection at point `k`.
    pub(crate) fn jacobian_at(&self, k: usize) -> [[f64; 3]; 2] {
        self.jacobian.each_ref().map(|row| row.each_ref().map(|entry| entry[k]))
    }

    /// Area in pixels, per area of the reference domain, of a cell whose map has the Jacobian `tangents` at point `k`.
    pub(crate) fn pixel_element(&self, k: usize, tangents: &[[f64; 2]; 3]) -> f64 {
        let [[a, b], [c, d]] = self.jacobian.each_ref().map(|row| {
            [0, 1].map(|t| row.iter().zip(tangents).map(|(entry, tangent)| entry[k] * tangent[t]).sum::<f64>())
        });
        (a * d - b * c).abs()
    }

    /// Component `c` of `q = J_P^T grad f` at point `k`.
    #[inline]
    pub(crate) fn project_gradient(&self, c: usize, k: usize, gradient: [f32; 2]) -> f64 {
        self.jacobian[0][c][k] * f64::from(gradient[0]) + self.jacobian[1][c][k] * f64::from(gradient[1])
    }
}
