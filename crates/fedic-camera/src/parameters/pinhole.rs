//! Parameters of the pinhole camera and its lens.

use nalgebra::{Rotation3, Vector3};

use super::parameter::Parameter;
use super::parametric::{Parametric, not_a_parameter};
use crate::{BrownDistortion, CameraError, Distortion, Pinhole, Resizable};

/// The lens that stands for no lens: all its coefficients are zero.
static NO_DISTORTION: Distortion = Distortion::Brown(BrownDistortion::UNDISTORTED);

/// Index of a coefficient of a lens; beyond its coefficients if the lens does not have it.
fn coefficient_index(lens: &Distortion, name: &str) -> usize {
    lens.coefficient_names().position(|known| known == name).unwrap_or(usize::MAX)
}

/// A camera without a lens has the coefficients of [`BrownDistortion`], and gets that lens if one of them is modified.
impl Parametric for Pinhole {
    fn parameters(&self) -> Vec<Parameter> {
        let lens = self.distortion().unwrap_or(&NO_DISTORTION);
        let mut parameters = vec![Parameter::Fx, Parameter::Fy, Parameter::Cx, Parameter::Cy];
        parameters.extend(lens.coefficient_names().map(Parameter::Lens));
        parameters.extend([Parameter::Rx, Parameter::Ry, Parameter::Rz, Parameter::Tx, Parameter::Ty, Parameter::Tz]);
        parameters
    }

    fn parameter_jacobian(&self, point: [f64; 3], parameters: &[Parameter], columns: &mut [[f64; 2]]) {
        let ([x, y], inverse_depth) = self.normalised(point);
        let [a, b, c] = self.intrinsic;
        let lens = self.distortion().unwrap_or(&NO_DISTORTION);
        let (distorted, by_normalised) = match self.distortion() {
            Some(lens) => lens.distort_with_jacobian([x, y]),
            None => ([x, y], [[1.0, 0.0], [0.0, 1.0]]),
        };
        let to_pixel = |[x, y]: [f64; 2]| [a * x + b * y, c * y];
        // Change of the image point with the point in the camera frame.
        let by_position = |[dx, dy, dz]: [f64; 3]| {
            let [dx, dy] = [(dx - x * dz) * inverse_depth, (dy - y * dz) * inverse_depth];
            to_pixel([
                by_normalised[0][0] * dx + by_normalised[0][1] * dy,
                by_normalised[1][0] * dx + by_normalised[1][1] * dy,
            ])
        };
        let by_rotation = |axis: usize| {
            let t = self.translation();
            let [x, y, z] = self.in_camera_frame(point);
            let rotated = Vector3::new(x - t[0], y - t[1], z - t[2]);
            by_position(Vector3::ith_axis(axis).cross(&rotated).into())
        };
        for (column, &parameter) in columns[..parameters.len()].iter_mut().zip(parameters) {
            *column = match parameter {
                Parameter::Fx => [to_pixel(distorted)[0] / self.focal()[0], 0.0],
                Parameter::Fy => [0.0, to_pixel(distorted)[1] / self.focal()[1]],
                Parameter::Cx => [1.0, 0.0],
                Parameter::Cy => [0.0, 1.0],
                Parameter::Lens(name) => to_pixel(lens.coefficient_derivative([x, y], coefficient_index(lens, name))),
                Parameter::Rx => by_rotation(0),
                Parameter::Ry => by_rotation(1),
                Parameter::Rz => by_rotation(2),
                Parameter::Tx => by_position([1.0, 0.0, 0.0]),
                Parameter::Ty => by_position([0.0, 1.0, 0.0]),
                Parameter::Tz => by_position([0.0, 0.0, 1.0]),
                _ => [f64::NAN; 2],
            };
        }
    }

    fn perturbed(&self, steps: impl IntoIterator<Item = (Parameter, f64)>) -> Result<Self, CameraError> {
        let lens = self.distortion().unwrap_or(&NO_DISTORTION);
        let (mut coefficients, mut lens_is_perturbed) = (lens.coefficients().to_vec(), false);
        let (mut focal, mut centre) = (self.focal(), self.principal_point());
        let (mut rotation, mut translation) = ([0.0; 3], self.translation());
        for (parameter, step) in steps {
            *match parameter {
                Parameter::Fx => &mut focal[0],
                Parameter::Fy => &mut focal[1],
                Parameter::Cx => &mut centre[0],
                Parameter::Cy => &mut centre[1],
                Parameter::Lens(name) => {
                    lens_is_perturbed = true;
                    let coefficient = coefficients.get_mut(coefficient_index(lens, name));
                    coefficient.ok_or_else(|| not_a_parameter(self, parameter))?
                }
                Parameter::Rx => &mut rotation[0],
                Parameter::Ry => &mut rotation[1],
                Parameter::Rz => &mut rotation[2],
                Parameter::Tx => &mut translation[0],
                Parameter::Ty => &mut translation[1],
                Parameter::Tz => &mut translation[2],
                _ => return Err(not_a_parameter(self, parameter)),
            } += step;
        }
        let rotation = Rotation3::new(Vector3::from(rotation));
        let columns: [[f64; 3]; 3] =
            std::array::from_fn(|c| (rotation * Vector3::from(self.rotation().map(|row| row[c]))).into());
        let rotation = std::array::from_fn(|r| std::array::from_fn(|c| columns[c][r]));
        let perturbed = Self::new(focal, centre, rotation, translation)?.with_skew_angle(self.skew_angle())?;
        let perturbed = perturbed.resized(self.image_size());
        Ok(match self.distortion() {
            _ if lens_is_perturbed => perturbed.with_distortion(lens.with_coefficients(&coefficients)?),
            Some(lens) => perturbed.with_distortion(lens.clone()),
            None => perturbed,
        })
    }
}
