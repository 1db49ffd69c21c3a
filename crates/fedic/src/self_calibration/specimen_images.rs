//! Input of a specimen calibration.

use fedic_camera::{Parameter, Parametric, Pinhole};
use fedic_image::ImageView;
use fedic_mesh::Mesh;

use crate::error::Error;
use crate::error::self_calibration::SelfCalibrationError;

/// Images of a specimen at rest and after rigid motions, and the camera to refine.
#[derive(Clone, Copy)]
pub struct SpecimenImages<'a> {
    /// Images of equal size: the reference image, followed by those of the moved specimen.
    pub images: &'a [ImageView<'a>],
    /// Mesh in the plane of the specimen, as it lies in the reference image.
    pub mesh: &'a Mesh,
    /// Initial values of the unknown parameters, and the values of all others.
    pub camera: &'a Pinhole,
    /// Unknown parameters.
    pub parameters: &'a [Parameter],
    /// Approximate translation of the specimen along `X` and `Y` in each moved image, in the unit of the mesh.
    pub translations: &'a [[f64; 2]],
}

impl SpecimenImages<'_> {
    /// Checks that the input is complete and consistent.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let Self { images, camera, parameters, translations, .. } = self;
        let finite = translations.iter().flatten().all(|t| t.is_finite());
        if images.len() < 2 || translations.len() + 1 != images.len() || !finite {
            let kind = if finite { "" } else { ", not all finite" };
            let found = format!("got {} images and {} translations{kind}", images.len(), translations.len());
            return Err(SelfCalibrationError::Images { found }.into());
        }
        let size = |image: &ImageView<'_>| [image.width(), image.height()];
        if let Some(other) = images.iter().find(|image| size(image) != size(&images[0])) {
            return Err(Error::SizeMismatch { reference: size(&images[0]), deformed: size(other) });
        }
        let mut named = parameters.iter().enumerate();
        if let Some((_, parameter)) = named.find(|(index, parameter)| parameters[..*index].contains(parameter)) {
            return Err(SelfCalibrationError::Parameters { found: format!("{parameter} is named twice") }.into());
        }
        if parameters.is_empty() {
            return Err(SelfCalibrationError::Parameters { found: "got none".to_owned() }.into());
        }
        camera.check_parameters(parameters)?;
        Ok(())
    }
}
