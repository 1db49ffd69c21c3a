//! Rendered images before they become grey levels.

/// Mean value of a texture over each pixel of an image.
#[derive(Debug, Clone, PartialEq)]
pub struct Rendering {
    width: usize,
    values: Vec<f64>,
}

impl Rendering {
    /// `values` row after row, `width` of them per row.
    pub(crate) fn new(width: usize, values: Vec<f64>) -> Self {
        Self { width, values }
    }

    /// Number of columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.values.len() / self.width
    }

    /// The means, pixel `(u, v)` at index `v * width + u`.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The means as an owned vector.
    #[must_use]
    pub fn into_values(self) -> Vec<f64> {
        self.values
    }
}
