//! Why a specimen did not calibrate a camera.

use thiserror::Error;

/// Images from which the camera cannot be found.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SelfCalibrationError {
    /// Fewer than two images, or not one start for each.
    #[error("a camera is calibrated on a reference image and at least one image of the specimen moved: {found}")]
    Images {
        /// What was given.
        found: String,
    },
    /// No parameter was asked for, or one twice.
    #[error("name each camera parameter to be found once: {found}")]
    Parameters {
        /// What was given.
        found: String,
    },
    /// An image shows none of the specimen that another one shows.
    #[error(
        "{} shows nothing of the mesh that the others show: check the mesh, the camera and the start of the motion",
        name(*image)
    )]
    Unseen {
        /// Its number; 0 is the reference image.
        image: usize,
    },
    /// The grey levels do not agree after all.
    #[error(
        "{} does not match the others: at the motion found its grey levels differ from theirs by {residual:.3} where the \
         texture itself has a standard deviation of {texture:.3}; give a start of the motion (translations), or leave the \
         image out",
        name(*image)
    )]
    Unmatched {
        /// Its number; 0 is the reference image.
        image: usize,
        /// Standard deviation of the residual in that image.
        residual: f64,
        /// Standard deviation of the grey levels.
        texture: f64,
    },
    /// The specimen has not moved.
    #[error(
        "the specimen moves by no more than {largest:.2} pixels between the images, which then say nothing of the \
         camera: move it by a tenth of the field of view or more, in at least two directions"
    )]
    NoMotion {
        /// Largest apparent motion, in pixels.
        largest: f64,
    },
    /// Some unknowns are not determined.
    #[error(
        "{}; {advice}",
        match names.as_slice() {
            [name] => format!("the images do not determine {name}"),
            _ => format!("the images do not tell {} apart: what one changes, the others undo", names.join(", ")),
        }
    )]
    Undetermined {
        /// The unknowns, such as `cx`.
        names: Vec<String>,
        /// What to do.
        advice: &'static str,
    },
}

/// What an image is called: the reference comes first.
pub(crate) fn name(image: usize) -> String {
    if image == 0 { "the reference image".to_owned() } else { format!("moved image number {image} (from 1)") }
}
