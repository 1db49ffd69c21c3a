//! The parameters of a pinhole camera one by one, to estimate any of them.

use std::fmt;
use std::str::FromStr;

use nalgebra::{Rotation3, Vector3};

use crate::{BrownDistortion, CameraError, Distortion, Pinhole};

/// One number of a [`Pinhole`] and its [`BrownDistortion`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// Focal length along the columns, in pixels.
    Fx,
    /// Focal length along the rows, in pixels.
    Fy,
    /// Column of the principal point.
    Cx,
    /// Row of the principal point.
    Cy,
    /// First radial coefficient.
    K1,
    /// Second radial coefficient.
    K2,
    /// Third radial coefficient.
    K3,
    /// First decentering coefficient.
    D1,
    /// Second decentering coefficient.
    D2,
    /// First prismatic coefficient.
    P1,
    /// Second prismatic coefficient.
    P2,
    /// Rotation of the world about its origin and the camera's `x` axis, in radians, from where it is.
    Rx,
    /// The same about the camera's `y` axis.
    Ry,
    /// The same about the camera's `z` axis.
    Rz,
    /// Translation along the camera's `x` axis, in the world unit.
    Tx,
    /// Translation along the camera's `y` axis.
    Ty,
    /// Translation along the camera's `z` axis.
    Tz,
}

impl Parameter {
    /// All of them.
    pub const ALL: [Self; 17] = [
        Self::Fx,
        Self::Fy,
        Self::Cx,
        Self::Cy,
        Self::K1,
        Self::K2,
        Self::K3,
        Self::D1,
        Self::D2,
        Self::P1,
        Self::P2,
        Self::Rx,
        Self::Ry,
        Self::Rz,
        Self::Tx,
        Self::Ty,
        Self::Tz,
    ];

