//! Linear elasticity in plane stress.

use nalgebra::Matrix3;

use super::error::OptionError;

/// Law of linear elasticity in plane stress, for the components `(xx, yy, xy)` of the stress and of the strain, whose shear is
/// `2 eps_xy`.
///
/// # Examples
///
/// ```
/// use fedic::PlaneStress;
///
/// let steel = PlaneStress::isotropic(0.3)?;
/// let ply = PlaneStress::orthotropic(140e3, 10e3, 0.3, 5e3, 45_f64.to_radians())?;
/// assert!(PlaneStress::isotropic(0.6).is_err());
/// # Ok::<(), fedic::OptionError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneStress {
    stiffness: Matrix3<f64>,
}

impl PlaneStress {
    /// An isotropic law of Poisson's ratio `nu`. Its Young's modulus is one.
    ///
    /// # Errors
    ///
    /// [`OptionError::Invalid`] unless `nu` is greater than -1 and at most 0.5.
    pub fn isotropic(nu: f64) -> Result<Self, OptionError> {
        // Also false for a NaN.
        if !(nu > -1.0 && nu <= 0.5) {
            return Err(OptionError::invalid("nu", "greater than -1 and at most 0.5", &nu));
        }
        Ok(Self::in_axes(1.0, 1.0, nu, 0.5 / (1.0 + nu)))
    }

    /// An orthotropic law: Young's moduli `E1` and `E2`, `nu12 = -eps_2 / eps_1` under a stress along axis 1, and the shear modulus
    /// `G12`, in any unit. `angle` is that from the axis `x` to axis 1, in radians.
    ///
    /// # Errors
    ///
    /// [`OptionError::Invalid`] if a modulus is not positive, `nu12^2` is not less than `E1 / E2`, or the angle is not finite.
    pub fn orthotropic(e1: f64, e2: f64, nu12: f64, g12: f64, angle: f64) -> Result<Self, OptionError> {
        for (name, modulus) in [("E1", e1), ("E2", e2), ("G12", g12)] {
            if !(modulus > 0.0 && modulus.is_finite()) {
                return Err(OptionError::invalid(name, "a positive modulus", &modulus));
            }
        }
        let largest = (e1 / e2).sqrt();
        if nu12.is_nan() || nu12.abs() >= largest {
            let expected = format!("less than the square root of E1 / E2, {largest:.4}, in size");
            return Err(OptionError::invalid("nu12", expected, &nu12));
        }
        if !angle.is_finite() {
            return Err(OptionError::invalid("angle", "a finite angle in radians", &angle));
        }
        // In units of the largest modulus: the square of the stiffness matrix must not overflow.
        let unit = e1.max(e2).max(g12);
        Ok(Self::in_axes(e1 / unit, e2 / unit, nu12, g12 / unit).turned(angle))
    }

    /// Matrix of the law, up to a factor.
    pub(crate) fn stiffness(&self) -> &Matrix3<f64> {
        &self.stiffness
    }

    fn in_axes(e1: f64, e2: f64, nu12: f64, g12: f64) -> Self {
        let nu21 = nu12 * e2 / e1;
        let [q1, q2] = [e1, e2].map(|e| e / (1.0 - nu12 * nu21));
        let stiffness = Matrix3::new(q1, nu12 * q2, 0.0, nu12 * q2, q2, 0.0, 0.0, 0.0, g12);
        Self { stiffness }
    }

    /// The law in the axes `x` and `y`, axis 1 being at an angle to `x`.
    fn turned(&self, angle: f64) -> Self {
        let (s, c) = angle.sin_cos();
        let strain = Matrix3::new(c * c, s * s, c * s, s * s, c * c, -c * s, -2.0 * c * s, 2.0 * c * s, c * c - s * s);
        Self { stiffness: strain.transpose() * self.stiffness * strain }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use nalgebra::Vector3;
    use proptest::prelude::*;

    use super::*;

    fn option_of(result: Result<PlaneStress, OptionError>) -> &'static str {
        match result.unwrap_err() {
            OptionError::Invalid { option, .. } => option,
            OptionError::Unknown { .. } => "",
        }
    }

    #[test]
    fn moduli_that_are_not_positive_definite_are_refused_by_name() {
        for nu in [-1.0, 0.51, f64::NAN] {
            assert_eq!(option_of(PlaneStress::isotropic(nu)), "nu");
        }
        assert_eq!(option_of(PlaneStress::orthotropic(0.0, 1.0, 0.0, 1.0, 0.0)), "E1");
        assert_eq!(option_of(PlaneStress::orthotropic(1.0, -1.0, 0.0, 1.0, 0.0)), "E2");
        assert_eq!(option_of(PlaneStress::orthotropic(1.0, 1.0, 0.0, f64::INFINITY, 0.0)), "G12");
        assert_eq!(option_of(PlaneStress::orthotropic(1.0, 4.0, 0.5, 1.0, 0.0)), "nu12");
        assert_eq!(option_of(PlaneStress::orthotropic(4.0, 1.0, f64::NAN, 1.0, 0.0)), "nu12");
        assert_eq!(option_of(PlaneStress::orthotropic(1.0, 1.0, 0.0, 1.0, f64::NAN)), "angle");
        assert!(PlaneStress::orthotropic(4.0, 1.0, 1.9, 1.0, 0.0).is_ok());
    }

    #[test]
    fn a_stress_along_axis_1_gives_the_strains_that_define_the_moduli() {
        // The strains along axis 1 and across, by the transformation of a tensor.
        let (e1, e2, nu12, g12, angle) = (100.0, 40.0, 0.35, 25.0, 0.6_f64);
        let law = PlaneStress::orthotropic(e1, e2, nu12, g12, angle).unwrap();
        let compliance = law.stiffness().try_inverse().unwrap() / 100.0;
        let (s, c) = angle.sin_cos();
        let strain = compliance * Vector3::new(c * c, s * s, c * s);
        let along = c * c * strain.x + s * s * strain.y + c * s * strain.z;
        let across = s * s * strain.x + c * c * strain.y - c * s * strain.z;
        assert!((along - 1.0 / e1).abs() < 1e-14 && (across + nu12 / e1).abs() < 1e-14);
        let sheared = compliance * Vector3::new(-2.0 * c * s, 2.0 * c * s, c * c - s * s);
        let shear = -2.0 * c * s * sheared.x + 2.0 * c * s * sheared.y + (c * c - s * s) * sheared.z;
        assert!((shear - 1.0 / g12).abs() < 1e-14);
    }

    proptest! {
        #[test]
        fn isotropic_moduli_do_not_depend_on_the_angle(nu in -0.9..0.5_f64, angle in -4.0..4.0_f64) {
            let law = PlaneStress::isotropic(nu).unwrap();
            let turned = PlaneStress::orthotropic(1.0, 1.0, nu, 0.5 / (1.0 + nu), angle).unwrap();
            let unit = 1.0_f64.max(0.5 / (1.0 + nu));
            prop_assert!((turned.stiffness * unit - law.stiffness).abs().max() < 1e-13 * law.stiffness.max());
        }
    }
}
