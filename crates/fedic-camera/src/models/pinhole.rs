//! The pinhole camera with skewed pixels and lens distortion (paper, Sect. 5.1).

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::batch::{project_each, project_each_with_jacobian};
use crate::lens::LensVisitor;
use crate::newton::Jacobian2;
use crate::{Camera, CameraError, Distortion, Lens, Resizable};

const ROTATION_TOLERANCE: f64 = 1e-6;
const IDENTITY: Jacobian2 = [[1.0, 0.0], [0.0, 1.0]];

/// Rigid motion (paper, eq. 20), canonical projection (24), distortion (27) and intrinsic matrix with skew (22, 25).
///
/// The camera frame is OpenCV's: `x` right, `y` down, `z` forward, `X_c = R X_w + t`. The canonical projection
/// `(X_c / Z_c, Y_c / Z_c)` gives the normalised image coordinates ("retinal" in the paper), on which the lens acts. A
/// distorted point `(x, y)` has the pixel `u = fx x + fx cot(theta) y + cx`, `v = fy / sin(theta) y + cy`, with `theta` the
/// angle between the pixel axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Pinhole {
    focal: [f64; 2],
    principal_point: [f64; 2],
    rotation: [[f64; 3]; 3],
    translation: [f64; 3],
    skew_angle: f64,
    distortion: Option<Distortion>,
    image_size: Option<[u32; 2]>,
    /// `[[a, b], [0, c]]` of the intrinsic matrix, as `[a, b, c]`.
    pub(crate) intrinsic: [f64; 3],
}

/// Rotation matrix of a rotation vector, whose direction is the axis and whose length is the angle in radians (Rodrigues).
pub fn rotation_from_vector(vector: [f64; 3]) -> [[f64; 3]; 3] {
    let matrix = Rotation3::new(Vector3::from(vector)).into_inner();
    std::array::from_fn(|r| std::array::from_fn(|c| matrix[(r, c)]))
}

/// Entries of the intrinsic matrix; a right angle is exact, without the rounding of its tangent.
fn intrinsic([fx, fy]: [f64; 2], skew_angle: f64) -> [f64; 3] {
    if skew_angle == FRAC_PI_2 { [fx, 0.0, fy] } else { [fx, fx / skew_angle.tan(), fy / skew_angle.sin()] }
}

impl Pinhole {
    /// Creates a camera of focal lengths `[fx, fy]` and principal point `[cx, cy]`, in pixels, without skew or distortion.
    ///
    /// `rotation` (rows of the matrix) and `translation` (world unit) map world points to the camera frame.
    ///
    /// # Errors
    ///
    /// [`CameraError`] if a parameter is not finite, a focal length is not positive or the matrix is not a rotation.
    ///
    /// # Examples
    ///
    /// ```
    /// use fedic_camera::{Camera, Pinhole, rotation_from_vector};
    /// let upright = rotation_from_vector([std::f64::consts::PI, 0.0, 0.0]);
    /// let camera = Pinhole::new([1000.0, 1000.0], [500.0, 400.0], upright, [0.0, 0.0, 2.0])?;
    /// let [u, v] = camera.project([0.2, 0.1, 0.0]);
    /// assert!((u - 600.0).abs() < 1e-9 && (v - 350.0).abs() < 1e-9);
    /// # Ok::<(), fedic_camera::CameraError>(())
    /// ```
    pub fn new(
        focal: [f64; 2],
        principal_point: [f64; 2],
        rotation: [[f64; 3]; 3],
        translation: [f64; 3],
    ) -> Result<Self, CameraError> {
        let finite = [
            ("focal", focal.iter().all(|c| c.is_finite())),
            ("principal_point", principal_point.iter().all(|c| c.is_finite())),
            ("rotation", rotation.iter().flatten().all(|c| c.is_finite())),
            ("translation", translation.iter().all(|c| c.is_finite())),
        ];
        if let Some((parameter, _)) = finite.into_iter().find(|(_, finite)| !finite) {
            return Err(CameraError::NonFinite { parameter });
        }
        if let Some(value) = focal.into_iter().find(|&f| f <= 0.0) {
            return Err(CameraError::NotPositive { parameter: "focal length (pixels)", value });
        }
        let matrix = Matrix3::from_fn(|r, c| rotation[r][c]);
        let deviation =
            (matrix * matrix.transpose() - Matrix3::identity()).amax().max((matrix.determinant() - 1.0).abs());
        if deviation > ROTATION_TOLERANCE {
            return Err(CameraError::NotARotation { deviation });
        }
        let skew_angle = FRAC_PI_2;
        let intrinsic = intrinsic(focal, skew_angle);
        Ok(Self {
            focal,
            principal_point,
            rotation,
            translation,
            skew_angle,
            distortion: None,
            image_size: None,
            intrinsic,
        })
    }

