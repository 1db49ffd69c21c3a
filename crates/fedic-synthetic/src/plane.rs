//! Planes in space, and a camera that sees points given by their coordinates in a plane.

use fedic_camera::Camera;

use crate::error::SyntheticError;
use crate::motion::RigidMotion;
use crate::vector::{along, cross, dot, subtract};

/// A plane in space with coordinates `(a, b)`: the points `origin + a axes[0] + b axes[1]`.
///
/// A texture is a function of `(a, b)`. Axes of length one that are orthogonal keep its lengths in the world's unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    origin: [f64; 3],
    axes: [[f64; 3]; 2],
    normal: [f64; 3],
    /// Dual basis of the axes: its products with a vector in the plane are the coordinates of the vector.
    duals: [[f64; 3]; 2],
}

impl Plane {
    /// The plane through `origin` spanned by `axes`.
    ///
    /// # Errors
    ///
    /// [`SyntheticError::InvalidPlane`] if a number is not finite or the axes are parallel.
    pub fn new(origin: [f64; 3], axes: [[f64; 3]; 2]) -> Result<Self, SyntheticError> {
        let normal = cross(axes[0], axes[1]);
        let length = dot(normal, normal).sqrt();
        let normal = normal.map(|c| c / length);
        let duals = [cross(axes[1], normal), cross(normal, axes[0])].map(|dual| dual.map(|c| c / length));
        let finite = |vector: &[f64; 3]| vector.iter().all(|c| c.is_finite());
        if finite(&origin) && axes.iter().chain(&duals).all(finite) {
            Ok(Self { origin, axes, normal, duals })
        } else {
            Err(SyntheticError::InvalidPlane { origin, axes })
        }
    }

    /// The plane `Z = z`, with the coordinates `(X, Y)`.
    ///
    /// # Errors
    ///
    /// [`SyntheticError::InvalidPlane`] if `z` is not finite.
    pub fn horizontal(z: f64) -> Result<Self, SyntheticError> {
        Self::new([0.0, 0.0, z], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    }

    /// The plane after a rigid motion: each point keeps its coordinates `(a, b)`.
    #[must_use]
    pub fn moved(&self, motion: &RigidMotion) -> Self {
        Self {
            origin: motion.apply(self.origin),
            axes: self.axes.map(|axis| motion.rotate(axis)),
            normal: motion.rotate(self.normal),
            duals: self.duals.map(|dual| motion.rotate(dual)),
        }
    }

    /// The point of space at coordinates `(a, b)`.
    #[must_use]
    pub fn point(&self, [a, b]: [f64; 2]) -> [f64; 3] {
        along(along(self.origin, a, self.axes[0]), b, self.axes[1])
    }

    /// Components of a vector along the two axes and along the unit normal.
    pub(crate) fn components(&self, vector: [f64; 3]) -> [f64; 3] {
        [self.duals[0], self.duals[1], self.normal].map(|dual| dot(dual, vector))
    }
}

/// A camera for points given by coordinates `(a, b, c)` relative to a plane, `c` along its unit normal: the functions of
/// [`fedic_camera`] for planes `Z = z` then serve any plane.
#[derive(Debug)]
pub(crate) struct PlaneCamera<'a> {
    pub(crate) camera: &'a dyn Camera,
    pub(crate) plane: Plane,
}

impl PlaneCamera<'_> {
    fn point(&self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        along(self.plane.point([a, b]), c, self.plane.normal)
    }
}

impl Camera for PlaneCamera<'_> {
    fn project(&self, point: [f64; 3]) -> [f64; 2] {
        self.camera.project(self.point(point))
    }

    fn project_with_jacobian(&self, point: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]) {
        let (pixel, jacobian) = self.camera.project_with_jacobian(self.point(point));
        let [e1, e2] = self.plane.axes;
        (pixel, jacobian.map(|row| [dot(row, e1), dot(row, e2), dot(row, self.plane.normal)]))
    }

    fn is_beyond_fold(&self, point: [f64; 3]) -> bool {
        self.camera.is_beyond_fold(self.point(point))
    }

    fn covers(&self, point: [f64; 3]) -> bool {
        self.camera.covers(self.point(point))
    }

    fn is_piecewise(&self) -> bool {
        self.camera.is_piecewise()
    }

    /// The camera gives points of its ray through the pixel at two values of `Z`; the ray is cut with the plane.
    fn unproject_linear(&self, pixel: [f64; 2], c: f64) -> [f64; 3] {
        let base = self.point([0.0, 0.0, c]);
        let first = self.camera.unproject_linear(pixel, base[2]);
        let gap = dot(self.plane.normal, subtract(base, first));
        let point = if gap == 0.0 {
            first
        } else {
            let ray = subtract(self.camera.unproject_linear(pixel, base[2] + 1.0), first);
            along(first, gap / dot(self.plane.normal, ray), ray)
        };
        let [a, b, _] = self.plane.components(subtract(point, base));
        // A ray in a plane Z = constant is not found that way: the search then starts at the plane's origin.
        if a.is_finite() && b.is_finite() { [a, b, c] } else { [0.0, 0.0, c] }
    }
}
