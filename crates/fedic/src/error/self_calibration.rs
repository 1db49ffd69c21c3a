//! Errors of the specimen calibration.

use thiserror::Error;

/// Error of a calibration on images of the specimen.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum SelfCalibrationError {
    /// There are fewer than two images, or their number and that of the translations do not agree.
    #[error("a camera is calibrated on a reference image and at least one image of the moved specimen: {found}")]
    Images {
        /// The images and translations given.
        found: String,
    },
    /// No parameter is given, or one is given twice.
    #[error("name each unknown camera parameter once: {found}")]
    Parameters {
        /// The parameters given.
        found: String,
    },
    /// An image shows no part of the specimen that another image shows.
    #[error(
        "{} shows no part of the mesh that another image shows: check the mesh, the camera and the approximate translations",
        image_name(*image)
    )]
    Unseen {
        /// Index of the image; 0 is the reference image.
        image: usize,
    },
    /// The grey levels of an image differ from those of the others.
    #[error(
        "{} does not match the others: at the estimated motion its grey levels differ from theirs by {residual:.3}, and the \
         texture has a standard deviation of {texture:.3}; give approximate translations, or leave the image out",
        image_name(*image)
    )]
    Unmatched {
        /// Index of the image; 0 is the reference image.
        image: usize,
        /// Standard deviation of the residual in that image.
        residual: f64,
        /// Standard deviation of the grey levels.
        texture: f64,
    },
    /// The specimen has not moved.
    #[error(
        "the specimen moves by no more than {largest:.2} pixels between the images, which is too little to determine the \
         camera: move it by a tenth of the field of view or more, in at least two directions"
    )]
    NoMotion {
        /// Largest displacement in the images, in pixels.
        largest: f64,
    },
    /// The images do not determine some unknowns.
    #[error(
        "{}; {advice}",
        match names.as_slice() {
            [name] => format!("the images do not determine {name}"),
            _ => format!("the images do not tell {} apart: their effects cancel", names.join(", ")),
        }
    )]
    Undetermined {
        /// The unknowns, such as `cx`.
        names: Vec<String>,
        /// How to make them determinate.
        advice: &'static str,
    },
}

/// Name of an image in messages.
pub(crate) fn image_name(image: usize) -> String {
    if image == 0 { "the reference image".to_owned() } else { format!("moved image number {image} (from 1)") }
}
