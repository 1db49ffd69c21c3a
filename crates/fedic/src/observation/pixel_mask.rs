//! Pixels of the reference image that are left out of a measurement.

/// A set of pixels of an image.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PixelMask {
    width: usize,
    height: usize,
    /// Whether each pixel is left out, row after row.
    masked: Vec<bool>,
}

impl PixelMask {
    /// A mask of `width` columns; `masked` holds whole rows.
    pub(crate) fn new(width: usize, masked: Vec<bool>) -> Self {
        Self { width, height: masked.len() / width.max(1), masked }
    }

    /// The mask grown by a square of this half width, in pixels.
    pub(crate) fn dilated(&self, radius: usize) -> Self {
        let rows = self.masked.chunks(self.width.max(1)).flat_map(|row| spread(row, radius)).collect();
        let transposed = Self { masked: rows, ..*self }.transposed();
        let columns = transposed.masked.chunks(self.height.max(1)).flat_map(|row| spread(row, radius)).collect();
        Self { masked: columns, ..transposed }.transposed()
    }

    /// The pixels around which a square of this half width is masked.
    pub(crate) fn eroded(&self, radius: usize) -> Self {
        let inverted = |mask: Self| Self { masked: mask.masked.iter().map(|masked| !masked).collect(), ..mask };
        inverted(inverted(self.clone()).dilated(radius))
    }

    /// The mask of an image reduced to half its size: a pixel is masked if one of its four is.
    pub(crate) fn reduced(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let of_four = |k: usize| {
            let (u, v) = (2 * (k % width), 2 * (k / width));
            [(u, v), (u + 1, v), (u, v + 1), (u + 1, v + 1)].iter().any(|&(u, v)| self.masked[v * self.width + u])
        };
        Self { width, height, masked: (0..width * height).map(of_four).collect() }
    }

    /// Whether the pixel nearest to an image point is masked.
    pub(crate) fn covers(&self, u: f64, v: f64) -> bool {
        let (u, v) = (u.round(), v.round());
        let inside = u >= 0.0 && v >= 0.0 && u < self.width as f64 && v < self.height as f64;
        inside && self.masked[v as usize * self.width + u as usize]
    }

    /// Whether a pixel within a rectangle is masked; `low` and `high` are its corners `(u, v)`.
    pub(crate) fn touches(&self, low: [f64; 2], high: [f64; 2]) -> bool {
        let limits = |axis: usize, size: usize| {
            let first = low[axis].floor().max(0.0) as usize;
            first..(high[axis].ceil().max(-1.0) + 1.0).min(size as f64) as usize
        };
        let (columns, rows) = (limits(0, self.width), limits(1, self.height));
        if columns.is_empty() {
            return false;
        }
        rows.into_iter().any(|v| self.masked[v * self.width..][columns.clone()].contains(&true))
    }

    /// Indices of the masked pixels.
    pub(crate) fn indices(&self) -> impl Iterator<Item = usize> {
        self.masked.iter().enumerate().filter(|(_, masked)| **masked).map(|(pixel, _)| pixel)
    }

    fn transposed(&self) -> Self {
        let masked = (0..self.masked.len()).map(|k| self.masked[k % self.height * self.width + k / self.height]);
        Self { width: self.height, height: self.width, masked: masked.collect() }
    }
}

/// Spreads the masked pixels of a row over `radius` pixels to both sides.
fn spread(row: &[bool], radius: usize) -> Vec<bool> {
    let mut out = vec![false; row.len()];
    for (u, _) in row.iter().enumerate().filter(|(_, masked)| **masked) {
        let end = row.len().min(u + radius + 1);
        out[u.saturating_sub(radius)..end].fill(true);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one_pixel(width: usize, height: usize, u: usize, v: usize) -> PixelMask {
        let mut masked = vec![false; width * height];
        masked[v * width + u] = true;
        PixelMask::new(width, masked)
    }

    #[test]
    fn covers_the_pixels_nearest_to_a_point() {
        let mask = one_pixel(5, 4, 3, 1);
        assert!(mask.covers(3.4, 0.6) && mask.covers(2.6, 1.4));
        assert!(!mask.covers(3.6, 1.0) && !mask.covers(3.0, 1.6) && !mask.covers(-1.0, 1.0) && !mask.covers(9.0, 1.0));
    }

    #[test]
    fn touches_rectangles_that_hold_a_masked_pixel() {
        let mask = one_pixel(5, 4, 3, 1);
        assert!(mask.touches([2.0, 0.0], [3.0, 3.0]) && mask.touches([-9.0, -9.0], [9.0, 9.0]));
        assert!(!mask.touches([0.0, 0.0], [2.0, 3.0]) && !mask.touches([3.0, 2.0], [4.0, 3.0]));
        assert!(!mask.touches([20.0, 0.0], [30.0, 9.0]) && !mask.touches([-9.0, 0.0], [-5.0, 9.0]));
    }

    #[test]
    fn dilation_covers_a_square() {
        let mask = one_pixel(7, 6, 1, 3).dilated(2);
        for k in 0..7 * 6 {
            let (u, v) = (k % 7, k / 7);
            assert_eq!(mask.masked[k], u <= 3 && (1..=5).contains(&v), "({u}, {v})");
        }
    }

    #[test]
    fn erosion_undoes_dilation() {
        let mask = one_pixel(9, 8, 4, 3);
        assert_eq!(mask.dilated(2).eroded(2), mask);
        assert!(!mask.eroded(1).masked.contains(&true));
    }

    #[test]
    fn a_reduced_pixel_is_masked_if_one_of_four_is() {
        let mask = one_pixel(7, 4, 3, 2).reduced();
        assert_eq!((mask.width, mask.height), (3, 2));
        assert_eq!(mask.masked, [false, false, false, false, true, false]);
    }
}