    /// Sets the angle between the pixel axes, in radians.
    ///
    /// # Errors
    ///
    /// [`CameraError::SkewAngle`] if the angle is not between 0 and pi.
    pub fn with_skew_angle(mut self, skew_angle: f64) -> Result<Self, CameraError> {
        if !(skew_angle > 0.0 && skew_angle < std::f64::consts::PI) {
            return Err(CameraError::SkewAngle { value: skew_angle });
        }
        self.skew_angle = skew_angle;
        self.intrinsic = intrinsic(self.focal, skew_angle);
        Ok(self)
    }

    /// Sets the lens distortion.
    pub fn with_distortion(mut self, distortion: impl Into<Distortion>) -> Self {
        self.distortion = Some(distortion.into());
        self
    }

    /// Focal lengths `[fx, fy]` in pixels.
    pub fn focal(&self) -> [f64; 2] {
        self.focal
    }

    /// Principal point `[cx, cy]` in pixels.
    pub fn principal_point(&self) -> [f64; 2] {
        self.principal_point
    }

    /// Rows of the rotation matrix.
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        self.rotation
    }

    /// Translation, in the world unit.
    pub fn translation(&self) -> [f64; 3] {
        self.translation
    }

    /// Angle between the pixel axes, in radians.
    pub fn skew_angle(&self) -> f64 {
        self.skew_angle
    }

    /// Lens distortion, if any.
    pub fn distortion(&self) -> Option<&Distortion> {
        self.distortion.as_ref()
    }

    #[inline]
    pub(crate) fn in_camera_frame(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| {
            let r = &self.rotation[i];
            r[0] * x + r[1] * y + r[2] * z + self.translation[i]
        })
    }

    /// Normalised image coordinates and inverse depth; NaN for points behind the camera.
    #[inline]
    pub(crate) fn normalised(&self, point: [f64; 3]) -> ([f64; 2], f64) {
        let [x, y, z] = self.in_camera_frame(point);
        let inverse_depth = if z > 0.0 { 1.0 / z } else { f64::NAN };
        ([x * inverse_depth, y * inverse_depth], inverse_depth)
    }

    #[inline]
    fn pixel(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [a, b, c] = self.intrinsic;
        [a * x + b * y + self.principal_point[0], c * y + self.principal_point[1]]
    }

    /// Projects a world point through the given distortion.
    #[inline(always)]
    fn project_through(&self, distort: impl Fn([f64; 2]) -> [f64; 2], point: [f64; 3]) -> [f64; 2] {
        self.pixel(distort(self.normalised(point).0))
    }

    /// Projects a world point through the given distortion, with the Jacobian.
    #[inline(always)]
    fn project_through_with_jacobian(
        &self,
        distort: impl Fn([f64; 2]) -> ([f64; 2], Jacobian2),
        point: [f64; 3],
    ) -> ([f64; 2], [[f64; 3]; 2]) {
        let (normalised, inverse_depth) = self.normalised(point);
        let (distorted, lens) = distort(normalised);
        let [a, b, c] = self.intrinsic;
        let pixel_by_normalised =
            [[a * lens[0][0] + b * lens[1][0], a * lens[0][1] + b * lens[1][1]], [c * lens[1][0], c * lens[1][1]]];
        let r = &self.rotation;
        let normalised_by_world: [[f64; 3]; 2] =
            std::array::from_fn(|i| std::array::from_fn(|d| (r[i][d] - normalised[i] * r[2][d]) * inverse_depth));
        let jacobian = pixel_by_normalised
            .map(|[px, py]| std::array::from_fn(|d| px * normalised_by_world[0][d] + py * normalised_by_world[1][d]));
        (self.pixel(distorted), jacobian)
    }

    /// Not inlined, so that the compiler knows from the arguments that the outputs do not alias the camera.
    #[inline(never)]
    fn project_batch_through(
        &self,
        distort: impl Fn([f64; 2]) -> [f64; 2],
        points: [&[f64]; 3],
        u: &mut [f64],
        v: &mut [f64],
    ) {
        project_each(|point| self.project_through(&distort, point), points, [u, v]);
    }

    /// Not inlined for the same reason.
    #[inline(never)]
    fn project_batch_through_with_jacobian(
        &self,
        distort: impl Fn([f64; 2]) -> ([f64; 2], Jacobian2),
        points: [&[f64]; 3],
        u: &mut [f64],
        v: &mut [f64],
        jacobian: &mut [[&mut [f64]; 3]; 2],
    ) {
        let project = |point| self.project_through_with_jacobian(&distort, point);
        project_each_with_jacobian(project, points, [u, v], jacobian);
    }
}

