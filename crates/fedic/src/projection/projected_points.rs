//! Many points seen by the camera at once, which costs it less than one by one.

use fedic_camera::Camera;

/// Most points seen at once.
pub(crate) const MOST_SIGHTS: usize = 40;

/// Points, and then where the camera sees them.
pub(crate) struct Sights {
    place: [[f64; MOST_SIGHTS]; 3],
    pixel: [[f64; MOST_SIGHTS]; 2],
    jacobian: [[[f64; MOST_SIGHTS]; 3]; 2],
}

/// A point where it is, as the camera sees it.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sight {
    pub(crate) place: [f64; 3],
    pub(crate) pixel: [f64; 2],
    pub(crate) jacobian: [[f64; 3]; 2],
}

impl Sights {
    /// Sees up to [`MOST_SIGHTS`] points.
    pub(crate) fn new(camera: &dyn Camera, points: impl Iterator<Item = [f64; 3]>) -> Self {
        let mut sights = Self {
            place: [[0.0; MOST_SIGHTS]; 3],
            pixel: [[0.0; MOST_SIGHTS]; 2],
            jacobian: [[[0.0; MOST_SIGHTS]; 3]; 2],
        };
        let mut n = 0;
        for point in points.take(MOST_SIGHTS) {
            (0..3).for_each(|d| sights.place[d][n] = point[d]);
            n += 1;
        }
        let [x, y, z] = sights.place.each_ref().map(|c| &c[..n]);
        let [u, v] = sights.pixel.each_mut().map(|c| &mut c[..n]);
        let mut jacobian = sights.jacobian.each_mut().map(|row| row.each_mut().map(|entry| &mut entry[..n]));
        camera.project_with_jacobian_batch(x, y, z, u, v, &mut jacobian);
        sights
    }

    /// What is seen of point `k`.
    pub(crate) fn at(&self, k: usize) -> Sight {
        Sight {
            place: self.place.each_ref().map(|c| c[k]),
            pixel: self.pixel.each_ref().map(|c| c[k]),
            jacobian: self.jacobian.each_ref().map(|row| row.each_ref().map(|entry| entry[k])),
        }
    }
}
