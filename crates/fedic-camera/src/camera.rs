//! The one interface of every camera.

/// Precisions in pixels: far below what images tell. To follow the pieces of a spline more closely is not worth the time.
const SMOOTH: f64 = 1e-6;
const IN_PIECES: f64 = 1e-4;

/// A projector from the physical space to the image.
///
/// The two functions of a single point are all that a camera must give; those of many points follow from them and are
/// compiled once per camera, so that a call through `dyn Camera` costs one dispatch per batch.
pub trait Camera: Send + Sync {
    /// Image point `[u, v]` of a world point; NaN where the camera cannot see it.
    fn project(&self, point: [f64; 3]) -> [f64; 2];

    /// Image point and Jacobian: row 0 is `(du/dX, du/dY, du/dZ)`, row 1 the same of `v`.
    fn project_with_jacobian(&self, point: [f64; 3]) -> ([f64; 2], [[f64; 3]; 2]);

    /// The Jacobian where it is the same everywhere (paper, eq. 19).
    fn constant_jacobian(&self) -> Option<[[f64; 3]; 2]> {
        None
    }

    /// Whether the lens model folds between the optical axis and this point: the pixel it projects to is not where a real
    /// lens would show it.
    fn is_beyond_fold(&self, _point: [f64; 3]) -> bool {
        false
    }

    /// Whether this point lies where the camera's lens was calibrated; elsewhere its projection is an extrapolation.
    fn covers(&self, _point: [f64; 3]) -> bool {
        true
    }

    /// By about how many pixels a simpler projection over a small part of the view may differ from this one.
    fn precision(&self) -> f64 {
        if self.is_in_pieces() { IN_PIECES } else { SMOOTH }
    }

    /// Whether the lens is made of pieces, between which its third derivatives jump.
    fn is_in_pieces(&self) -> bool {
        false
    }

    /// World point of the plane `Z = z` seen at `pixel` by this camera without its lens distortion: exact for a camera
    /// that has none, the start of the Newton iteration of [`unproject`](crate::unproject) for the others.
    fn unproject_linear(&self, pixel: [f64; 2], z: f64) -> [f64; 3];

    /// [`project`](Self::project) for many points given by components; all slices have one length.
    fn project_batch(&self, x: &[f64], y: &[f64], z: &[f64], u: &mut [f64], v: &mut [f64]) {
        project_each(|point| self.project(point), [x, y, z], [u, v]);
    }

    /// [`project_with_jacobian`](Self::project_with_jacobian) for many points; `jacobian[r][c]` is a slice as long as
    /// the others.
    fn project_with_jacobian_batch(
        &self,
        x: &[f64],
        y: &[f64],
        z: &[f64],
        u: &mut [f64],
        v: &mut [f64],
        jacobian: &mut [[&mut [f64]; 3]; 2],
    ) {
        project_each_with_jacobian(|point| self.project_with_jacobian(point), [x, y, z], [u, v], jacobian);
    }
}

/// Points projected side by side.
const LANES: usize = 4;

/// Projects points one after the other; the compiler makes vectors of a simple camera's.
#[inline(always)]
pub(crate) fn project_each(project: impl Fn([f64; 3]) -> [f64; 2], [x, y, z]: [&[f64]; 3], [u, v]: [&mut [f64]; 2]) {
    let n = u.len();
    let (x, y, z, v) = (&x[..n], &y[..n], &z[..n], &mut v[..n]);
    for k in 0..n {
        [u[k], v[k]] = project([x[k], y[k], z[k]]);
    }
}

/// The same with the Jacobian, some points at a time: the compiler does not see that so many slices are none of each other.
#[inline(always)]
pub(crate) fn project_each_with_jacobian(
    project: impl Fn([f64; 3]) -> ([f64; 2], [[f64; 3]; 2]),
    [x, y, z]: [&[f64]; 3],
    [u, v]: [&mut [f64]; 2],
    jacobian: &mut [[&mut [f64]; 3]; 2],
) {
    let n = u.len();
    for start in (0..n).step_by(LANES) {
        let block = start..n.min(start + LANES);
        let mut point = [[0.0; LANES]; 3];
        for (lane, c) in point.iter_mut().zip([x, y, z]) {
            copy_block(&mut lane[..block.len()], &c[block.clone()]);
        }
        let mut pixel = [[0.0; LANES]; 2];
        let mut rows = [[[0.0; LANES]; 3]; 2];
        for k in 0..LANES {
            let (seen, derivatives) = project([point[0][k], point[1][k], point[2][k]]);
            for r in 0..2 {
                pixel[r][k] = seen[r];
                for c in 0..3 {
                    rows[r][c][k] = derivatives[r][c];
                }
            }
        }
        copy_block(&mut u[block.clone()], &pixel[0]);
        copy_block(&mut v[block.clone()], &pixel[1]);
        for (entry, lane) in jacobian.iter_mut().flatten().zip(rows.as_flattened()) {
            copy_block(&mut entry[block.clone()], lane);
        }
    }
}

/// Copies the first `to.len()` numbers, at most [`LANES`]; a full block without a call to `memcpy`.
#[inline(always)]
fn copy_block(to: &mut [f64], from: &[f64]) {
    match (<&mut [f64; LANES]>::try_from(&mut *to), from.first_chunk()) {
        (Ok(to), Some(from)) => *to = *from,
        _ => to.copy_from_slice(&from[..to.len()]),
    }
}