/// Arguments of [`Camera::project_batch`] and [`Camera::project_with_jacobian_batch`], for one dispatch to the lens model.
struct Batch<'a, J> {
    camera: &'a Pinhole,
    points: [&'a [f64]; 3],
    pixels: [&'a mut [f64]; 2],
    jacobian: J,
}

impl LensVisitor for Batch<'_, ()> {
    type Output = ();

    #[inline]
    fn visit(self, lens: &impl Lens) {
        let Self { camera, points, pixels: [u, v], .. } = self;
        camera.project_batch_through(|at| lens.distort(at), points, u, v);
    }
}

impl LensVisitor for Batch<'_, &mut [[&mut [f64]; 3]; 2]> {
    type Output = ();

    #[inline]
    fn visit(self, lens: &impl Lens) {
        let Self { camera, points, pixels: [u, v], jacobian } = self;
        camera.project_batch_through_with_jacobian(|at| lens.distort_with_jacobian(at), points, u, v, jacobian);
    }
}

/// The lens acts on normalised image coordinates: it is the same for a region and for binned images.
impl Resizable for Pinhole {
    fn image_size(&self) -> Option<[u32; 2]> {
        self.image_size
    }

    fn resized(self, image_size: Option<[u32; 2]>) -> Self {
        Self { image_size, ..self }
    }

    fn resampled(&self, scale: f64, shift: [f64; 2]) -> Result<Self, CameraError> {
        let focal = self.focal.map(|f| scale * f);
        let principal_point = std::array::from_fn(|i| scale * self.principal_point[i] + shift[i]);
        let camera = Self::new(focal, principal_point, self.rotation, self.translation)?;
        let camera = camera.with_skew_angle(self.skew_angle)?.resized(self.image_size);
        Ok(Self { distortion: self.distortion.clone(), ..camera })
    }
}

impl Camera for Pinhole {
    #[inline]
    fn project(&self, point: [f64; 3]) -> [f64; 2] {
        match &self.distortion {
            Some(lens) => self.project_through(|at| lens.distort(at), point),
            None => self.project_through(|at| at, point),
        }
    }

    #[inline]
    fn project_with_jacobian(&self, point: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]) {
        match &self.distortion {
            Some(lens) => self.project_through_with_jacobian(|at| lens.distort_with_jacobian(at), point),
            None => self.project_through_with_jacobian(|at| (at, IDENTITY), point),
        }
    }

    fn project_batch(&self, x: &[f64], y: &[f64], z: &[f64], u: &mut [f64], v: &mut [f64]) {
        match &self.distortion {
            Some(lens) => lens.visit(Batch { camera: self, points: [x, y, z], pixels: [u, v], jacobian: () }),
            None => self.project_batch_through(|at| at, [x, y, z], u, v),
        }
    }

    fn project_with_jacobian_batch(
        &self,
        x: &[f64],
        y: &[f64],
        z: &[f64],
        u: &mut [f64],
        v: &mut [f64],
        jacobian: &mut [[&mut [f64]; 3]; 2],
    ) {
        match &self.distortion {
            Some(lens) => lens.visit(Batch { camera: self, points: [x, y, z], pixels: [u, v], jacobian }),
            None => self.project_batch_through_with_jacobian(|at| (at, IDENTITY), [x, y, z], u, v, jacobian),
        }
    }

    fn is_beyond_fold(&self, point: [f64; 3]) -> bool {
        self.distortion.as_ref().is_some_and(|lens| lens.folds_within(self.normalised(point).0))
    }

    fn covers(&self, point: [f64; 3]) -> bool {
        self.distortion.as_ref().is_none_or(|lens| lens.covers(self.normalised(point).0))
    }

    fn is_piecewise(&self) -> bool {
        self.distortion.as_ref().is_some_and(Distortion::is_piecewise)
    }

    fn unproject_linear(&self, [u, v]: [f64; 2], z: f64) -> [f64; 3] {
        let [a, b, c] = self.intrinsic;
        let y = (v - self.principal_point[1]) / c;
        let x = (u - self.principal_point[0] - b * y) / a;
        let r = &self.rotation;
        let to_world = |d: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| (0..3).map(|k| r[k][i] * d[k]).sum()) };
        let ray = to_world([x, y, 1.0]);
        let centre = to_world(self.translation).map(|c| -c);
        let along = (z - centre[2]) / ray[2];
        [centre[0] + along * ray[0], centre[1] + along * ray[1], z]
    }
}
