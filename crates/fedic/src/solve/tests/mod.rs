//! Tests of levels, starts, bases and sums of terms.

#![allow(clippy::unwrap_used)]

mod level;
mod smooth_field;
mod terms_and_bases;

use std::sync::Arc;

use fedic_camera::Camera;
use fedic_image::{Image, ImageView};

use crate::equations::dofs::Dofs;
use crate::interpolation::image_sampler::ImageSampler;
use crate::observation::observe::ObservationSettings;
use crate::solve::level::{Level, LevelSettings};
use crate::{Options, PLANE};

/// Settings of an observation of the default quadrature that must cover the mesh.
fn observation_settings(image: &Image) -> ObservationSettings {
    ObservationSettings {
        quadrature: Options::default().quadrature,
        size: [image.width(), image.height()],
        require_full_coverage: true,
        mask: None,
        cut_margin: None,
        saturation: None,
    }
}

/// An image prepared with the default options but this smoothing.
fn sampler(image: ImageView<'_>, smoothing: f64) -> ImageSampler {
    let options = Options::default();
    ImageSampler::new(image, options.interpolation, options.gradient, smoothing).unwrap()
}

/// A level of a reference image without penalty.
fn level(
    dofs: &Dofs<PLANE>,
    camera: Arc<dyn Camera>,
    reference: &Image,
    smoothing: f64,
    compact: bool,
) -> Level<PLANE> {
    let settings =
        LevelSettings { observation: observation_settings(reference), smoothing: None, filter: None, compact };
    Level::new(dofs, camera, sampler(reference.view(), smoothing), settings, &()).unwrap()
}
