//! Rigid motions in space.

use fedic_camera::rotation_from_vector;

use crate::error::SyntheticError;
use crate::vector::{dot, subtract};

/// A rotation about a centre, followed by a translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RigidMotion {
    rotation: [[f64; 3]; 3],
    centre: [f64; 3],
    translation: [f64; 3],
}

impl RigidMotion {
    /// The motion `x = R (X - centre) + centre + translation`; the rotation vector is the axis times the angle in radians.
    ///
    /// # Errors
    ///
    /// [`SyntheticError::InvalidOption`] if a component is not finite.
    pub fn new(rotation_vector: [f64; 3], centre: [f64; 3], translation: [f64; 3]) -> Result<Self, SyntheticError> {
        for (option, vector) in [("rotation_vector", rotation_vector), ("centre", centre), ("translation", translation)]
        {
            if !vector.iter().all(|c| c.is_finite()) {
                let value = format!("{vector:?}");
                return Err(SyntheticError::InvalidOption { option, expected: "three finite numbers", value });
            }
        }
        Ok(Self { rotation: rotation_from_vector(rotation_vector), centre, translation })
    }

    /// Position of a material point after the motion.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let turned = self.rotate(subtract(point, self.centre));
        [0, 1, 2].map(|c| turned[c] + self.centre[c] + self.translation[c])
    }

    /// A direction after the motion.
    pub(crate) fn rotate(&self, direction: [f64; 3]) -> [f64; 3] {
        self.rotation.map(|row| dot(row, direction))
    }
}
