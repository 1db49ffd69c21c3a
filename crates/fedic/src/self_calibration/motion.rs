//! Rigid motions of the specimen.

use nalgebra::{Rotation3, Vector3};

use crate::options::choices;

/// Number of components of a rigid motion: translation along `X, Y, Z` and rotation about them.
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
    /// Unknown components, as indices into a rigid motion.
    pub(crate) fn components(self) -> &'static [usize] {
        match self {
            Self::Translation => &[0, 1],
            Self::InPlane => &[0, 1, 5],
            Self::Spatial => &[0, 1, 2, 3, 4, 5],
        }
    }
}

/// Rigid motion `X -> C + R (X - C) + t` with the rotation centre `C`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    centre: Vector3<f64>,
    rotation: Rotation3<f64>,
    translation: Vector3<f64>,
}

impl Motion {
    /// A translation along `X` and `Y`; later rotations are about `centre`.
    pub(crate) fn translation(centre: [f64; 3], [x, y]: [f64; 2]) -> Self {
        Self { centre: centre.into(), rotation: Rotation3::identity(), translation: Vector3::new(x, y, 0.0) }
    }

    /// Position of a point after the motion.
    pub(crate) fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        (self.centre + self.rotation * (Vector3::from(point) - self.centre) + self.translation).into()
    }

    /// Derivative of the position of a moved point with respect to one component of the motion. Rotations are multiplied from
    /// the left.
    pub(crate) fn derivative(&self, component: usize, moved_point: [f64; 3]) -> [f64; 3] {
        if component < 3 {
            return Vector3::ith(component, 1.0).into();
        }
        let arm = Vector3::from(moved_point) - self.centre - self.translation;
        Vector3::ith(component - 3, 1.0).cross(&arm).into()
    }

    /// The motion after a step of some of its components.
    pub(crate) fn perturbed(&self, components: &[usize], steps: &[f64]) -> Self {
        let mut step = [0.0; RIGID];
        components.iter().zip(steps).for_each(|(&component, &s)| step[component] = s);
        let [x, y, z, rx, ry, rz] = step;
        Self {
            centre: self.centre,
            rotation: Rotation3::new(Vector3::new(rx, ry, rz)) * self.rotation,
            translation: self.translation + Vector3::new(x, y, z),
        }
    }

    /// Translation and rotation vector.
    pub(crate) fn to_array(self) -> [f64; RIGID] {
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

    fn motion(components: [f64; RIGID]) -> Motion {
        Motion::translation([0.3, -0.2, 0.1], [0.0; 2]).perturbed(&[0, 1, 2, 3, 4, 5], &components)
    }

    proptest! {
        #[test]
        fn derivatives_agree_with_finite_differences(components in uniform6(-0.5..0.5), point in uniform3(-1.0..1.0)) {
            let motion = motion(components);
            let moved = motion.apply(point);
            for component in 0..RIGID {
                let at = |step: f64| motion.perturbed(&[component], &[step]).apply(point);
                let (back, forward) = (at(-1e-4), at(1e-4));
                for d in 0..3 {
                    let numeric = (forward[d] - back[d]) / 2e-4;
                    prop_assert!((motion.derivative(component, moved)[d] - numeric).abs() < 1e-7);
                }
            }
        }

        #[test]
        fn components_round_trip(components in uniform6(-0.5..0.5)) {
            for (found, given) in motion(components).to_array().into_iter().zip(components) {
                prop_assert!((found - given).abs() < 1e-12);
            }
        }
    }
}
