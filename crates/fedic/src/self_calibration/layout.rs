//! Order of the unknowns in the normal equations.

use std::ops::Range;

/// Numbers of unknowns: the parameters of the camera come first, followed by one block for each moved image, which holds the
/// components of its motion and then its gain and offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Layout {
    pub(crate) parameters: usize,
    pub(crate) motion: usize,
    /// 2, or 0 without brightness correction.
    pub(crate) brightness: usize,
    /// Number of images, including the reference image.
    pub(crate) images: usize,
}

impl Layout {
    /// Number of unknowns of one moved image.
    pub(crate) fn block_len(&self) -> usize {
        self.motion + self.brightness
    }

    /// Number of unknowns.
    pub(crate) fn len(&self) -> usize {
        self.parameters + (self.images - 1) * self.block_len()
    }

    /// Unknowns of a moved image.
    pub(crate) fn block(&self, image: usize) -> Range<usize> {
        let first = self.parameters + (image - 1) * self.block_len();
        first..first + self.block_len()
    }
}
