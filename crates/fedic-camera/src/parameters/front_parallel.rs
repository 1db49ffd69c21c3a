//! Parameters of the fronto-parallel view.

use super::parameter::Parameter;
use super::parametric::{Parametric, not_a_parameter};
use crate::{Camera, CameraError, FrontParallel, Resizable};

impl Parametric for FrontParallel {
    fn parameters(&self) -> Vec<Parameter> {
        vec![Parameter::U0, Parameter::V0, Parameter::Angle, Parameter::Scale]
    }

    fn parameter_jacobian(&self, point: [f64; 3], parameters: &[Parameter], columns: &mut [[f64; 2]]) {
        let ([u, v], [u0, v0]) = (self.project(point), self.origin());
        let [right, down] = [u - u0, v - v0];
        for (column, &parameter) in columns[..parameters.len()].iter_mut().zip(parameters) {
            *column = match parameter {
                Parameter::U0 => [1.0, 0.0],
                Parameter::V0 => [0.0, 1.0],
                Parameter::Angle => [down, -right],
                Parameter::Scale => [right / self.scale(), down / self.scale()],
                _ => [f64::NAN; 2],
            };
        }
    }

    fn perturbed(&self, steps: impl IntoIterator<Item = (Parameter, f64)>) -> Result<Self, CameraError> {
        let (mut origin, mut angle, mut scale) = (self.origin(), self.angle(), self.scale());
        for (parameter, step) in steps {
            *match parameter {
                Parameter::U0 => &mut origin[0],
                Parameter::V0 => &mut origin[1],
                Parameter::Angle => &mut angle,
                Parameter::Scale => &mut scale,
                _ => return Err(not_a_parameter(self, parameter)),
            } += step;
        }
        Ok(Self::new(scale, origin)?.with_angle(angle)?.resized(self.image_size()))
    }
}
