//! The interface of cameras with parameters.

use super::parameter::Parameter;
use crate::{Camera, CameraError};

/// A camera whose parameters can be estimated.
pub trait Parametric: Camera + Sized {
    /// The parameters of this camera.
    fn parameters(&self) -> Vec<Parameter>;

    /// Derivatives `(du, dv)` of the image point of `point` with respect to each of the `parameters`, one column each; NaN
    /// if the camera cannot see the point, or does not have the parameter (see [`check_parameters`]).
    ///
    /// The derivatives belong to the steps of [`perturbed`](Self::perturbed).
    ///
    /// [`check_parameters`]: Self::check_parameters
    ///
    /// # Panics
    ///
    /// If there are fewer columns than parameters.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{Parameter, Parametric, Pinhole, rotation_from_vector};
    /// let upright = rotation_from_vector([0.0; 3]);
    /// let camera = Pinhole::new([1000.0, 1000.0], [500.0, 400.0], upright, [0.0, 0.0, 2.0])?;
    /// let mut columns = [[0.0; 2]; 2];
    /// camera.parameter_jacobian([1.0, 0.0, 0.0], &[Parameter::Cx, Parameter::Lens("k1")], &mut columns);
    /// assert_eq!(columns, [[1.0, 0.0], [125.0, 0.0]]);
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    fn parameter_jacobian(&self, point: [f64; 3], parameters: &[Parameter], columns: &mut [[f64; 2]]);

    /// The camera with a step added to each of some parameters.
    ///
    /// Rotations multiply from the left, `R -> exp(d) R`: their parameters are zero at the present pose.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if the camera does not have one of the parameters, or the result is not a valid camera: a focal
    /// length that is not positive, a number that is not finite.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{BrownDistortion, Parameter, Parametric, Pinhole, rotation_from_vector};
    /// let camera = Pinhole::new([1000.0; 2], [500.0, 400.0], rotation_from_vector([0.0; 3]), [0.0, 0.0, 2.0])?;
    /// let perturbed = camera.perturbed([(Parameter::Cy, 2.0), (Parameter::Lens("k1"), -0.1)])?;
    /// assert_eq!(perturbed.principal_point(), [500.0, 402.0]);
    /// assert_eq!(perturbed.distortion(), Some(&BrownDistortion::new([-0.1, 0.0, 0.0], [0.0; 2], [0.0; 2])?.into()));
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    fn perturbed(&self, steps: impl IntoIterator<Item = (Parameter, f64)>) -> Result<Self, CameraError>;

    /// Checks that the camera has all of the parameters.
    ///
    /// # Errors
    ///
    /// [`CameraError::NotAParameter`] for the first that it does not have.
    fn check_parameters(&self, parameters: &[Parameter]) -> Result<(), CameraError> {
        let own = self.parameters();
        match parameters.iter().find(|parameter| !own.contains(parameter)) {
            Some(&parameter) => Err(not_a_parameter(self, parameter)),
            None => Ok(()),
        }
    }
}

/// The error for a parameter that a camera does not have.
pub(super) fn not_a_parameter<C: Parametric>(camera: &C, parameter: Parameter) -> CameraError {
    let known = camera.parameters().into_iter().map(Parameter::name).collect();
    CameraError::NotAParameter { name: parameter.name(), known }
}
