//! An image prepared for the evaluation of grey levels and gradients at any point.

use fedic_image::{Image, ImageError, ImageView, Interpolation, Interpolator, central_differences, gaussian_filter};

use crate::Gradient;

/// An image, smoothed if asked, with its interpolant and the gradient of the chosen kind.
#[derive(Debug, Clone)]
pub struct ImageSampler {
    value: Interpolator,
    differences: Option<[Interpolator; 2]>,
}

impl ImageSampler {
    /// Prepares an image; `smoothing` is the standard deviation in pixels of a Gaussian filter, 0 for none.
    ///
    /// # Errors
    ///
    /// [`ImageError`] where the filter is wider than the image.
    pub fn new(
        view: ImageView<'_>,
        interpolation: Interpolation,
        gradient: Gradient,
        smoothing: f64,
    ) -> Result<Self, ImageError> {
        let differences = match gradient {
            Gradient::Analytic => None,
            Gradient::FiniteDifference => {
                let filtered = filter(view, smoothing)?;
                let view = filtered.as_ref().map_or(view, Image::view);
                let (along_u, along_v) = central_differences(view);
                Some([
                    Interpolator::new(along_u.view(), interpolation),
                    Interpolator::new(along_v.view(), interpolation),
                ])
            }
        };
        Ok(Self { value: Interpolator::smoothed(view, interpolation, smoothing)?, differences })
    }

    /// Prepares an image smoothed twice.
    pub(crate) fn smoothed_twice(
        view: ImageView<'_>,
        interpolation: Interpolation,
        gradient: Gradient,
        smoothing: f64,
    ) -> Result<Self, ImageError> {
        let filtered = filter(view, smoothing)?;
        Self::new(filtered.as_ref().map_or(view, Image::view), interpolation, gradient, smoothing)
    }

    /// The interpolant of the grey levels.
    pub(crate) fn interpolator(&self) -> &Interpolator {
        &self.value
    }

    /// Grey levels and gradients `(d/du, d/dv)` at image points; NaN outside the image.
    ///
    /// # Panics
    ///
    /// If the slices differ in length.
    pub fn values_and_gradients(&self, u: &[f64], v: &[f64], value: &mut [f32], gradient: [&mut [f32]; 2]) {
        let [along_u, along_v] = gradient;
        match &self.differences {
            None => self.value.values_and_gradients(u, v, value, along_u, along_v),
            Some([differences_u, differences_v]) => {
                self.value.values(u, v, value);
                differences_u.values(u, v, along_u);
                differences_v.values(u, v, along_v);
            }
        }
    }

    /// Grey levels and gradients at points given relative to the pixel `origin`; NaN outside the image.
    pub(crate) fn values_and_gradients_near(
        &self,
        origin: [isize; 2],
        u: &[f32],
        v: &[f32],
        value: &mut [f32],
        gradient: [&mut [f32]; 2],
    ) {
        let [along_u, along_v] = gradient;
        match &self.differences {
            None => self.value.values_and_gradients_near(origin, u, v, value, along_u, along_v),
            Some([differences_u, differences_v]) => {
                self.value.values_near(origin, u, v, value);
                differences_u.values_near(origin, u, v, along_u);
                differences_v.values_near(origin, u, v, along_v);
            }
        }
    }
}

fn filter(view: ImageView<'_>, smoothing: f64) -> Result<Option<Image>, ImageError> {
    if smoothing > 0.0 { gaussian_filter(view, smoothing).map(Some) } else { Ok(None) }
}
