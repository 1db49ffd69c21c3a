//! Images that a correlator keeps for later use.

use fedic_image::{Image, ImageView};

use crate::Error;

/// An image that can be viewed again at any time.
///
/// A correlator keeps its reference image this way: reduced images, residual maps and standard deviations need the pixels again.
/// The pixels must not change.
pub trait ImageSource: Send + Sync {
    /// Calls `use_view` once with a view of the image.
    ///
    /// # Errors
    ///
    /// The reason, in words, why the pixels cannot be viewed any more.
    fn with_view(&self, use_view: &mut (dyn FnMut(ImageView<'_>) + Send)) -> Result<(), String>;
}

impl ImageSource for Image {
    fn with_view(&self, use_view: &mut (dyn FnMut(ImageView<'_>) + Send)) -> Result<(), String> {
        use_view(self.view());
        Ok(())
    }
}

/// Returns what `compute` makes of a view of an image.
pub(crate) fn view_of<T: Send>(
    source: &dyn ImageSource,
    compute: impl FnOnce(ImageView<'_>) -> T + Send,
) -> Result<T, Error> {
    let (mut compute, mut result) = (Some(compute), None);
    let viewed = source.with_view(&mut |view| {
        if let Some(compute) = compute.take() {
            result = Some(compute(view));
        }
    });
    let unavailable = |reason| Error::ReferenceUnavailable { reason };
    viewed.map_err(unavailable)?;
    result.ok_or_else(|| unavailable("its source gave no view".to_owned()))
}