    /// Its name, such as `k1`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fx => "fx",
            Self::Fy => "fy",
            Self::Cx => "cx",
            Self::Cy => "cy",
            Self::K1 => "k1",
            Self::K2 => "k2",
            Self::K3 => "k3",
            Self::D1 => "d1",
            Self::D2 => "d2",
            Self::P1 => "p1",
            Self::P2 => "p2",
            Self::Rx => "rx",
            Self::Ry => "ry",
            Self::Rz => "rz",
            Self::Tx => "tx",
            Self::Ty => "ty",
            Self::Tz => "tz",
        }
    }

    /// Whether it belongs to the lens.
    fn is_of_lens(self) -> bool {
        matches!(self, Self::K1 | Self::K2 | Self::K3 | Self::D1 | Self::D2 | Self::P1 | Self::P2)
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

impl FromStr for Parameter {
    type Err = CameraError;

    fn from_str(name: &str) -> Result<Self, CameraError> {
        let found = Self::ALL.into_iter().find(|parameter| parameter.name() == name);
        found.ok_or_else(|| CameraError::UnknownParameter { name: name.to_owned() })
    }
}

impl Pinhole {
    /// Derivatives `(du, dv)` of the image point of `point` by each of the `parameters`: column after column of a 2 x n
    /// matrix. NaN where the camera cannot see the point.
    ///
    /// Those of the rotation are taken on the left, `R -> exp(d) R`: the parameters of [`moved_by`](Self::moved_by).
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{Parameter, Pinhole, rotation_from_vector};
    /// let upright = rotation_from_vector([0.0; 3]);
    /// let camera = Pinhole::new([1000.0, 1000.0], [500.0, 400.0], upright, [0.0, 0.0, 2.0])?;
    /// let mut columns = [[0.0; 2]; 2];
    /// camera.parameter_jacobian([1.0, 0.0, 0.0], &[Parameter::Cx, Parameter::K1], &mut columns);
    /// assert_eq!(columns, [[1.0, 0.0], [125.0, 0.0]]);
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    ///
    /// # Panics
    ///
    /// If there are fewer columns than parameters.
    pub fn parameter_jacobian(&self, point: [f64; 3], parameters: &[Parameter], columns: &mut [[f64; 2]]) {
        let ([x, y], inverse_depth) = self.retinal(point);
        let [a, b, c] = self.intrinsic;
        let (seen, lens) = match self.distortion() {
            Some(lens) => lens.distort_with_jacobian([x, y]),
            None => ([x, y], [[1.0, 0.0], [0.0, 1.0]]),
        };
        let to_pixel = |[x, y]: [f64; 2]| [a * x + b * y, c * y];
        // Of the image point by the point in the camera frame.
        let by_place = |[dx, dy, dz]: [f64; 3]| {
            let [dx, dy] = [(dx - x * dz) * inverse_depth, (dy - y * dz) * inverse_depth];
            to_pixel([lens[0][0] * dx + lens[0][1] * dy, lens[1][0] * dx + lens[1][1] * dy])
        };
        let turned = |axis: usize| {
            let t = self.translation();
            let [x, y, z] = self.in_camera_frame(point);
            let arm = Vector3::new(x - t[0], y - t[1], z - t[2]);
            by_place(Vector3::ith_axis(axis).cross(&arm).into())
        };
        let (r2, xy) = (x * x + y * y, x * y);
        for (column, parameter) in columns[..parameters.len()].iter_mut().zip(parameters) {
            *column = match parameter {
                Parameter::Fx => [to_pixel(seen)[0] / self.focal()[0], 0.0],
                Parameter::Fy => [0.0, to_pixel(seen)[1] / self.focal()[1]],
                Parameter::Cx => [1.0, 0.0],
                Parameter::Cy => [0.0, 1.0],
                Parameter::K1 => to_pixel([x * r2, y * r2]),
                Parameter::K2 => to_pixel([x * r2 * r2, y * r2 * r2]),
                Parameter::K3 => to_pixel([x * r2 * r2 * r2, y * r2 * r2 * r2]),
                Parameter::D1 => to_pixel([2.0 * xy, r2 + 2.0 * y * y]),
                Parameter::D2 => to_pixel([r2 + 2.0 * x * x, 2.0 * xy]),
                Parameter::P1 => to_pixel([r2, 0.0]),
                Parameter::P2 => to_pixel([0.0, r2]),
                Parameter::Rx => turned(0),
                Parameter::Ry => turned(1),
                Parameter::Rz => turned(2),
                Parameter::Tx => by_place([1.0, 0.0, 0.0]),
                Parameter::Ty => by_place([0.0, 1.0, 0.0]),
                Parameter::Tz => by_place([0.0, 0.0, 1.0]),
            };
        }
    }

    /// The camera whose `parameters` differ by `steps`. A camera without a lens gets one where a coefficient of a lens
    /// is among them.
    ///
    /// # Errors
    ///
    /// [`CameraError`] where the result is no camera: a focal length that is not positive, a number that is not finite, a
    /// coefficient of [`BrownDistortion`] beside another lens.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{BrownDistortion, Parameter, Pinhole, rotation_from_vector};
    /// let camera = Pinhole::new([1000.0; 2], [500.0, 400.0], rotation_from_vector([0.0; 3]), [0.0, 0.0, 2.0])?;
    /// let moved = camera.moved_by(&[Parameter::Cy, Parameter::K1], &[2.0, -0.1])?;
    /// assert_eq!(moved.principal_point(), [500.0, 402.0]);
    /// assert_eq!(moved.distortion(), Some(&BrownDistortion::new([-0.1, 0.0, 0.0], [0.0; 2], [0.0; 2])?.into()));
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    pub fn moved_by(&self, parameters: &[Parameter], steps: &[f64]) -> Result<Self, CameraError> {
        let coefficient = parameters.iter().find(|parameter| parameter.is_of_lens());
        if let (Some(coefficient), Some(Distortion::Spline(_) | Distortion::InverseSpline(_))) =
            (coefficient, self.distortion())
        {
            return Err(CameraError::NotOfThisLens { name: coefficient.name() });
        }
        let lens = self.distortion().and_then(Distortion::brown).copied().unwrap_or_default();
        let ([mut radial, mut turn], mut decentering, mut prism) =
            ([lens.radial(), [0.0; 3]], lens.decentering(), lens.prism());
        let (mut focal, mut centre, mut translation) = (self.focal(), self.principal_point(), self.translation());
        for (parameter, step) in parameters.iter().zip(steps) {
            *match parameter {
                Parameter::Fx => &mut focal[0],
                Parameter::Fy => &mut focal[1],
                Parameter::Cx => &mut centre[0],
                Parameter::Cy => &mut centre[1],
                Parameter::K1 => &mut radial[0],
                Parameter::K2 => &mut radial[1],
                Parameter::K3 => &mut radial[2],
                Parameter::D1 => &mut decentering[0],
                Parameter::D2 => &mut decentering[1],
                Parameter::P1 => &mut prism[0],
                Parameter::P2 => &mut prism[1],
                Parameter::Rx => &mut turn[0],
                Parameter::Ry => &mut turn[1],
                Parameter::Rz => &mut turn[2],
                Parameter::Tx => &mut translation[0],
                Parameter::Ty => &mut translation[1],
                Parameter::Tz => &mut translation[2],
            } += step;
        }
        let turn = Rotation3::new(Vector3::from(turn));
        let columns: [[f64; 3]; 3] =
            std::array::from_fn(|c| (turn * Vector3::from(self.rotation().map(|row| row[c]))).into());
        let rotation = std::array::from_fn(|r| std::array::from_fn(|c| columns[c][r]));
        let moved = Self::new(focal, centre, rotation, translation)?.with_skew_angle(self.skew_angle())?;
        Ok(match (self.distortion(), coefficient) {
            (None, None) => moved,
            (Some(lens), None) => moved.with_distortion(lens.clone()),
            (_, Some(_)) => moved.with_distortion(BrownDistortion::new(radial, decentering, prism)?),
        })
    }
}
