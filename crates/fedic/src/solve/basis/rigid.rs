//! Rigid-body motions.

use fedic_mesh::Mesh;
use nalgebra::{Rotation3, Vector3};

use crate::solve::basis::modes::Modes;

/// Translations and rotations: three parameters in the plane (`D = 2`), six in space (`D = 3`). Steps are finite rotations about the
/// centre of the displaced mesh, so that the field stays rigid at any angle.
pub(crate) struct RigidModes<const D: usize> {
    points: Vec<[f64; 3]>,
    /// Displaced nodes, relative to their centre.
    arms: Vec<Vector3<f64>>,
}

impl<const D: usize> RigidModes<D> {
    /// Motions of the nodes of a mesh.
    pub(crate) fn new(mesh: &Mesh) -> Self {
        Self { points: mesh.points().to_vec(), arms: Vec::new() }
    }

    /// Axis of the rotation of a parameter after the `D` translations: in the plane the normal.
    fn axis(rotation: usize) -> Vector3<f64> {
        let mut axis = Vector3::zeros();
        axis[if D == 2 { 2 } else { rotation }] = 1.0;
        axis
    }
}

impl<const D: usize> Modes<D> for RigidModes<D> {
    fn len(&self) -> usize {
        D + D * (D - 1) / 2
    }

    fn linearize(&mut self, displacement: &[[f64; D]]) {
        let displaced = self.points.iter().zip(displacement).map(|(point, u)| {
            let mut point = Vector3::from(*point);
            u.iter().enumerate().for_each(|(c, u)| point[c] += u);
            point
        });
        self.arms = displaced.collect();
        let centre = self.arms.iter().sum::<Vector3<f64>>() / self.arms.len() as f64;
        self.arms.iter_mut().for_each(|arm| *arm -= centre);
    }

    fn value(&self, node: usize, component: usize, parameter: usize) -> f64 {
        if parameter < D {
            return if parameter == component { 1.0 } else { 0.0 };
        }
        Self::axis(parameter - D).cross(&self.arms[node])[component]
    }

    fn increment(&self, node: usize, step: &[f64]) -> [f64; D] {
        let (translation, angles) = step.split_at(D);
        let vector = angles.iter().enumerate().map(|(k, angle)| *angle * Self::axis(k)).sum::<Vector3<f64>>();
        let arm = self.arms[node];
        let turned = Rotation3::new(vector) * arm - arm;
        std::array::from_fn(|c| translation[c] + turned[c])
    }
}
