//! Regions in which a lens is calibrated.

/// Points per side of the border of a domain that is mapped to the other plane.
const BORDER_SAMPLES: usize = 64;

/// The plane of a domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    /// Normalised image coordinates without distortion.
    Undistorted,
    /// Distorted normalised image coordinates.
    Distorted,
}

/// A rectangle in which a lens is calibrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Domain {
    /// `[x0, y0, x1, y1]`.
    pub rectangle: [f64; 4],
    /// The plane in which the rectangle lies.
    pub plane: Plane,
}

impl Domain {
    /// Returns `true` if the domain contains an undistorted point, of which `distort` gives the distorted one.
    pub(super) fn contains(&self, point: [f64; 2], distort: impl Fn([f64; 2]) -> [f64; 2]) -> bool {
        let [x, y] = match self.plane {
            Plane::Undistorted => point,
            Plane::Distorted => distort(point),
        };
        let [x0, y0, x1, y1] = self.rectangle;
        (x0..=x1).contains(&x) && (y0..=y1).contains(&y)
    }

    /// Bounding box `[x0, y0, x1, y1]` of the image of the domain under a map; `None` if a point of the border has no image.
    pub(super) fn bounding_box_of(&self, map: impl Fn([f64; 2]) -> Option<[f64; 2]>) -> Option<[f64; 4]> {
        let [x0, y0, x1, y1] = self.rectangle;
        let mut bounds = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
        for k in 0..=BORDER_SAMPLES {
            let part = k as f64 / BORDER_SAMPLES as f64;
            let (x, y) = (x0 + part * (x1 - x0), y0 + part * (y1 - y0));
            for point in [[x, y0], [x, y1], [x0, y], [x1, y]] {
                let [x, y] = map(point)?;
                bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x), bounds[3].max(y)];
            }
        }
        Some(bounds)
    }
}
