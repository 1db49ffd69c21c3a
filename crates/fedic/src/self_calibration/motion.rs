//! Rigid motions of the specimen.

use nalgebra::{Rotation3, Vector3};

use crate::options::choices;

/// Numbers of a rigid motion: translation along `X, Y, Z` and rotation about them.
pub const RIGID: usize = 6;

choices! {
    /// Rigid motions that the specimen may have made.
    pub enum MotionKind("motion") {
        /// Along `X` and `Y`.
        Translation = "translation",
        /// Along `X` and `Y`, and about `Z`.
        #[default]
        InPlane = "in-plane",
        /// Any, also those of a stage that leaves the plane.
        Spatial = "spatial",
    }
}

impl MotionKind {
    /// The numbers that are unknown, as indices into a rigid motion.
    pub(crate) fn components(self) -> &'static [usize] {
        match self {
            Self::Translation => &[0, 1],
            Self::InPlane => &[0, 1, 5],
            Self::Spatial => &[0, 1, 2, 3, 4, 5],
        }
    }
}

/// `X -> pivot + R (X - pivot) + t`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    pivot: Vector3<f64>,
    rotation: Rotation3<f64>,
    translation: Vector3<f64>,
}

impl Motion {
    pub(crate) fn translation(pivot: [f64; 3], [x, y]: [f64; 2]) -> Self {
        Self { pivot: pivot.into(), rotation: Rotation3::identity(), translation: Vector3::new(x, y, 0.0) }
    }

    pub(crate) fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        (self.pivot + self.rotation * (Vector3::from(point) - self.pivot) + self.translation).into()
    }

    /// A direction of the specimen after the motion.
    pub(crate) fn turn(&self, direction: [f64; 3]) -> [f64; 3] {
        (self.rotation * Vector3::from(direction)).into()
    }

    /// Derivative of the place where a point has arrived by one number of the motion; rotations are taken on the left.
    pub(crate) fn derivative(&self, component: usize, arrived: [f64; 3]) -> [f64; 3] {
        if component < 3 {
            return Vector3::ith(component, 1.0).into();
        }
        let arm = Vector3::from(arrived) - self.pivot - self.translation;
        Vector3::ith(component - 3, 1.0).cross(&arm).into()
    }

    /// The motion after a step of some of its numbers.
    pub(crate) fn moved_by(&self, components: &[usize], steps: &[f64]) -> Self {
        let mut whole = [0.0; RIGID];
        components.iter().zip(steps).for_each(|(&component, &step)| whole[component] = step);
        let [x, y, z, rx, ry, rz] = whole;
        Self {
            pivot: self.pivot,
            rotation: Rotation3::new(Vector3::new(rx, ry, rz)) * self.rotation,
            translation: self.translation + Vector3::new(x, y, z),
        }
    }

    /// Translation and rotation vector.
    pub(crate) fn numbers(&self) -> [f64; RIGID] {
        let ([x, y, z], [rx, ry, rz]): ([f64; 3], [f64; 3]) =
            (self.translation.into(), self.rotation.scaled_axis().into());
        [x, y, z, rx, ry, rz]
    }
}

#[cfg(test)]
mod tests {
    use proptest::array::{uniform3, uniform6};
    use proptest::prelude::*;

    use super::*;

    fn motion(numbers: [f64; RIGID]) -> Motion {
        Motion::translation([0.3, -0.2, 0.1], [0.0; 2]).moved_by(&[0, 1, 2, 3, 4, 5], &numbers)
    }

    proptest! {
        #[test]
        fn derivatives_are_those_of_a_step(numbers in uniform6(-0.5..0.5), point in uniform3(-1.0..1.0)) {
            let motion = motion(numbers);
            let arrived = motion.apply(point);
            for component in 0..RIGID {
                let at = |step: f64| motion.moved_by(&[component], &[step]).apply(point);
                let (back, forward) = (at(-1e-4), at(1e-4));
                for d in 0..3 {
                    let numeric = (forward[d] - back[d]) / 2e-4;
                    prop_assert!((motion.derivative(component, arrived)[d] - numeric).abs() < 1e-7);
                }
            }
        }

        #[test]
        fn numbers_are_read_back(numbers in uniform6(-0.5..0.5)) {
            for (found, given) in motion(numbers).numbers().into_iter().zip(numbers) {
                prop_assert!((found - given).abs() < 1e-12);
            }
        }
    }
}
